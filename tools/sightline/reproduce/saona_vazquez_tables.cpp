#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/sightline/report/markup.h"
#include "tools/sightline/reproduce/saona_vazquez.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool::saona_vazquez {
namespace {

constexpr const char* kCullings[] = {"frustum", "octree"};  // the runs of a navigation

template <typename Of>
Spread spreadOfFrames(const WalkRun& run, Of of) {
  std::vector<double> values;
  for (const FrameRecord& frame : run.frames) {
    values.push_back(of(frame));
  }
  return spreadOf(values);
}

double framesPerSecond(const FrameRecord& frame) {
  return 1e6 / frame.frameUs();
}

void addSpread(Json& row, const Spread& spread) {
  row["mean"] = spread.mean;
  row["deviation"] = spread.deviation;
  row["min"] = spread.min;
  row["max"] = spread.max;
}

// Appends columns for the mean, deviation, min and max.
std::vector<Column> withSpread(std::vector<Column> first, int decimals) {
  first.insert(first.end(), {{"mean", "mean", decimals},
                             {"deviation", "std. dev.", decimals},
                             {"min", "min", decimals},
                             {"max", "max", decimals}});
  return first;
}

Experiment leafTable(const std::vector<Measured>& scenes) {
  Experiment experiment{"leaves", "Table 2. Depth of leaves and triangles that may be seen from them",
                        "even from the worst node a significant part of the scene is culled.",
                        withSpread({{"scene", "scene"}, {"of", ""}}, 2)};
  for (const Measured& measured : scenes) {
    const Spread triangles = measured.facts.sizes.triangles;
    const double percent = 100.0 / static_cast<double>(measured.scene.triangleCount());
    const Spread share{triangles.count, triangles.mean * percent, triangles.deviation * percent,
                       triangles.min * percent, triangles.max * percent};
    const std::vector<std::pair<const char*, Spread>> rows{
        {"depth", spreadOf(measured.leaves.depths)}, {"triangles", triangles}, {"% of the scene's", share}};
    for (const auto& [of, spread] : rows) {
      Json row = {{"scene", measured.name}, {"of", of}};
      addSpread(row, spread);
      experiment.rows.push_back(std::move(row));
    }
  }
  return experiment;
}

Experiment levelTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "levels", "Table 3. Triangles that may be seen from leaves, by depth, and why leaves were not divided",
      "leaves appear at several depths; on the upper levels they meet the budget, deeper ones do so in fewer "
      "cases: there subdivision stops for want of occluders.",
      withSpread({{"scene", "scene"}, {"level", "level", 0}, {"leaves", "leaves", 0}}, 0)};
  const std::vector<std::pair<StopReason, Column>> reasons{
      {StopReason::kBudgetMet, {"budget_met", "budget met", 0}},
      {StopReason::kNothingGained, {"nothing_gained", "nothing gained", 0}},
      {StopReason::kMaxDepth, {"max_depth", "deepest", 0}},
      {StopReason::kMerged, {"merged", "merged", 0}}};
  for (const auto& [reason, column] : reasons) {
    experiment.columns.push_back(column);
  }
  for (const Measured& measured : scenes) {
    for (std::size_t level = 0; level < measured.facts.level_sizes.size(); ++level) {
      const auto& of_level = measured.leaves.reasons[level];
      std::uint64_t leaves = 0;
      Json row = {{"scene", measured.name}, {"level", level}};
      for (const auto& [reason, column] : reasons) {
        row[column.key] = of_level[static_cast<std::size_t>(reason)];
        leaves += of_level[static_cast<std::size_t>(reason)];
      }
      row["leaves"] = leaves;
      addSpread(row, measured.facts.level_sizes[level].triangles);
      if (leaves > 0) {
        experiment.rows.push_back(std::move(row));
      }
    }
  }
  return experiment;
}

Experiment histogramTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "histograms",
      "Histograms of the triangles that may be seen, by depth: sets by tenths of the scene's triangles",
      "most leaves are on one level, the one from whose leaves about as much may be seen as the budget "
      "allows; "
      "the seventh level is drawn by itself.",
      {{"scene", "scene"}, {"level", "level", 0}}};
  for (std::size_t bar = 0; bar < kShares; ++bar) {
    experiment.columns.push_back(
        {fmt::format("to_{}", 10 * (bar + 1)), fmt::format("to {} %", 10 * (bar + 1)), 0});
  }
  for (const Measured& measured : scenes) {
    for (std::size_t level = 0; level < measured.facts.level_sizes.size(); ++level) {
      const SetSizes& sizes = measured.facts.level_sizes[level];
      Json row = {{"scene", measured.name}, {"level", level}};
      for (std::size_t bar = 0; bar < kShares; ++bar) {
        row[experiment.columns[2 + bar].key] = sizes.histogram[bar];
      }
      if (sizes.triangles.count > 0) {
        experiment.rows.push_back(std::move(row));
      }
    }
  }
  return experiment;
}

