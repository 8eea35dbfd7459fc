// The experiments of Snyder and Lengyel 1997, section 12: figures 18 to 21, the statistics of components, and
// the columns of the canyon's tables that sorting decides.
//
// Differs from the paper in: machine and, where the text does not describe it, scene. The published times, in
// ms on one 300 MHz Pentium II, stand beside ours in us.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "scenes/moving_scene.h"
#include "sightline/layers/compositing.h"
#include "sightline/layers/layer_sorter.h"
#include "tools/sightline/layer_input.h"
#include "tools/sightline/layer_totals.h"
#include "tools/sightline/progress_bar.h"
#include "tools/sightline/reproduction.h"
#include "tools/sightline/stopwatch.h"

namespace sightline::tool {
namespace {

using Frame = LayerTotals::Frame;

constexpr std::uint32_t kShortFrames = 25;

// A row of the paper's tables, its numbers in the order in which they are printed.
struct PaperRow {
  double at = 0.0;  // toothpicks, or velocity
  std::array<double, 4> values{};
};
// Figures 18 and 19: mean and largest ms of ud and us.
constexpr std::array<PaperRow, 7> kGrowth{{{25, {1.51, 2.40, 1.32, 2.28}},
                                           {50, {2.51, 3.55, 2.17, 3.11}},
                                           {100, {4.81, 6.28, 4.21, 5.57}},
                                           {200, {9.97, 11.8, 10.1, 11.9}},
                                           {400, {23.1, 26.3, 27.0, 30.5}},
                                           {800, {51.7, 56.9, 92.5, 134}},
                                           {1600, {122, 131, 849, 3090}}}};
// Figure 19: ms to build the kd-tree, ud and us.
constexpr std::array<PaperRow, 7> kBuilds{{{25, {6.61, 6.14}},
                                           {50, {9.52, 9.51}},
                                           {100, {17.5, 17.6}},
                                           {200, {36.6, 36.7}},
                                           {400, {75.9, 77.4}},
                                           {800, {173, 181}},
                                           {1600, {387, 442}}}};
// Figure 20: mean and largest ms.
constexpr std::array<PaperRow, 11> kVelocities{{{0.125, {8.73, 10.3}},
                                                {0.25, {9.15, 10.9}},
                                                {0.5, {9.52, 11.2}},
                                                {1, {9.78, 11.6}},
                                                {2, {11.0, 13.2}},
                                                {4, {12.6, 15.3}},
                                                {8, {13.8, 16.7}},
                                                {16, {16.1, 19.5}},
                                                {32, {19.3, 25.0}},
                                                {48, {22.5, 26.9}},
                                                {64, {25.2, 32.0}}}};
// Figure 21: mean ms with three directions and with one, ud and us.
constexpr std::array<PaperRow, 6> kDirections{{{50, {2.51, 2.65, 2.17, 2.28}},
                                               {100, {4.81, 5.48, 4.21, 4.79}},
                                               {200, {9.97, 12.7, 10.1, 12.9}},
                                               {400, {23.1, 38.0, 27.0, 47.2}},
                                               {800, {51.7, 124, 92.5, 215}},
                                               {1600, {122, 447, 849, 1780}}}};
// Shares of groups with more than one part, of parts in them; their mean size; the mean of the largest.
constexpr std::array<PaperRow, 3> kComponents{{{200, {0.0454, 0.0907, 2.097, 2.64}},
                                               {1600, {0.04633, 0.0929, 2.107, 3.672}},
                                               {1600, {0.2542, 0.5642, 3.798, 45.588}}}};

ToothpickOptions toothpicks(double count, bool uniform_density, double velocity = 1.0) {
  return {
      .count = static_cast<std::uint32_t>(count), .uniform_density = uniform_density, .velocity = velocity};
}

class Experiments {
 public:
  explicit Experiments(const ReproduceOptions& options) : options_(options) {}

  Reproduction run() {
    Reproduction result;
    result.experiments = {components(), growth(), builds(), velocities(), directions(), canyon()};
    Report report;
    report.title = "Snyder and Lengyel 1997";
    report.summary = "Visibility sorting without splitting: tumbling toothpicks and the canyon.";
    report.command = options_.command_line;
    report.plots = plots_;
    result.reports.push_back(std::move(report));
    return result;
  }

 private:
  std::uint32_t framesOf(const MovingScene& scene) const {
    return options_.fewer_frames ? std::min(kShortFrames, scene.frames) : scene.frames;
  }

