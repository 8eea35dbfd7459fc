// The experiments of Coorg and Teller 1997, section 6.
//
// Differs from the paper in: scenes, machine and renderer are those of today. The paper's results for a whole
// walk stand beside view-frustum culling alone and beside occluders that are chosen anew in every frame. The
// observer's speeds are compared on the same stretches of the walk.

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/reproduce/observer_speeds.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/walk/walk_report.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kStretchFrames = 800, kFewerStretchFrames = 160;
constexpr std::size_t kBaseline = 0, kKeptPlanes = 1;  // indices in kCullings
constexpr double kMebibyte = 1024.0 * 1024.0;

// The methods that are compared, with their names in the tables. The paper's own method follows the baseline.
struct Culling {
  const char* name;
  const char* method = "supporting-planes";
  OccluderChoice occluders = OccluderChoice::kDatabase;
  PlaneForm form = PlaneForm::kThroughEye;
  bool detail_objects = false;
};
constexpr Culling kCullings[] = {
    {.name = "frustum", .method = "frustum"},
    {.name = "database, kept planes", .form = PlaneForm::kThroughBox},
    {.name = "database, planes through the eye"},
    {.name = "... and detail objects", .detail_objects = true},
    {.name = "area-angle, planes through the eye", .occluders = OccluderChoice::kAreaAngle},
};

std::vector<Setting> allSettings() {
  std::vector<Setting> settings;
  for (const Culling& culling : kCullings) {
    Setting setting;
    setting.hierarchy = HierarchyKind::kKdTree;  // the paper's
    setting.method = &methodNamed(culling.method);
    setting.plane_form = culling.form;
    setting.occluders = culling.occluders;
    setting.detail_objects = culling.detail_objects;
    settings.push_back(setting);
  }
  return settings;
}

// All that is measured on one scene.
struct Measured {
  const std::string& name;
  const SceneAndWalk& input;
  CullingData data;
  WalkRecord record{};
  double nodes_in_frustum = 0.0;  // mean over all frames
  std::vector<SpeedResult> speeds{};

  bool drawn() const { return !record.device.empty(); }
};

std::size_t nodesInFrustum(const Hierarchy& hierarchy, const View& view) {
  const Frustum frustum = frustumOf(view);
  return static_cast<std::size_t>(
      std::count_if(hierarchy.nodes.begin(), hierarchy.nodes.end(), [&](const HierarchyNode& node) {
        std::uint8_t planes = kAllFrustumPlanes;
        return classify(frustum, node.bounds, planes) != FrustumSide::kOutside;
      }));
}

// Without a renderer (null) nothing is drawn.
void walkThrough(Measured& measured, Renderer* renderer) {
  const Walk& walk = measured.input.walk;
  const Hierarchy& kd_tree = measured.data.hierarchy(HierarchyKind::kKdTree);
  measured.record.runs = makeRuns(allSettings(), measured.data);
  measured.record.device = renderer != nullptr ? renderer->device() : "";
  ProgressBar progress("walking");
  for (std::size_t i = 0; i < walk.frames.size(); ++i) {
    const View view = walk.view(walk.frames[i], measured.input.scene);
    cullFrame(measured.record.runs, measured.data, walk.frames[i], view);
    if (renderer != nullptr) {
      drawFrame(measured.record.runs, view, *renderer, nullptr);
    }
    measured.nodes_in_frustum += static_cast<double>(nodesInFrustum(kd_tree, view));
    progress.update(static_cast<double>(i + 1) / static_cast<double>(walk.frames.size()));
  }
  measured.nodes_in_frustum /= static_cast<double>(walk.frames.size());
}

// Adds one row for each of kCullings from `first` on.
template <typename RowOf>
void addRows(Experiment& experiment, const Measured& measured, std::size_t first, RowOf&& row_of) {
  for (std::size_t c = first; c < measured.record.runs.size(); ++c) {
    Json row = {{"scene", measured.name}, {"culling", kCullings[c].name}};
    row.update(row_of(measured.record.runs[c], rowOf(measured.record.runs[c], measured.record)));
    experiment.rows.push_back(std::move(row));
  }
}