Experiment gridTable(const std::vector<Measured>& scenes) {
  Experiment experiment{"uniform_grid",
                        "Leaves of the octree against voxels of a uniform grid of the same resolution",
                        "the octree needs far fewer; that is its advantage in space.",
                        {{"scene", "scene"},
                         {"leaves", "leaves", 0},
                         {"with_viewers", "where viewers are", 0},
                         {"voxels_in_box", "voxels in the scene's box", 0},
                         {"voxels_in_root", "voxels in the root's cube", 0},
                         {"percent", "those, % of the box's", 2},
                         {"different_sets", "different sets", 0}}};
  for (const Measured& measured : scenes) {
    const double voxels = voxelsInBox(measured);
    const std::size_t leaves = measured.leaves.depths.size();
    experiment.rows.push_back({{"scene", measured.name},
                               {"leaves", measured.facts.cells},
                               {"with_viewers", leaves},
                               {"voxels_in_box", voxels},
                               {"voxels_in_root", measured.facts.grid_cells},
                               {"percent", 100.0 * static_cast<double>(leaves) / voxels},
                               {"different_sets", measured.baked.file.setCount()}});
  }
  return experiment;
}

// Calls add_to(scene, navigation, run, row) for each method on each navigation.
template <typename AddTo>
void forEachRun(const std::vector<Measured>& scenes, AddTo&& add_to) {
  for (const Measured& measured : scenes) {
    for (const Navigation& navigation : measured.navigations) {
      for (std::size_t c = 0; c < navigation.record.runs.size(); ++c) {
        add_to(measured, navigation, navigation.record.runs[c],
               Json{{"scene", measured.name},
                    {"navigation", navigation.walk.path.name},
                    {"culling", kCullings[c]}});
      }
    }
  }
}

Experiment polygonTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "polygons_sent",
      "Table 4. Triangles sent in a frame: hierarchical view-frustum culling against the octree",
      "with the octree the mean is significantly below the mean of what is weakly visible from a node, since "
      "the list is culled by the view frustum as well.",
      withSpread({{"scene", "scene"}, {"navigation", "navigation"}, {"culling", "culling"}}, 0)};
  experiment.columns.push_back({"percent_of_frustum", "% of frustum's", 1});
  forEachRun(scenes, [&](const Measured&, const Navigation& navigation, const WalkRun& run, Json row) {
    const auto triangles = [](const FrameRecord& frame) { return static_cast<double>(frame.triangles); };
    addSpread(row, spreadOfFrames(run, triangles));
    row["percent_of_frustum"] =
        100.0 * run.mean(triangles) / std::max(1.0, navigation.record.baseline().mean(triangles));
    experiment.rows.push_back(std::move(row));
  });
  return experiment;
}

Experiment rateTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "frame_rate", "Table 5. Frames a second: hierarchical view-frustum culling against the octree",
      "the octree improves the frame rate by a factor; the deviation is low, so the improvement is "
      "sustained.",
      withSpread({{"scene", "scene"}, {"navigation", "navigation"}, {"culling", "culling"}}, 1)};
  experiment.columns.push_back({"frame_ms", "frame ms", 3});
  experiment.columns.push_back({"speed_up", "speed-up", 2});
  forEachRun(scenes,
             [&](const Measured& measured, const Navigation& navigation, const WalkRun& run, Json row) {
               if (!measured.drawn()) {
                 return;
               }
               const auto time = [](const FrameRecord& frame) { return frame.frameUs() * 1e-3; };
               addSpread(row, spreadOfFrames(run, framesPerSecond));
               row["frame_ms"] = run.mean(time);
               row["speed_up"] = navigation.record.baseline().mean(time) / run.mean(time);
               experiment.rows.push_back(std::move(row));
             });
  return experiment;
}

Experiment lookUpTable(const std::vector<Measured>& scenes) {
  Experiment experiment{"look_up",
                        "Time of culling a frame, and of the look-up in it",
                        "navigation is the simplest part; its cost is small.",
                        {{"scene", "scene"},
                         {"navigation", "navigation"},
                         {"frames", "frames", 0},
                         {"frustum_us", "frustum us", 2},
                         {"octree_us", "octree us", 2},
                         {"look_up_us", "look-up us", 3},
                         {"first_find_us", "find alone, first us", 3},
                         {"find_ns", "again, ns", 1}}};
  for (const Measured& measured : scenes) {
    for (const Navigation& navigation : measured.navigations) {
      const auto cull = [](const FrameRecord& frame) { return frame.cull_us; };
      const WalkRun& octree = navigation.record.runs[1];
      experiment.rows.push_back(
          {{"scene", measured.name},
           {"navigation", navigation.walk.path.name},
           {"frames", octree.frames.size()},
           {"frustum_us", navigation.record.baseline().mean(cull)},
           {"octree_us", octree.mean(cull)},
           {"look_up_us", octree.mean([](const FrameRecord& frame) { return frame.stats.look_up_us; })},
           {"first_find_us", navigation.first_find_us},
           {"find_ns", navigation.find_ns}});
    }
  }
  return experiment;
}

