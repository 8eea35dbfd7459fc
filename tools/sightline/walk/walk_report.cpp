#include "tools/sightline/walk/walk_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/text_table.h"
#include "tools/sightline/methods/method_choice.h"
#include "tools/sightline/methods/statistics.h"
#include "tools/sightline/report/markup.h"

namespace sightline::tool {
namespace {

constexpr const char* kTiesNote =
    "Ties: pictures that differ only where a hidden surface is nearer to its occluder than the depth buffer "
    "resolves; nothing was culled wrongly.";

double objectsDrawn(const FrameRecord& frame) {
  return static_cast<double>(frame.objects);
}
double trianglesDrawn(const FrameRecord& frame) {
  return static_cast<double>(frame.triangles);
}
double cullMs(const FrameRecord& frame) {
  return frame.cull_us * 1e-3;
}
double drawMs(const FrameRecord& frame) {
  return frame.draw_us * 1e-3;
}
double frameMs(const FrameRecord& frame) {
  return frame.frameUs() * 1e-3;
}
double nodesTested(const FrameRecord& frame) {
  return frame.stats.nodes_tested;
}
double occludersOf(const FrameRecord& frame) {
  return frame.stats.occluders;
}
auto testedShareOf(const WalkRun& run) {
  return [&run](const FrameRecord& frame) { return testedShare(frame.stats, run.hierarchy_nodes); };
}

auto statisticAt(std::size_t i) {
  return [i](const FrameRecord& frame) { return frame.statistics[i]; };
}

double ratio(double a, double b) {
  return b > 0.0 ? a / b : 1.0;
}

// The shortest name that distinguishes the run from the others.
std::string seriesName(const WalkRun& run, const WalkRecord& record) {
  if (&run == &record.baseline()) {
    return methodName(run.setting);
  }
  const auto other_method = [&](const WalkRun& other) {
    return &other != &record.baseline() && methodName(other.setting) != methodName(run.setting);
  };
  const bool several = std::any_of(record.runs.begin(), record.runs.end(), other_method);
  return (several ? methodName(run.setting) + ", " : "") + optionsText(run.setting);
}

template <typename Of>
Plot plotOf(const WalkRecord& record, const Walk& walk, const std::string& title, const std::string& y_label,
            bool with_baseline, Of of) {
  Plot plot;
  plot.title = title;
  plot.y_label = y_label;
  plot.first_x = walk.frames.front();
  plot.step_x = walk.frames.size() > 1 ? walk.frames[1] - walk.frames[0] : 1.0;
  for (std::size_t r = with_baseline ? 0 : 1; r < record.runs.size(); ++r) {
    const WalkRun& run = record.runs[r];
    PlotSeries series{seriesName(run, record), {}, r};
    for (const FrameRecord& frame : run.frames) {
      series.values.push_back(of(frame));
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// Leaves out what nothing is known of where nothing was drawn.
Json asDrawn(Json json, const WalkRecord& record) {
  for (const char* key :
       {"draw_us", "frame_us", "speed_up", "differs", "tie", "differing_frames", "tie_frames"}) {
    if (record.device.empty()) {
      json.erase(key);
    }
  }
  return json;
}

std::string frameJson(const FrameRecord& frame, const WalkRun& run, const WalkRecord& record) {
  Json json = {{"frame", frame.frame},
               {"objects", frame.objects},
               {"triangles", frame.triangles},
               {"cull_us", frame.cull_us},
               {"draw_us", frame.draw_us},
               {"nodes_tested", frame.stats.nodes_tested},
               {"nodes_tested_share", testedShareOf(run)(frame)},
               {"occluders", frame.stats.occluders},
               {"differs", frame.differs},
               {"tie", frame.tie}};
  addStatistics(json, run.statistics, [&](std::size_t i) { return frame.statistics[i]; });
  return dump(asDrawn(json, record));
}

Json meanJson(const WalkRun& run, const ReportRow& row) {
  Json json = {{"objects", row.objects},
               {"triangles", row.triangles},
               {"triangles_share", row.triangles_share},
               {"cull_us", row.cull_ms * 1e3},
               {"draw_us", row.draw_ms * 1e3},
               {"frame_us", row.frame_ms * 1e3},
               {"speed_up", row.speed_up},
               {"nodes_tested", row.nodes_tested},
               {"nodes_tested_share", run.mean(testedShareOf(run))},
               {"occluders", row.occluders}};
  addStatistics(json, run.statistics, [&](std::size_t i) { return run.mean(statisticAt(i)); });
  return json;
}

std::string runJson(const WalkRun& run, const WalkRecord& record) {
  const ReportRow row = rowOf(run, record);
  Json head = {{"method", row.method},
               {"options", optionsJson(run.setting)},
               {"mean", asDrawn(meanJson(run, row), record)},
               {"differing_frames", run.differingFrames()},
               {"tie_frames", run.tieFrames()}};
  addChoice(head, run.setting);
  std::vector<std::string> frames;
  for (const FrameRecord& frame : run.frames) {
    frames.push_back(frameJson(frame, run, record));
  }
  return dumpWithList(asDrawn(head, record), "frames", frames);
}

std::string pathName(const Walk& walk) {
  return walk.path.name.empty() ? "unnamed" : walk.path.name;
}

// The run with occlusion culling that the report's headline is about: the fastest one or, where nothing was
// drawn, the one with the fewest triangles.
ReportRow bestRow(const WalkRecord& record) {
  ReportRow best = rowOf(record.runs[1], record);
  for (std::size_t r = 2; r < record.runs.size(); ++r) {
    const ReportRow row = rowOf(record.runs[r], record);
    if (record.device.empty() ? row.triangles < best.triangles : row.speed_up > best.speed_up) {
      best = row;
    }
  }
  return best;
}

std::string summaryOf(const WalkRecord& record) {
  if (record.runs.size() < 2) {
    return "View-frustum culling alone.";
  }
  const ReportRow row = bestRow(record);
  if (record.device.empty()) {
    return fmt::format(
        "{} ({}) leaves {:.1f} % of the triangles that view-frustum culling leaves; nothing was drawn.",
        row.method, row.options, 100.0 * row.triangles_share);
  }
  const std::size_t differing = record.differing();
  const std::size_t ties = record.ties();
  return fmt::format(
      "{} ({}) draws {:.1f} % of the triangles that view-frustum culling draws, at {:.2f} times its frame "
      "rate; {}.",
      row.method, row.options, 100.0 * row.triangles_share, row.speed_up,
      differing == 0 && ties == 0 ? "every picture is the same, pixel by pixel"
      : differing == 0
          ? fmt::format("every picture is the same but for ties of the depth buffer in {}", grouped(ties))
          : fmt::format("{} pictures DIFFER from those without culling", differing));
}

std::vector<std::string> notesOf(const WalkRecord& record) {
  const Setting& shown = record.runs[record.shown].setting;
  const std::string name = fmt::format("{} ({})", methodName(shown), optionsText(shown));
  if (record.device.empty()) {
    return {"Times are of this machine, in this run. Nothing was drawn, and no pictures were compared.",
            "Coverage maps, if there are any, show " + name + "."};
  }
  return {
      "Times are of this machine, in this run; drawing is measured to the last pixel, without reading back.",
      "Every frame's picture is compared with the one of view-frustum culling, pixel by pixel, and this one, "
      "every tenth frame, with a picture of all objects.",
      "Pictures, coverage maps and plan views show " + name + "."};
}

// What --method auto stands for, and why; empty if it was not asked for.
std::string choiceOf(const WalkRecord& record) {
  std::vector<Setting> settings;
  for (const WalkRun& run : record.runs) {
    settings.push_back(run.setting);
  }
  return choiceText(settings);
}

}  // namespace

ReportRow rowOf(const WalkRun& run, const WalkRecord& record) {
  const WalkRun& baseline = record.baseline();
  ReportRow row;
  row.method = methodName(run.setting);
  row.options = optionsText(run.setting);
  row.triangles = run.mean(trianglesDrawn);
  row.triangles_share = ratio(row.triangles, baseline.mean(trianglesDrawn));
  row.objects = run.mean(objectsDrawn);
  row.cull_ms = run.mean(cullMs);
  row.draw_ms = run.mean(drawMs);
  row.frame_ms = run.mean(frameMs);
  row.speed_up = ratio(baseline.mean(frameMs), row.frame_ms);
  row.nodes_tested = run.mean(nodesTested);
  row.occluders = run.mean(occludersOf);
  row.frames_differing = run.differingFrames().size();
  row.frames_tied = run.tieFrames().size();
  // The baseline is what the others are compared with, and is compared itself here and there.
  const bool reference = &run == &baseline && row.frames_differing == 0 && row.frames_tied == 0;
  if (reference || record.device.empty()) {
    row.frames_differing.reset();
  }
  return row;
}

std::string statisticsText(const WalkRun& run) {
  std::string text =
      fmt::format("{} ({}): {:.1f} % of the hierarchy's nodes tested in a mean frame",
                  methodName(run.setting), optionsText(run.setting), 100.0 * run.mean(testedShareOf(run)));
  const char* separator = "; ";
  for (std::size_t i = 0; i < run.statistics.size(); ++i) {
    if (run.statistics[i].shown) {
      text += fmt::format("{}{} {:.1f}", separator, run.statistics[i].caption, run.mean(statisticAt(i)));
      separator = ", ";
    }
  }
  return text;
}

std::vector<WalkPlot> walkPlots(const WalkRecord& record, const Walk& walk) {
  const auto& [triangles, frame_time, cull_time, nodes_tested] = kPlotFiles;
  std::vector<WalkPlot> plots{
      {plotOf(record, walk, "Triangles drawn", "triangles", true, trianglesDrawn), triangles}};
  if (!record.device.empty()) {
    plots.push_back(
        {plotOf(record, walk, "Frame time: culling and drawing", "ms", true, frameMs), frame_time});
  }
  plots.push_back({plotOf(record, walk, "Cull time", "ms", true, cullMs), cull_time});
  if (record.runs.size() > 1) {
    plots.push_back(
        {plotOf(record, walk, "Nodes asked of the occlusion structure", "nodes", false, nodesTested),
         nodes_tested});
  }
  return plots;
}

std::vector<Plot> plotsOf(const WalkRecord& record, const Walk& walk) {
  std::vector<Plot> plots;
  for (WalkPlot& made : walkPlots(record, walk)) {
    plots.push_back(std::move(made.plot));
  }
  return plots;
}

std::vector<ReportFact> walkFacts(const WalkInput& input, const WalkRecord& record) {
  const std::size_t done = record.baseline().frames.size();
  std::vector<ReportFact> facts{
      {"objects", grouped(input.scene.objects.size())},
      {"triangles", grouped(input.scene.triangleCount())},
      {"potential occluders", grouped(input.data.occluders().occluders.size())},
      {"walk",
       fmt::format(
           "{}, {} frames{}", pathName(input.walk), input.walk.frames.size(),
           done < input.walk.frames.size() ? fmt::format(", INTERRUPTED after the first {}", done) : "")}};
  const auto addDatabase = [&](const char* name, const CullingData::TimedDatabase* timed) {
    if (timed != nullptr) {
      facts.push_back(
          {name, fmt::format("{} cells, {} directions, {:.1f} MiB, built in {:.2f} s",
                             grouped(timed->database.cellCount()), timed->database.directionCount(),
                             static_cast<double>(timed->database.bytes()) / (1024.0 * 1024.0),
                             timed->build_us * 1e-6)});
    }
  };
  addDatabase("occluder database", input.data.database());
  addDatabase("database for detail objects", input.data.detailDatabase());
  if (!record.device.empty()) {
    facts.push_back({"pictures", fmt::format("{} x {}", record.width, record.height)});
    facts.push_back({"OpenGL", record.device});
  }
  return facts;
}

std::string walkJson(const WalkInput& input, const WalkRecord& record) {
  Json head = {{"scene", sceneJson(input.scene, input.closing)},
               {"path", pathName(input.walk)},
               {"width", record.width},
               {"height", record.height},
               {"device", record.device},
               {"differing_frames", record.differing()},
               {"tie_frames", record.ties()}};
  addDatabases(head, input.data);
  std::vector<std::string> runs;
  for (const WalkRun& run : record.runs) {
    runs.push_back(runJson(run, record));
  }
  return dumpWithList(asDrawn(head, record), "runs", runs);
}

void printWalk(const WalkRecord& record) {
  if (const std::string choice = choiceOf(record); !choice.empty()) {
    fmt::print("{}\n", choice);
  }
  TextTable table{{"method", "options", "triangles", "share", "nodes", "cull ms", "draw ms", "frame ms",
                   "speed-up", "differ", "ties"},
                  {},
                  2};
  const bool drawn = !record.device.empty();
  const auto ofDrawing = [&](double value, int decimals) {
    return drawn ? fmt::format("{:.{}f}", value, decimals) : "-";
  };
  for (const WalkRun& run : record.runs) {
    const ReportRow row = rowOf(run, record);
    table.rows.push_back({row.method, row.options, fmt::format("{:.0f}", row.triangles),
                          fmt::format("{:.1f}%", 100.0 * row.triangles_share),
                          fmt::format("{:.1f}%", 100.0 * run.mean(testedShareOf(run))),
                          fmt::format("{:.3f}", row.cull_ms), ofDrawing(row.draw_ms, 3),
                          ofDrawing(row.frame_ms, 3), ofDrawing(row.speed_up, 2),
                          row.frames_differing ? std::to_string(*row.frames_differing) : "-",
                          row.frames_differing ? std::to_string(row.frames_tied) : "-"});
  }
  fmt::print("{}", toText(table));
  for (const WalkRun& run : record.runs) {
    if (!run.statistics.empty()) {
      fmt::print("{}\n", statisticsText(run));
    }
  }
  if (record.ties() > 0) {
    fmt::print("{}\n", kTiesNote);
  }
}

Report walkReport(const WalkInput& input, const WalkRecord& record, std::vector<ReportPicture> pictures) {
  Report report;
  const std::filesystem::path file(input.scene_name);
  report.title = file.has_filename() ? file.filename().string() : input.scene_name;
  report.summary = summaryOf(record);
  report.drawn = !record.device.empty();
  report.facts = walkFacts(input, record);
  for (const WalkRun& run : record.runs) {
    report.rows.push_back(rowOf(run, record));
  }
  report.plots = plotsOf(record, input.walk);
  report.pictures = std::move(pictures);
  for (const ChangedPicture& changed : record.changed) {
    report.pictures.push_back({changed.file, changed.caption, changed.frame, false});
  }
  report.notes = notesOf(record);
  if (const std::string choice = choiceOf(record); !choice.empty()) {
    report.notes.insert(report.notes.begin(), "--method " + choice + ".");
  }
  for (std::size_t r = 1; r < record.runs.size(); ++r) {
    report.notes.push_back(statisticsText(record.runs[r]) + ".");
  }
  if (record.ties() > 0) {
    report.notes.push_back(kTiesNote);
  }
  return report;
}

}  // namespace sightline::tool
