#include <fmt/format.h>

#include <algorithm>

#include "tools/sightline/reproduce/coorg_teller.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool::coorg_teller {
namespace {

constexpr double kBytesPerMebibyte = 1024.0 * 1024.0;
// Microseconds that drawing a triangle takes in the models of renderers, from fast to slow.
constexpr double kTriangleUs[] = {0.01, 0.1, 1.0, 10.0};

// Adds one row for each of kCullings from `first` on.
template <typename RowOf>
void addRows(Experiment& experiment, const SceneTimes& measured, std::size_t first, RowOf&& row_of) {
  for (std::size_t c = first; c < measured.record.runs.size(); ++c) {
    Json row = {{"scene", measured.name}, {"culling", kCullings[c].name}};
    row.update(row_of(measured.record.runs[c], rowOf(measured.record.runs[c], measured.record)));
    experiment.rows.push_back(std::move(row));
  }
}

Experiment polygonsDrawn(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{"polygons_drawn",
                        "1. Polygons drawn, mean of the walk",
                        "occlusion culling reduces the polygons drawn by a factor against view-frustum "
                        "culling.",
                        {{"scene", "scene"},
                         {"culling", "culling"},
                         {"triangles", "triangles", 0},
                         {"percent", "% of scene", 2},
                         {"percent_of_frustum", "% of frustum's", 2},
                         {"objects", "objects", 1}}};
  for (const SceneTimes& measured : scenes) {
    const auto all = static_cast<double>(measured.input.scene.triangleCount());
    addRows(experiment, measured, kBaseline, [&](const WalkRun&, const ReportRow& row) -> Json {
      return {{"triangles", row.triangles},
              {"percent", 100.0 * row.triangles / all},
              {"percent_of_frustum", 100.0 * row.triangles_share},
              {"objects", row.objects}};
    });
  }
  return experiment;
}

Experiment frameTime(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{"frame_time",
                        "2. Time of a frame, mean of the walk",
                        "the total falls, too; the slower the graphics hardware, the more is gained.",
                        {{"scene", "scene"}, {"culling", "culling"}, {"cull_ms", "cull ms", 3}}};
  if (std::any_of(scenes.begin(), scenes.end(), [](const SceneTimes& scene) { return scene.drawn(); })) {
    experiment.columns.insert(
        experiment.columns.end(),
        {{"draw_ms", "draw ms", 3}, {"total_ms", "total ms", 3}, {"speed_up", "speed-up", 2}});
  }
  for (const SceneTimes& measured : scenes) {
    addRows(experiment, measured, kBaseline, [&](const WalkRun&, const ReportRow& row) {
      Json json = {{"cull_ms", row.cull_ms}};
      if (measured.drawn()) {
        json["draw_ms"] = row.draw_ms;
        json["total_ms"] = row.frame_ms;
        json["speed_up"] = row.speed_up;
      }
      return json;
    });
  }
  return experiment;
}

// The time of a frame of each culling with a renderer that does nothing but triangles.
double modelledMs(const ReportRow& row, double triangle_us) {
  return row.cull_ms + 1e-3 * triangle_us * row.triangles;
}

double modelledSpeedUp(const SceneTimes& measured, std::size_t culling, double triangle_us) {
  const WalkRecord& record = measured.record;
  return modelledMs(rowOf(record.baseline(), record), triangle_us) /
         modelledMs(rowOf(record.runs[culling], record), triangle_us);
}

Experiment rendererModels(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{
      "renderer_models",
      "2b. The same with models of renderers, in which each triangle takes the same time to draw",
      "the total falls on a fast machine and more so on a slow one.",
      {{"scene", "scene"},
       {"culling", "culling"},
       {"triangle_us", "us a triangle", 2},
       {"cull_ms", "cull ms", 3},
       {"draw_ms", "draw ms", 3},
       {"total_ms", "total ms", 3},
       {"speed_up", "speed-up", 2}}};
  for (const SceneTimes& measured : scenes) {
    for (std::size_t c = 0; c < measured.record.runs.size(); ++c) {
      const ReportRow row = rowOf(measured.record.runs[c], measured.record);
      for (const double triangle_us : kTriangleUs) {
        experiment.rows.push_back({{"scene", measured.name},
                                   {"culling", kCullings[c].name},
                                   {"triangle_us", triangle_us},
                                   {"cull_ms", row.cull_ms},
                                   {"draw_ms", 1e-3 * triangle_us * row.triangles},
                                   {"total_ms", modelledMs(row, triangle_us)},
                                   {"speed_up", modelledSpeedUp(measured, c, triangle_us)}});
      }
    }
  }
  return experiment;
}

Experiment visibilityTime(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{
      "visibility_time",
      "3. Visibility time of a frame at several speeds (1: 1.4 m/s at 60 frames a second), occluders of the "
      "database",
      "less time is spent for an observer who moves slowly: temporal coherence. View-frustum culling is not "
      "counted.",
      {{"scene", "scene"},
       {"speed", "speed", 0},
       {"frames", "frames", 0},
       {"visibility_us", "visibility us", 1},
       {"visibility_us_nothing_kept", "us with nothing kept", 1},
       {"visibility_us_through_eye", "us through the eye", 1},
       {"frustum_us", "us of frustum alone", 1},
       {"reused", "reused", 1},
       {"unchanged", "unchanged", 1},
       {"rebuilt", "rebuilt", 1}}};
  for (const SceneTimes& measured : scenes) {
    for (const SpeedResult& result : measured.speeds) {
      experiment.rows.push_back({{"scene", measured.name},
                                 {"speed", result.speed},
                                 {"frames", result.frames},
                                 {"visibility_us", result.coherent_us - result.frustum_us},
                                 {"visibility_us_nothing_kept", result.incoherent_us - result.frustum_us},
                                 {"visibility_us_through_eye", result.through_eye_us - result.frustum_us},
                                 {"frustum_us", result.frustum_us},
                                 {"reused", result.reused},
                                 {"unchanged", result.unchanged},
                                 {"rebuilt", result.rebuilt}});
    }
  }
  return experiment;
}

// The share of the occluder-node pairs that are compared in a frame: s of the s k n in section 4, percent.
double pairsPercent(const WalkRun& run) {
  const double occluders = run.mean([](const FrameRecord& frame) { return frame.stats.occluders; });
  return 100.0 * run.meanOf("relations", "node_pairs") /
         std::max(1.0, occluders * static_cast<double>(run.hierarchy_nodes));
}

// The share of the relations that were there from an earlier frame, percent.
double reusedPercent(const WalkRun& run) {
  const double reused = run.meanOf("relations", "reused"), rebuilt = run.meanOf("relations", "rebuilt");
  return 100.0 * reused / std::max(1.0, reused + rebuilt);
}

Experiment nodesTested(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{"nodes_tested",
                        "4. Nodes of the kd-tree tested for occlusion, mean of the walk",
                        "only a part of the kd-tree's nodes in the view frustum is tested in a frame: "
                        "spatial coherence. Of the k n "
                        "pairs of an occluder and a node, a fraction s is compared.",
                        {{"scene", "scene"},
                         {"culling", "culling"},
                         {"height", "height", 0},
                         {"nodes", "nodes", 0},
                         {"nodes_in_frustum", "in frustum", 1},
                         {"nodes_tested", "tested", 1},
                         {"percent", "% of all", 2},
                         {"percent_of_frustum", "% of frustum's", 2},
                         {"occluders", "occluders", 1},
                         {"node_pairs", "pairs tested", 1},
                         {"pairs_percent", "% of k n", 3},
                         {"reused_percent", "% reused", 1}}};
  for (const SceneTimes& measured : scenes) {
    addRows(experiment, measured, kKeptPlanes, [&](const WalkRun& run, const ReportRow& row) -> Json {
      Json json = {
          {"height", run.hierarchy_depth},
          {"nodes", run.hierarchy_nodes},
          {"nodes_in_frustum", measured.nodes_in_frustum},
          {"nodes_tested", row.nodes_tested},
          {"percent", 100.0 * row.nodes_tested / static_cast<double>(run.hierarchy_nodes)},
          {"percent_of_frustum", 100.0 * row.nodes_tested / std::max(1.0, measured.nodes_in_frustum)},
          {"occluders", row.occluders}};
      if (&run == &measured.record.runs[kKeptPlanes]) {
        json["node_pairs"] = run.meanOf("relations", "node_pairs");
        json["pairs_percent"] = pairsPercent(run);
        json["reused_percent"] = reusedPercent(run);
      }
      return json;
    });
  }
  return experiment;
}

Experiment memory(const std::vector<SceneTimes>& scenes) {
  Experiment experiment{"memory",
                        "5. Memory: relations kept at their peak, and the occluder database",
                        "",
                        {{"scene", "scene"},
                         {"objects", "objects", 0},
                         {"triangles", "triangles", 0},
                         {"potential_occluders", "occluders", 0},
                         {"relations", "relations", 0},
                         {"relation_mib", "relations MiB", 2},
                         {"database_cells", "cells", 0},
                         {"database_directions", "directions", 0},
                         {"database_mib", "database MiB", 2},
                         {"database_build_ms", "built in ms", 0}}};
  for (const SceneTimes& measured : scenes) {
    const WalkRun& kept = measured.record.runs[kKeptPlanes];
    const OccluderDatabase& database = measured.data.database()->database;
    experiment.rows.push_back(
        {{"scene", measured.name},
         {"objects", measured.input.scene.objects.size()},
         {"triangles", measured.input.scene.triangleCount()},
         {"potential_occluders", measured.data.occluders().occluders.size()},
         {"relations", kept.peak("relations", "kept")},
         {"relation_mib", static_cast<double>(kept.peak("relations", "bytes")) / kBytesPerMebibyte},
         {"database_cells", database.cellCount()},
         {"database_directions", database.directionCount()},
         {"database_mib", static_cast<double>(database.bytes()) / kBytesPerMebibyte},
         {"database_build_ms", measured.data.database()->build_us * 1e-3}});
  }
  return experiment;
}

// Calls use(measured, run) for the paper's own method in each scene.
template <typename Use>
void forKeptPlanes(const std::vector<SceneTimes>& scenes, Use&& use) {
  for (const SceneTimes& measured : scenes) {
    use(measured, measured.record.runs[kKeptPlanes]);
  }
}

std::string listed(const std::string& list, const std::string& item) {
  return list.empty() ? item : list + "; " + item;
}

Finding polygonsFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{"occlusion culling reduces the polygons drawn by a factor", true, ""};
  forKeptPlanes(scenes, [&](const SceneTimes& measured, const WalkRun& run) {
    const double factor = 1.0 / std::max(1e-9, rowOf(run, measured.record).triangles_share);
    finding.agrees = finding.agrees && factor > 1.0;
    finding.text = listed(finding.text, fmt::format("by {:.1f} in {}", factor, measured.name));
  });
  return finding;
}