  // visit(order, view) after each frame.
  template <typename Visit>
  LayerTotals sortAll(const MovingScene& scene, const LayerSettings& settings, Visit&& visit) {
    LayerSorter sorter = makeSorter(scene, settings);
    LayerTotals totals;
    std::vector<Mat4> poses;
    for (std::uint32_t frame = 0; frame < framesOf(scene); ++frame) {
      const View view = scene.scene.paths.front().view(frame, scene.scene.origin);
      pose(scene, frame, poses, sorter);
      Stopwatch watch;
      const LayerOrder& order = sorter.update(view);
      totals.add(order, 0.0, 0.0, watch.lap());
      visit(order, view);
    }
    return totals;
  }
  LayerTotals sortAll(const ToothpickOptions& options, const LayerSettings& settings) {
    return sortAll(makeToothpicks(options), settings, [](const LayerOrder&, const View&) {});
  }

  Experiment components() {
    Experiment table{"components",
                     "Components of the occlusion graph",
                     "as many in the second scene as in the first, since the density is the same",
                     {{"scene", "toothpicks"},
                      {"groups", "groups > 1", 4},
                      {"paper_groups", "paper", 4},
                      {"parts", "parts in them", 4},
                      {"paper_parts", "paper", 4},
                      {"size", "mean size", 3},
                      {"paper_size", "paper", 3},
                      {"largest", "largest", 2},
                      {"paper_largest", "paper", 2},
                      {"pairs", "exact pairs", 1}}};
    ProgressBar progress("components");
    for (std::size_t i = 0; i < kComponents.size(); ++i) {
      const PaperRow& paper = kComponents[i];
      const LayerTotals totals = sortAll(toothpicks(paper.at, i == 1), {});
      table.rows.push_back({{"scene", fmt::format("{:.0f}{}", paper.at,
                                                  i == 0   ? ""
                                                  : i == 1 ? " ud"
                                                           : " us")},
                            {"groups", totals.mean(&Frame::grouped_share)},
                            {"paper_groups", paper.values[0]},
                            {"parts", totals.mean(&Frame::parts_in_groups_share)},
                            {"paper_parts", paper.values[1]},
                            {"size", totals.meanGroupedSize()},
                            {"paper_size", paper.values[2]},
                            {"largest", totals.mean(&Frame::largest)},
                            {"paper_largest", paper.values[3]},
                            {"pairs", totals.mean(&Frame::pair_queries)}});
      progress.update(static_cast<double>(i + 1) / kComponents.size());
    }
    return table;
  }

  Experiment growth() {
    Experiment table{"growth",
                     "Figure 18: time of a frame by the number of toothpicks, us (paper: ms)",
                     "about linear at the same density (ud); faster at the same size (us), where groups grow",
                     {{"n", "toothpicks", 0}}};
    for (const char* scaling : {"ud", "us"}) {
      for (const auto& [key, head] : {std::pair("mean", "mean"),
                                      {"max", "max"},
                                      {"ivs", "incremental"},
                                      {"paper_mean", "paper mean"},
                                      {"paper_max", "paper max"}}) {
        table.columns.push_back({fmt::format("{}_{}", scaling, key), fmt::format("{} {}", scaling, head),
                                 std::string(key).starts_with("paper") ? 2 : 1});
      }
    }
    Plot plot{.title = "Figure 18: time of a frame by the number of toothpicks",
              .x_label = "doublings of 25 toothpicks",
              .y_label = "us",
              .log_y = true};
    plot.series = {
        {"same density"}, {"same size"}, {"same density, incremental"}, {"same size, incremental"}};
    ProgressBar progress("growth");
    for (std::size_t i = 0; i < kGrowth.size(); ++i) {
      const PaperRow& paper = kGrowth[i];
      Json row{{"n", paper.at}};
      for (const bool density : {true, false}) {
        const std::string scaling = density ? "ud" : "us";
        const std::size_t column = density ? 0 : 2;
        const LayerTotals own = sortAll(toothpicks(paper.at, density), {});
        const LayerTotals incremental =
            sortAll(toothpicks(paper.at, density), {.sort = LayerSort::kIncremental});
        row[scaling + "_mean"] = own.mean(&Frame::sort_us);
        row[scaling + "_max"] = own.largest(&Frame::sort_us);
        row[scaling + "_ivs"] = incremental.mean(&Frame::sort_us);
        row[scaling + "_paper_mean"] = paper.values[column];
        row[scaling + "_paper_max"] = paper.values[column + 1];
        plot.series[density ? 0 : 1].values.push_back(own.mean(&Frame::sort_us));
        plot.series[density ? 2 : 3].values.push_back(incremental.mean(&Frame::sort_us));
      }
      table.rows.push_back(std::move(row));
      progress.update(static_cast<double>(i + 1) / kGrowth.size());
    }
    plots_.push_back(std::move(plot));
    return table;
  }

