#include "tools/sightline/bench/bench_text.h"

#include <fmt/format.h>

#include "tools/sightline/command_line/text_table.h"

namespace sightline::tool {
namespace {

std::string mebibytesText(const std::optional<std::size_t>& bytes) {
  return bytes ? fmt::format("{:.1f}", static_cast<double>(*bytes) / (1024.0 * 1024.0)) : "-";
}

std::vector<std::string> rowOf(const SettingRecord& run, const BenchRecord& record) {
  const SettingRecord& baseline = record.baseline();
  return {methodName(run.setting),
          optionsText(run.setting),
          run.on_front ? "*" : "",
          intervalText(record.overestimate(run)),
          std::to_string(run.missed),
          milliseconds(run.cull.median.value),
          milliseconds(run.cull.mean.value),
          milliseconds(run.cull.p99.value),
          fmt::format("{:.2f}", timesBaseline(run.cull.mean, baseline.cull.mean)),
          milliseconds(run.cpu.mean.value),
          run.draw ? milliseconds(run.draw->mean.value) : "-",
          mebibytesText(run.preparation.bytes()),
          milliseconds(run.preparation.us()),
          answersText(run)};
}

// The least kept/exact of any test of boxes.
std::string boxesText(const BenchRecord& record) {
  const auto undecided = [](std::uint64_t boxes) {
    return boxes == 0 ? "" : fmt::format(" and {} undecided ones", boxes);
  };
  return fmt::format(
      "boxes: {} kept/exact is the least that any test of one bounding box an object can have ({} visible "
      "boxes{}), {} that of several ({} objects{}).",
      intervalText(record.leastOfBoxes()), record.boxes, undecided(record.undecided_boxes),
      intervalText(record.leastOfSeveralBoxes()), record.several_boxes,
      undecided(record.undecided_several_boxes));
}

}  // namespace

std::string milliseconds(double us) {
  const double ms = us * 1e-3;
  return fmt::format("{:.{}f}", ms, ms < 10.0 ? 3 : ms < 100.0 ? 2 : ms < 1000.0 ? 1 : 0);
}

std::string intervalText(const std::optional<Interval>& interval) {
  if (!interval) {
    return "-";
  }
  const std::string low = fmt::format("{:.2f}", interval->low), high = fmt::format("{:.2f}", interval->high);
  return low == high ? low : low + "-" + high;
}

std::string answersText(const SettingRecord& run) {
  return fmt::format("{:016x}", run.answers);
}

double timesBaseline(const RoundSpread& time, const RoundSpread& baseline) {
  return baseline.value > 0.0 ? time.value / baseline.value : 1.0;
}

std::string benchTable(const BenchRecord& record) {
  TextTable table{{"method", "options", "front", "kept/exact", "missed", "cull ms", "mean", "p99", "/frustum",
                   "cpu ms", "draw ms", "MiB", "prepare ms", "answers"},
                  {},
                  3};
  for (const SettingRecord& run : record.runs) {
    table.rows.push_back(rowOf(run, record));
  }
  return toText(table);
}

std::string benchNotes(const BenchRecord& record) {
  const std::string core = record.core
                               ? fmt::format("on core {} alone", *record.core)
                               : "NOT pinned to a core, for the system has no such call or refuses it";
  const std::string drawn =
      record.device.empty() ? "Nothing was drawn (--draw)." : fmt::format("Drawn by {}.", record.device);
  return fmt::format(
      "{}, path {}: {} objects, {} triangles; {} frames, {} rounds after a warm-up, {}; loaded in {} ms.\n"
      "{} objects seen in all frames, {} undecided; exact visibility of {} frames was kept from earlier "
      "runs. {}\n{}\n",
      record.scene_name, record.path_name, record.scene.objects, record.scene.triangles, record.frames,
      record.rounds, core, milliseconds(record.load_us), record.witnessed, record.undecided,
      record.frames_from_cache, drawn, boxesText(record));
}

}  // namespace sightline::tool