Finding rendererFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{"the slower the graphics hardware, the more is gained", true, ""};
  forKeptPlanes(scenes, [&](const SceneTimes& measured, const WalkRun&) {
    std::string text;
    double last = 0.0;
    for (const double triangle_us : kTriangleUs) {
      const double speed_up = modelledSpeedUp(measured, kKeptPlanes, triangle_us);
      finding.agrees = finding.agrees && speed_up > last;
      last = speed_up;
      text += fmt::format("{}{:.2f}", text.empty() ? "" : ", ", speed_up);
    }
    finding.text = listed(finding.text, fmt::format("speed-ups of {} in {}", text, measured.name));
  });
  finding.text +=
      fmt::format(" with {}, {}, {} and {} us a triangle: culling takes the same time, drawing grows",
                  kTriangleUs[0], kTriangleUs[1], kTriangleUs[2], kTriangleUs[3]);
  return finding;
}

Finding speedFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{"less time is spent for slow observers", true, ""};
  for (const SceneTimes& measured : scenes) {
    if (!measured.speeds.empty()) {
      const SpeedResult &slow = measured.speeds.front(), &fast = measured.speeds.back();
      const double ratio =
          (fast.coherent_us - fast.frustum_us) / std::max(1e-9, slow.coherent_us - slow.frustum_us);
      finding.agrees = finding.agrees && ratio > 1.0;
      finding.text = listed(finding.text, fmt::format("{} times the speed takes {:.1f} times as long in {}",
                                                      fast.speed, ratio, measured.name));
    }
  }
  return finding;
}