  Experiment builds() {
    Experiment table{"builds",
                     "Figure 19: time to build the kd-tree, us (paper: ms)",
                     "about linear",
                     {{"n", "toothpicks", 0},
                      {"ud", "ud", 1},
                      {"paper_ud", "paper ud", 2},
                      {"us", "us", 1},
                      {"paper_us", "paper us", 2}}};
    Plot plot{.title = "Figure 19: time to build the kd-tree",
              .x_label = "doublings of 25 toothpicks",
              .y_label = "us",
              .series = {{"same density"}, {"same size"}},
              .log_y = true};
    for (const PaperRow& paper : kBuilds) {
      Json row{{"n", paper.at}, {"paper_ud", paper.values[0]}, {"paper_us", paper.values[1]}};
      for (const bool density : {true, false}) {
        const double us = buildTime(toothpicks(paper.at, density));
        row[density ? "ud" : "us"] = us;
        plot.series[density ? 0 : 1].values.push_back(us);
      }
      table.rows.push_back(std::move(row));
    }
    plots_.push_back(std::move(plot));
    return table;
  }

  // The least of some builds.
  double buildTime(const ToothpickOptions& options) {
    const MovingScene scene = makeToothpicks(options);
    LayerSorter sorter = makeSorter(scene, {.search = OccluderSearch::kTree});
    std::vector<Mat4> poses;
    pose(scene, 0, poses, sorter);
    sorter.update(scene.scene.paths.front().view(0, scene.scene.origin));
    double least = 1e300;
    for (int i = 0; i < 5; ++i) {
      Stopwatch watch;
      sorter.rebuildTree();
      least = std::min(least, watch.lap());
    }
    return least;
  }

  Experiment velocities() {
    Experiment table{"velocities",
                     "Figure 20: time of a frame by velocity, 200 toothpicks, us (paper: ms)",
                     "slow growth as coherence is lost",
                     {{"velocity", "velocity", 3},
                      {"mean", "mean", 1},
                      {"max", "max", 1},
                      {"incremental", "incremental", 1},
                      {"reinsertions", "reinsertions", 1},
                      {"paper_mean", "paper mean", 2},
                      {"paper_max", "paper max", 1}}};
    Plot plot{.title = "Figure 20: time of a frame by velocity, 200 toothpicks",
              .x_label = "place in the table",
              .y_label = "us",
              .series = {{"depth-first"}, {"incremental"}}};
    for (const PaperRow& paper : kVelocities) {
      const LayerTotals own = sortAll(toothpicks(200, false, paper.at), {});
      const LayerTotals incremental =
          sortAll(toothpicks(200, false, paper.at), {.sort = LayerSort::kIncremental});
      table.rows.push_back({{"velocity", paper.at},
                            {"mean", own.mean(&Frame::sort_us)},
                            {"max", own.largest(&Frame::sort_us)},
                            {"incremental", incremental.mean(&Frame::sort_us)},
                            {"reinsertions", incremental.mean(&Frame::reinsertions)},
                            {"paper_mean", paper.values[0]},
                            {"paper_max", paper.values[1]}});
      plot.series[0].values.push_back(own.mean(&Frame::sort_us));
      plot.series[1].values.push_back(incremental.mean(&Frame::sort_us));
    }
    plots_.push_back(std::move(plot));
    return table;
  }