Experiment polygonsDrawn(const std::vector<Measured>& scenes) {
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
  for (const Measured& measured : scenes) {
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

Experiment frameTime(const std::vector<Measured>& scenes) {
  Experiment experiment{"frame_time",
                        "2. Time of a frame, mean of the walk",
                        "the total falls, too; the slower the graphics hardware, the more is gained.",
                        {{"scene", "scene"}, {"culling", "culling"}, {"cull_ms", "cull ms", 3}}};
  if (std::any_of(scenes.begin(), scenes.end(), [](const Measured& scene) { return scene.drawn(); })) {
    experiment.columns.insert(
        experiment.columns.end(),
        {{"draw_ms", "draw ms", 3}, {"total_ms", "total ms", 3}, {"speed_up", "speed-up", 2}});
  }
  for (const Measured& measured : scenes) {
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

Experiment visibilityTime(const std::vector<Measured>& scenes) {
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
  for (const Measured& measured : scenes) {
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

Experiment nodesTested(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "nodes_tested",
      "4. Nodes of the kd-tree tested for occlusion, mean of the walk",
      "only a part of the kd-tree's nodes in the view frustum is tested in a frame: spatial coherence.",
      {{"scene", "scene"},
       {"culling", "culling"},
       {"height", "height", 0},
       {"nodes", "nodes", 0},
       {"nodes_in_frustum", "in frustum", 1},
       {"nodes_tested", "tested", 1},
       {"percent", "% of all", 2},
       {"percent_of_frustum", "% of frustum's", 2},
       {"occluders", "occluders", 1}}};
  for (const Measured& measured : scenes) {
    addRows(experiment, measured, kKeptPlanes, [&](const WalkRun& run, const ReportRow& row) -> Json {
      return {{"height", run.hierarchy_depth},
              {"nodes", run.hierarchy_nodes},
              {"nodes_in_frustum", measured.nodes_in_frustum},
              {"nodes_tested", row.nodes_tested},
              {"percent", 100.0 * row.nodes_tested / static_cast<double>(run.hierarchy_nodes)},
              {"percent_of_frustum", 100.0 * row.nodes_tested / std::max(1.0, measured.nodes_in_frustum)},
              {"occluders", row.occluders}};
    });
  }
  return experiment;
}

Experiment memory(const std::vector<Measured>& scenes) {
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
  for (const Measured& measured : scenes) {
    const WalkRun& kept = measured.record.runs[kKeptPlanes];
    const OccluderDatabase& database = measured.data.database()->database;
    experiment.rows.push_back(
        {{"scene", measured.name},
         {"objects", measured.input.scene.objects.size()},
         {"triangles", measured.input.scene.triangleCount()},
         {"potential_occluders", measured.data.occluders().occluders.size()},
         {"relations", kept.peak("relations", "kept")},
         {"relation_mib", static_cast<double>(kept.peak("relations", "bytes")) / kMebibyte},
         {"database_cells", database.cellCount()},
         {"database_directions", database.directionCount()},
         {"database_mib", static_cast<double>(database.bytes()) / kMebibyte},
         {"database_build_ms", measured.data.database()->build_us * 1e-3}});
  }
  return experiment;
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

Report reportOf(const Measured& measured, const std::vector<Experiment>& experiments,
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

}  // namespace

Result<Reproduction> reproduceCoorgTeller(const ReproduceOptions& options,
                                          const std::vector<SceneAndWalk>& inputs) {
  const Threads threads(options.threads);
  Reproduction result;
  std::vector<Measured> scenes;
  scenes.reserve(inputs.size());  // cullers hold on to their scene's data
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const SceneAndWalk& input = inputs[i];
    Measured& measured = scenes.emplace_back(
        Measured{options.scenes[i], input, CullingData(input.scene, threads.parallelFor(), input.walk)});
    const auto [width, height] = pictureSize(options.picture, input.walk.path);
    Result<Renderer> renderer = Renderer::create(input.scene.view(), width, height);
    measured.record.width = width;
    measured.record.height = height;
    if (!renderer) {
      result.notes.push_back(
          fmt::format("{}: nothing was drawn: {}", measured.name, renderer.error().message));
    }
    walkThrough(measured, renderer ? &*renderer : nullptr);
    measured.speeds = measureSpeeds(input, measured.data, allSettings()[kKeptPlanes],
                                    options.fewer_frames ? kFewerStretchFrames : kStretchFrames);
    if (measured.speeds.empty()) {
      result.notes.push_back(measured.name + ": its path is too short for experiment 3.");
    }
  }
  result.experiments = {polygonsDrawn(scenes), frameTime(scenes), visibilityTime(scenes), nodesTested(scenes),
                        memory(scenes)};
  for (const Measured& measured : scenes) {
    result.reports.push_back(reportOf(measured, result.experiments, options));
  }
  return result;
}

}  // namespace sightline::tool