Finding pairsFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{"of the k n pairs of an occluder and a node only a fraction s is compared", true, ""};
  forKeptPlanes(scenes, [&](const SceneTimes& measured, const WalkRun& run) {
    finding.agrees = finding.agrees && pairsPercent(run) < 10.0;
    finding.text =
        listed(finding.text, fmt::format("s = {:.4f} in {}, and {:.0f} % of the relations were there from "
                                         "the frame before",
                                         0.01 * pairsPercent(run), measured.name, reusedPercent(run)));
  });
  return finding;
}

Finding nodesFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{"only a part of the kd-tree's nodes in the view frustum is tested in a frame", true, ""};
  forKeptPlanes(scenes, [&](const SceneTimes& measured, const WalkRun& run) {
    const double percent =
        100.0 * rowOf(run, measured.record).nodes_tested / std::max(1.0, measured.nodes_in_frustum);
    finding.agrees = finding.agrees && percent < 100.0;
    finding.text = listed(finding.text, fmt::format("{:.1f} % of them in {}", percent, measured.name));
  });
  finding.text += "; below what is hidden, and below what no occluder touches, nothing is asked";
  return finding;
}

Finding plateFinding(const std::vector<SceneTimes>& scenes) {
  Finding finding{
      "colour plate: in snapshots of walks a significant part of what is in the frustum is culled", true, ""};
  for (const SceneTimes& measured : scenes) {
    double low = 1.0, high = 0.0;
    for (const KeptFrame& frame : measured.record.pictures) {
      const double share = static_cast<double>(frame.triangles_visible) /
                           static_cast<double>(std::max<std::uint64_t>(1, frame.triangles_in_frustum));
      low = std::min(low, share);
      high = std::max(high, share);
    }
    finding.agrees = finding.agrees && high < 1.0;
    finding.text = listed(finding.text,
                          fmt::format("{:.1f} to {:.1f} % of the triangles in the frustum are drawn in the "
                                      "frames shown of {}",
                                      100.0 * low, 100.0 * high, measured.name));
  }
  finding.text += ". The paper's pictures are of other models and are not among what we have of it";
  return finding;
}