  // k = 1: the tree divides along the camera's depth alone; extents are tested along all three.
  Experiment directions() {
    Experiment table{"directions",
                     "Figure 21: time of a frame with a tree over three directions and over depth alone, us "
                     "(paper: ms)",
                     "three are much better, the more so the more toothpicks there are",
                     {{"n", "toothpicks", 0}}};
    for (const char* scaling : {"ud", "us"}) {
      for (const auto& [key, head, decimals] : {std::tuple("k3", "k = 3", 1),
                                                {"k1", "k = 1", 1},
                                                {"more", "more %", 0},
                                                {"paper_k3", "paper k = 3", 2},
                                                {"paper_k1", "paper k = 1", 2}}) {
        table.columns.push_back(
            {fmt::format("{}_{}", scaling, key), fmt::format("{} {}", scaling, head), decimals});
      }
    }
    Plot plot{.title = "Figure 21: time of a frame by the tree's directions",
              .x_label = "doublings of 50 toothpicks",
              .y_label = "us",
              .series = {{"same density, k = 3"},
                         {"same density, k = 1"},
                         {"same size, k = 3"},
                         {"same size, k = 1"}},
              .log_y = true};
    LayerSettings three{.search = OccluderSearch::kTree}, one = three;
    one.tree.tree_axes = 1u << 2;
    ProgressBar progress("directions");
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
      const PaperRow& paper = kDirections[i];
      Json row{{"n", paper.at}};
      for (const bool density : {true, false}) {
        const std::string scaling = density ? "ud" : "us";
        const std::size_t column = density ? 0 : 2;
        const double k3 = sortAll(toothpicks(paper.at, density), three).mean(&Frame::sort_us);
        const double k1 = sortAll(toothpicks(paper.at, density), one).mean(&Frame::sort_us);
        row[scaling + "_k3"] = k3;
        row[scaling + "_k1"] = k1;
        row[scaling + "_more"] = 100.0 * (k1 / k3 - 1.0);
        row[scaling + "_paper_k3"] = paper.values[column];
        row[scaling + "_paper_k1"] = paper.values[column + 1];
        plot.series[column].values.push_back(k3);
        plot.series[column + 1].values.push_back(k1);
      }
      table.rows.push_back(std::move(row));
      progress.update(static_cast<double>(i + 1) / kDirections.size());
    }
    plots_.push_back(std::move(plot));
    return table;
  }

  Experiment canyon();

  const ReproduceOptions& options_;
  std::vector<Plot> plots_;
};

// What the paper's tables have of one division of the terrain.
struct CanyonRow {
  std::uint32_t grid = 0;
  double objects = 0, polygons = 0, hull_polygons = 0, cpu = 0, cpu_max = 0, expansion = 0, layers = 0,
         parts = 0, unit_agg = 0, unit = 0, poly_agg = 0, poly = 0;
};
constexpr std::array<CanyonRow, 5> kCanyon{
    {{20, 390, 31.98, 29.01, 17.33, 29.82, 5.04, 0.1, 0.2, 58.3, 58.1, 41.8, 40.7},
     {14, 191, 48.91, 37.78, 8.08, 14.59, 3.78, 0.4, 1.0, 51.3, 50.2, 38.0, 36.0},
     {10, 100, 76.48, 42.42, 5.17, 9.88, 3.09, 1.9, 6.4, 48.7, 40.9, 40.4, 30.7},
     {7, 49, 130.45, 57.51, 4.51, 9.68, 2.58, 5.2, 22.5, 51.9, 37.8, 42.4, 27.8},
     {5, 25, 225.32, 72.72, 5.37, 11.01, 2.28, 13.0, 53.1, 71.5, 32.3, 72.0, 26.1}}};

// The share of frames in which a part is rendered anew, the others being interpolated (section 12.2).
double updateRate(const std::string& part_class) {
  return part_class == "aircraft" ? 0.2 : part_class == "terrain" ? 0.7 : 0.4;
}

// The corners of a part's hulls are not all beyond one plane of the frustum.
bool inView(const MovingScene& scene, std::size_t part, const Mat4& world_from_part, const Frustum& frustum) {
  const auto beyond = [&](const Plane& plane) {
    for (const std::uint32_t hull : scene.parts[part].hulls) {
      for (const Vec3d& vertex : scene.hulls[hull].vertices) {
        if (plane.evaluate(transformPoint(world_from_part, vertex)) >= 0.0) {
          return false;
        }
      }
    }
    return true;
  };
  return std::none_of(frustum.planes.begin(), frustum.planes.end(), beyond);
}

// Sums over the visible parts of all frames.
struct UpdateRates {
  double layers = 0, aggregated_layers = 0, parts = 0, aggregated_parts = 0;
  double unit = 0, unit_agg = 0, weight = 0, poly = 0, poly_agg = 0;

  // expansion: a split terrain has so many times the polygons; rates count for the polygons that it has,
  // relative to those that the scene had.
  void add(double rate, bool aggregated, double polygons, double expansion) {
    const double with_penalty = aggregated ? 1.0 : rate;
    parts += 1.0;
    aggregated_parts += aggregated ? 1.0 : 0.0;
    unit += rate;
    unit_agg += with_penalty;
    weight += polygons / expansion;
    poly += rate * polygons;
    poly_agg += with_penalty * polygons;
  }
};

struct TerrainCounts {
  double pieces = 0, polygons = 0, hull_polygons = 0;
};

TerrainCounts countTerrain(const MovingScene& scene) {
  TerrainCounts counts;
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    if (scene.classes[scene.parts[part].class_of] == "terrain") {
      counts.pieces += 1.0;
      counts.polygons += scene.scene.objects[part].triangleCount();
      counts.hull_polygons += static_cast<double>(scene.hulls[scene.parts[part].hulls.front()].faces.size());
    }
  }
  return counts;
}