Experiment bakeTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "bake",
      "Time and memory of the bake, and what it leaves",
      "memory is high while the octree is computed, most of it for the list of samples; computing it in "
      "pieces takes less, and longer, since samples are computed again. The finished octree is far "
      "smaller.",
      {{"scene", "scene"},
       {"budget", "budget", 0},
       {"depth", "depth", 0},
       {"occluders", "occluders", 0},
       {"plan_s", "plan s", 2},
       {"bake_s", "bake s", 2},
       {"samples", "samples", 0},
       {"forgotten", "forgotten", 0},
       {"sample_mib", "samples MiB", 2},
       {"peak_mib", "peak MiB", 1},
       {"file_mib", "file MiB", 3},
       {"samples_to_file", "samples / file", 1}}};
  for (const Measured& measured : scenes) {
    const Effort& effort = measured.baked.effort;
    const BakeRecord& record = measured.baked.file.record();
    const auto samples = static_cast<double>(effort.stats.max_sample_bytes);
    const auto file = static_cast<double>(measured.baked.file.fileBytes());
    experiment.rows.push_back({{"scene", measured.name},
                               {"budget", record.triangle_budget},
                               {"depth", record.max_depth},
                               {"occluders", effort.occluders},
                               {"plan_s", effort.plan_s},
                               {"bake_s", effort.bake_s},
                               {"samples", effort.stats.samples},
                               {"forgotten", effort.stats.forgotten},
                               {"sample_mib", samples / kMebibyte},
                               {"peak_mib", static_cast<double>(effort.peak_bytes) / kMebibyte},
                               {"file_mib", file / kMebibyte},
                               {"samples_to_file", samples / file}});
  }
  return experiment;
}

Experiment pieceTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "pieces",
      "The same bake in pieces, each computed by itself: the cost of a piece, and of all",
      "the octree was computed in pieces to keep memory low; the smaller they get, the more samples are "
      "computed repeatedly, and the total time grows. (Of the published mean, deviation and largest, the "
      "numbers are not among what we have of the paper.)",
      {{"scene", "scene"},
       {"parts", "pieces", 0},
       {"part_ms", "ms, mean", 2},
       {"part_deviation_ms", "std. dev.", 2},
       {"part_max_ms", "largest", 2},
       {"part_mib", "samples MiB, mean", 3},
       {"part_deviation_mib", "std. dev.", 3},
       {"part_max_mib", "largest", 3},
       {"whole_s", "whole s", 2},
       {"apart_s", "in pieces s", 2},
       {"whole_samples", "samples whole", 0},
       {"apart_samples", "in pieces", 0}}};
  for (const Measured& measured : scenes) {
    const Effort& effort = measured.baked.effort;
    experiment.rows.push_back({{"scene", measured.name},
                               {"parts", effort.part_ms.count},
                               {"part_ms", effort.part_ms.mean},
                               {"part_deviation_ms", effort.part_ms.deviation},
                               {"part_max_ms", effort.part_ms.max},
                               {"part_mib", effort.part_mib.mean},
                               {"part_deviation_mib", effort.part_mib.deviation},
                               {"part_max_mib", effort.part_mib.max},
                               {"whole_s", effort.whole_s},
                               {"apart_s", effort.apart_s},
                               {"whole_samples", effort.stats.samples},
                               {"apart_samples", effort.apart_samples}});
  }
  return experiment;
}

Experiment budgetTable(const std::vector<Measured>& scenes) {
  Experiment experiment{"budgets",
                        "Leaves of octrees of the same depth with larger budgets",
                        "on the upper levels leaves meet the budget, and are not divided.",
                        {{"scene", "scene"},
                         {"budget_percent", "% of the scene", 0},
                         {"budget", "budget", 0},
                         {"leaves", "leaves", 0},
                         {"met_percent", "% meet it", 1},
                         {"depth", "depth, mean", 2},
                         {"triangles", "triangles, mean", 0},
                         {"bake_s", "bake s", 2},
                         {"file_mib", "file MiB", 3}}};
  for (const Measured& measured : scenes) {
    for (const BudgetResult& result : measured.budgets) {
      experiment.rows.push_back({{"scene", measured.name},
                                 {"budget_percent", result.percent},
                                 {"budget", result.triangles},
                                 {"leaves", result.depths.size()},
                                 {"met_percent", metPercent(result)},
                                 {"depth", spreadOf(result.depths).mean},
                                 {"triangles", result.mean_triangles},
                                 {"bake_s", result.bake_s},
                                 {"file_mib", static_cast<double>(result.file_bytes) / kMebibyte}});
    }
  }
  return experiment;
}