Plot speedPlot(const std::vector<SpeedResult>& speeds) {
  Plot plot;
  plot.title = "Visibility time of a frame by the observer's speed";
  plot.x_label = "doublings of walking speed";
  plot.y_label = "us";
  plot.series = {{"relations kept", {}, kKeptPlanes},
                 {"nothing kept", {}, kKeptPlanes + 1},
                 {"planes through the eye", {}, kKeptPlanes + 2}};
  for (const SpeedResult& result : speeds) {
    plot.series[0].values.push_back(result.coherent_us - result.frustum_us);
    plot.series[1].values.push_back(result.incoherent_us - result.frustum_us);
    plot.series[2].values.push_back(result.through_eye_us - result.frustum_us);
  }
  return plot;
}

}  // namespace

std::vector<Experiment> tablesOf(const std::vector<SceneTimes>& scenes) {
  return {polygonsDrawn(scenes),  frameTime(scenes),   rendererModels(scenes),
          visibilityTime(scenes), nodesTested(scenes), memory(scenes)};
}

std::vector<Finding> findingsOf(const std::vector<SceneTimes>& scenes) {
  std::vector<Finding> findings{polygonsFinding(scenes), rendererFinding(scenes), speedFinding(scenes),
                                nodesFinding(scenes), pairsFinding(scenes)};
  if (std::ranges::all_of(scenes, &SceneTimes::drawn)) {
    findings.push_back(plateFinding(scenes));
  }
  return findings;
}

Report reportOf(const SceneTimes& measured, const std::vector<Experiment>& experiments,
                const ReproduceOptions& options) {
  const WalkRecord& record = measured.record;
  const ReportRow best = rowOf(record.runs[kKeptPlanes], record);
  Report report;
  report.title = "Coorg and Teller 1997: " + measured.name;
  report.summary = fmt::format(
      "Supporting planes with the occluders of the database draw {:.1f} % of the triangles that view-frustum "
      "culling draws.",
      100.0 * best.triangles_share);
  report.command = options.command_line;
  report.facts = walkFacts(
      {measured.name, measured.input.scene, measured.input.walk, measured.data, measured.input.closing},
      record);
  report.pictures = measured.plate;
  report.plots = plotsOf(record, measured.input.walk);
  report.plots.push_back(speedPlot(measured.speeds));
  for (const WalkRun& run : record.runs) {
    if (measured.drawn()) {
      report.rows.push_back(rowOf(run, record));
      report.rows.back().frames_differing.reset();  // pictures were timed, not compared
    }
    report.notes.push_back(statisticsText(run) + ".");
  }
  for (const Experiment& experiment : experiments) {
    if (!experiment.claim.empty()) {
      report.notes.push_back(fmt::format("{}. The paper: {}", experiment.title, experiment.claim));
    }
  }
  return report;
}

}  // namespace sightline::tool::coorg_teller
