// Adding a column is one row of the table of columns.

#include <fmt/format.h>

#include <functional>

#include "tools/sightline/bench/bench_text.h"
#include "tools/sightline/command_line/text_table.h"

namespace sightline::tool {
namespace {

struct CsvColumn {
  std::string name;
  std::function<std::string(const BenchRecord& record, const SettingRecord& run)> text;
};

std::string numberText(double number) {
  return fmt::format("{:.3f}", number);
}

std::string ratioText(double ratio) {
  return fmt::format("{:.6f}", ratio);
}

std::string bytesText(const std::optional<std::size_t>& bytes) {
  return bytes ? std::to_string(*bytes) : "";
}

using TimesOf = const FrameTimes* (*)(const SettingRecord& run);

// Adds nine columns: three statistics, each with its least and greatest value of a single round. They are
// empty where `times` returns null.
void addTimes(std::vector<CsvColumn>& columns, const std::string& name, TimesOf times) {
  constexpr std::pair<const char*, RoundSpread FrameTimes::*> kStatistics[] = {
      {"median", &FrameTimes::median}, {"mean", &FrameTimes::mean}, {"p99", &FrameTimes::p99}};
  constexpr std::pair<const char*, double RoundSpread::*> kEnds[] = {
      {"", &RoundSpread::value}, {"_low", &RoundSpread::low}, {"_high", &RoundSpread::high}};
  for (const auto& statistic : kStatistics) {
    for (const auto& end : kEnds) {
      const auto text = [times, of = statistic.second, at = end.second](const BenchRecord&,
                                                                        const SettingRecord& run) {
        const FrameTimes* frame_times = times(run);
        return frame_times != nullptr ? numberText(frame_times->*of.*at) : std::string();
      };
      columns.push_back({fmt::format("{}_{}{}", name, statistic.first, end.first), text});
    }
  }
}

void addRatio(std::vector<CsvColumn>& columns, const std::string& name, RoundSpread FrameTimes::*statistic) {
  columns.push_back({name, [statistic](const BenchRecord& record, const SettingRecord& run) {
                       return ratioText(
                           timesBaseline(run.cull.*statistic, record.baseline().cull.*statistic));
                     }});
}

void addPart(std::vector<CsvColumn>& columns, const std::string& name, PartCost Preparation::*part) {
  columns.push_back({name + "_us", [part](const BenchRecord&, const SettingRecord& run) {
                       return numberText((run.preparation.*part).us);
                     }});
  columns.push_back({name + "_bytes", [part](const BenchRecord&, const SettingRecord& run) {
                       return bytesText((run.preparation.*part).bytes);
                     }});
}

void addScene(std::vector<CsvColumn>& columns) {
  using Record = BenchRecord;
  using Run = SettingRecord;
  columns.push_back({"scene", [](const Record& record, const Run&) { return record.scene_name; }});
  columns.push_back({"path", [](const Record& record, const Run&) { return record.path_name; }});
  columns.push_back({"method", [](const Record&, const Run& run) { return methodName(run.setting); }});
  columns.push_back({"options", [](const Record&, const Run& run) { return optionsText(run.setting); }});
  columns.push_back({"scene_hash", [](const Record& record, const Run&) {
                       return fmt::format("{:016x}", record.scene.hash);
                     }});
  columns.push_back(
      {"views", [](const Record& record, const Run&) { return fmt::format("{:016x}", record.views); }});
  columns.push_back(
      {"frames", [](const Record& record, const Run&) { return std::to_string(record.frames); }});
  columns.push_back(
      {"rounds", [](const Record& record, const Run&) { return std::to_string(record.rounds); }});
  columns.push_back({"core", [](const Record& record, const Run&) {
                       return record.core ? std::to_string(*record.core) : std::string();
                     }});
}

using IntervalOf = std::optional<Interval> (*)(const BenchRecord& record, const SettingRecord& run);

// Adds two columns, which are empty where there is no interval.
void addInterval(std::vector<CsvColumn>& columns, const std::string& name, IntervalOf interval_of) {
  constexpr std::pair<const char*, double Interval::*> kEnds[] = {{"_low", &Interval::low},
                                                                  {"_high", &Interval::high}};
  for (const auto& end : kEnds) {
    columns.push_back({name + end.first,
                       [interval_of, at = end.second](const BenchRecord& record, const SettingRecord& run) {
                         const std::optional<Interval> interval = interval_of(record, run);
                         return interval ? ratioText((*interval).*at) : std::string();
                       }});
  }
}

void addTightness(std::vector<CsvColumn>& columns) {
  using Record = BenchRecord;
  using Run = SettingRecord;
  columns.push_back({"kept", [](const Record&, const Run& run) { return std::to_string(run.kept); }});
  columns.push_back(
      {"witnessed", [](const Record& record, const Run&) { return std::to_string(record.witnessed); }});
  columns.push_back(
      {"undecided", [](const Record& record, const Run&) { return std::to_string(record.undecided); }});
  columns.push_back({"missed", [](const Record&, const Run& run) { return std::to_string(run.missed); }});
  addInterval(columns, "overestimate",
              [](const Record& record, const Run& run) { return record.overestimate(run); });
  columns.push_back({"boxes", [](const Record& record, const Run&) { return std::to_string(record.boxes); }});
  columns.push_back({"undecided_boxes", [](const Record& record, const Run&) {
                       return std::to_string(record.undecided_boxes);
                     }});
  addInterval(columns, "boxes_overestimate",
              [](const Record& record, const Run&) { return record.leastOfBoxes(); });
  columns.push_back({"several_boxes",
                     [](const Record& record, const Run&) { return std::to_string(record.several_boxes); }});
  columns.push_back({"undecided_several_boxes", [](const Record& record, const Run&) {
                       return std::to_string(record.undecided_several_boxes);
                     }});
  addInterval(columns, "several_boxes_overestimate",
              [](const Record& record, const Run&) { return record.leastOfSeveralBoxes(); });
  columns.push_back({"answers", [](const Record&, const Run& run) { return answersText(run); }});
}

std::vector<CsvColumn> makeColumns() {
  std::vector<CsvColumn> columns;
  addScene(columns);
  addTightness(columns);
  addTimes(columns, "cull_us", [](const SettingRecord& run) -> const FrameTimes* { return &run.cull; });
  addTimes(columns, "cpu_us", [](const SettingRecord& run) -> const FrameTimes* { return &run.cpu; });
  addTimes(columns, "draw_us",
           [](const SettingRecord& run) -> const FrameTimes* { return run.draw ? &*run.draw : nullptr; });
  addRatio(columns, "times_frustum_median", &FrameTimes::median);
  addRatio(columns, "times_frustum_mean", &FrameTimes::mean);
  addRatio(columns, "times_frustum_p99", &FrameTimes::p99);
  columns.push_back({"load_us", [](const BenchRecord& record, const SettingRecord&) {
                       return numberText(record.load_us);
                     }});
  addPart(columns, "hierarchy", &Preparation::hierarchy);
  addPart(columns, "occluders", &Preparation::occluders);
  addPart(columns, "databases", &Preparation::databases);
  addPart(columns, "method", &Preparation::method);
  columns.push_back({"front", [](const BenchRecord&, const SettingRecord& run) {
                       return std::string(run.on_front ? "1" : "0");
                     }});
  columns.push_back({"advised", [](const BenchRecord& record, const SettingRecord& run) {
                       return std::string(&run == &record.runs[record.advice.run] ? "1" : "0");
                     }});
  return columns;
}

}  // namespace

std::vector<std::string> benchCsvColumns() {
  std::vector<std::string> names;
  for (const CsvColumn& column : makeColumns()) {
    names.push_back(column.name);
  }
  return names;
}

std::string benchCsv(const std::vector<BenchRecord>& records) {
  const std::vector<CsvColumn> columns = makeColumns();
  std::string text;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    text += (c == 0 ? "" : ",") + columns[c].name;
  }
  for (const BenchRecord& record : records) {
    for (const SettingRecord& run : record.runs) {
      text += "\n";
      for (std::size_t c = 0; c < columns.size(); ++c) {
        text += (c == 0 ? "" : ",") + csvText(columns[c].text(record, run));
      }
    }
  }
  return text;
}

}  // namespace sightline::tool