Plot leafPlot(const Measured& measured) {
  Plot plot{.title = "Leaves by depth", .x_label = "depth", .y_label = "leaves"};
  plot.series = {{"leaves where viewers are"}};
  for (std::size_t level = 0; level < measured.facts.level_sizes.size(); ++level) {
    const auto& reasons = measured.leaves.reasons[level];
    plot.series[0].values.push_back(
        static_cast<double>(std::accumulate(reasons.begin(), reasons.end(), std::uint64_t{0})));
  }
  return plot;
}

Plot histogramPlot(const Measured& measured) {
  Plot plot{.title = "Triangles that may be seen, by depth",
            .x_label = "up to so many tenths of the scene's triangles",
            .y_label = "sets",
            .log_y = true,
            .first_x = 1.0};
  for (std::size_t level = 0; level < measured.facts.level_sizes.size(); ++level) {
    const SetSizes& sizes = measured.facts.level_sizes[level];
    if (sizes.triangles.count > 0) {
      plot.series.push_back(
          {fmt::format("depth {}", level), {sizes.histogram.begin(), sizes.histogram.end()}});
    }
  }
  return plot;
}

}  // namespace

double voxelsInBox(const Measured& measured) {
  const OctreeView octree = measured.baked.file.octree();
  const Box bounds = sceneBounds(measured.scene.view());
  const Vec3d extent = Vec3d(bounds.max) - Vec3d(bounds.min);
  const double edge = std::ldexp(octree.max.x - octree.min.x, -static_cast<int>(measured.facts.deepest));
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    voxels *= std::max(1.0, std::ceil(extent[axis] / edge));
  }
  return voxels;
}

double metPercent(const BudgetResult& result) {
  return 100.0 * static_cast<double>(result.met) / std::max(1.0, static_cast<double>(result.depths.size()));
}

std::vector<Experiment> tablesOf(const std::vector<Measured>& scenes) {
  return {leafTable(scenes),   levelTable(scenes),   histogramTable(scenes), gridTable(scenes),
          budgetTable(scenes), polygonTable(scenes), rateTable(scenes),      lookUpTable(scenes),
          bakeTable(scenes),   pieceTable(scenes)};
}

namespace {

std::string pieceText(const Effort& effort) {
  return fmt::format(
      "{:.1f} ms in the mean, deviation {:.1f}, {:.1f} at most; samples {:.2f} MiB, {:.2f}, {:.2f}",
      effort.part_ms.mean, effort.part_ms.deviation, effort.part_ms.max, effort.part_mib.mean,
      effort.part_mib.deviation, effort.part_mib.max);
}

}  // namespace

Report reportOf(const Measured& measured, const std::vector<Experiment>& experiments,
                const ReproduceOptions& options) {
  Report report;
  report.title = "Saona-Vazquez, Navazo and Brunet 1999: " + measured.name;
  report.summary = "The visibility octree against hierarchical view-frustum culling.";
  report.command = options.command_line;
  report.facts = {
      {"objects", grouped(measured.scene.objects.size())},
      {"triangles", grouped(measured.scene.triangleCount())},
      {"potential occluders", grouped(measured.baked.effort.occluders)},
      {"leaves", grouped(measured.facts.cells)},
      {"file", grouped(measured.baked.file.fileBytes()) + " bytes"},
      {"a piece of the bake", pieceText(measured.baked.effort)},
      {"OpenGL", measured.drawn() ? measured.navigations.front().record.device : "none: nothing was drawn"}};
  report.plots = {leafPlot(measured), histogramPlot(measured)};
  for (const Navigation& navigation : measured.navigations) {
    std::vector<Plot> plots = plotsOf(navigation.record, navigation.walk);
    plots.pop_back();  // neither asks an occlusion structure about nodes
    for (Plot& plot : plots) {
      for (std::size_t c = 0; c < plot.series.size(); ++c) {
        plot.series[c].name = kCullings[c];
      }
      plot.title += ", " + navigation.walk.path.name;
      report.plots.push_back(std::move(plot));
    }
    for (const WalkRun& run : navigation.record.runs) {
      if (measured.drawn()) {
        report.rows.push_back(rowOf(run, navigation.record));
        report.rows.back().options += ", " + navigation.walk.path.name;
        report.rows.back().frames_differing.reset();  // pictures were timed, not compared
      }
    }
  }
  for (const Experiment& experiment : experiments) {
    report.notes.push_back(fmt::format("{}. The paper: {}", experiment.title, experiment.claim));
  }
  return report;
}

}  // namespace sightline::tool::saona_vazquez