void addFrame(const MovingScene& scene, const FrameLayers& layers, const std::vector<Mat4>& poses,
              const View& view, double expansion, UpdateRates& rates) {
  const Frustum frustum = frustumOf(view);
  std::vector<PartId> visible;
  for (std::uint32_t layer = 0; layer < layers.layers(); ++layer) {
    visible.clear();
    for (const PartId part : layers.partsOf(LayerId(layer))) {
      if (inView(scene, part.value, poses[part.value], frustum)) {
        visible.push_back(part);
      }
    }
    const bool aggregated = visible.size() > 1;
    rates.layers += visible.empty() ? 0.0 : 1.0;
    rates.aggregated_layers += aggregated ? 1.0 : 0.0;
    for (const PartId part : visible) {
      const std::string& part_class = scene.classes[scene.parts[part.value].class_of];
      rates.add(updateRate(part_class), aggregated, scene.scene.objects[part.value].triangleCount(),
                part_class == "terrain" ? expansion : 1.0);
    }
  }
}

Experiment Experiments::canyon() {
  Experiment table{
      "canyon",
      "The canyon by the terrain's grid (each second line: the paper's; cpu in us, the paper's in ms)",
      "the least polygon-weighted update rate, 38 %, with 14 x 14; coarser grids aggregate",
      {{"grid", "grid"},
       {"objects", "pieces", 0},
       {"polygons", "polygons each", 2},
       {"hull_polygons", "hull polygons", 2},
       {"cpu", "cpu mean", 1},
       {"cpu_max", "cpu max", 1},
       {"expansion", "expansion", 2},
       {"layers", "layers agg %", 1},
       {"parts", "parts agg %", 1},
       {"unit_agg", "unit agg", 1},
       {"unit", "no agg", 1},
       {"poly_agg", "poly agg", 1},
       {"poly", "no agg", 1}}};
  const double unsplit = countTerrain(makeCanyon({.grid = 1, .inflation = 0.0})).polygons;
  ProgressBar progress("canyon");
  for (std::size_t i = 0; i < kCanyon.size(); ++i) {
    const CanyonRow& paper = kCanyon[i];
    const MovingScene scene = makeCanyon({.grid = paper.grid});
    const TerrainCounts terrain = countTerrain(scene);
    const double expansion = terrain.polygons / unsplit;
    UpdateRates rates;
    LayerMerger merger;
    std::vector<Mat4> poses(scene.parts.size());
    std::uint32_t frame = 0;
    const LayerTotals totals = sortAll(scene, {.extents = worldExtents(), .conditioning_axis = -1},
                                       [&](const LayerOrder& order, const View& view) {
                                         scene.pose(frame++, poses);
                                         addFrame(scene, merger.merge(order), poses, view, expansion, rates);
                                       });
    table.rows.push_back({{"grid", fmt::format("{0} x {0}", paper.grid)},
                          {"objects", terrain.pieces},
                          {"polygons", terrain.polygons / terrain.pieces},
                          {"hull_polygons", terrain.hull_polygons / terrain.pieces},
                          {"cpu", totals.mean(&Frame::sort_us)},
                          {"cpu_max", totals.largest(&Frame::sort_us)},
                          {"expansion", expansion},
                          {"layers", 100.0 * rates.aggregated_layers / rates.layers},
                          {"parts", 100.0 * rates.aggregated_parts / rates.parts},
                          {"unit_agg", 100.0 * rates.unit_agg / rates.parts},
                          {"unit", 100.0 * rates.unit / rates.parts},
                          {"poly_agg", 100.0 * rates.poly_agg / rates.weight},
                          {"poly", 100.0 * rates.poly / rates.weight}});
    table.rows.push_back({{"grid", "  paper"},
                          {"objects", paper.objects},
                          {"polygons", paper.polygons},
                          {"hull_polygons", paper.hull_polygons},
                          {"cpu", paper.cpu},
                          {"cpu_max", paper.cpu_max},
                          {"expansion", paper.expansion},
                          {"layers", paper.layers},
                          {"parts", paper.parts},
                          {"unit_agg", paper.unit_agg},
                          {"unit", paper.unit},
                          {"poly_agg", paper.poly_agg},
                          {"poly", paper.poly}});
    progress.update(static_cast<double>(i + 1) / kCanyon.size());
  }
  return table;
}

}  // namespace

Result<Reproduction> reproduceSnyderLengyel(const ReproduceOptions& options,
                                            const std::vector<SceneAndWalk>&) {
  return Experiments(options).run();
}

}  // namespace sightline::tool
