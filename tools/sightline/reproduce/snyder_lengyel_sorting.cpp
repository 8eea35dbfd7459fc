// Snyder and Lengyel 1997, section 12.1: figures 18 to 21 and the statistics of components.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "sightline/comparison/layer_sorting.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/stopwatch.h"
#include "tools/sightline/reproduce/snyder_lengyel.h"

namespace sightline::tool {
namespace {

using Frame = LayerTotals::Frame;

// A row of the paper's tables, its numbers in the order in which they are printed.
struct PaperRow {
  double at = 0.0;  // number of toothpicks, or velocity
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
// The share of groups with more than one part, the share of parts in them, their mean size, and the mean of
// the largest.
constexpr std::array<PaperRow, 3> kComponents{{{200, {0.0454, 0.0907, 2.097, 2.64}},
                                               {1600, {0.04633, 0.0929, 2.107, 3.672}},
                                               {1600, {0.2542, 0.5642, 3.798, 45.588}}}};

ToothpickOptions toothpicks(double count, bool uniform_density, double velocity = 1.0) {
  return {
      .count = static_cast<std::uint32_t>(count), .uniform_density = uniform_density, .velocity = velocity};
}

class SortingExperiments {
 public:
  explicit SortingExperiments(const ReproduceOptions& options) : options_(options) {}

  SortingTables run() {
    SortingTables tables;
    tables.experiments = {components(), growth(), builds(), velocities(), directions()};
    tables.plots = std::move(plots_);
    return tables;
  }

 private:
  LayerTotals sortAll(const ToothpickOptions& toothpicks, const LayerSettings& settings) {
    return sortFrames(makeToothpicks(toothpicks), settings, options_);
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
        const LayerTotals incremental = sortAll(toothpicks(paper.at, density), {.sort = incrementalSort()});
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

  // The fastest of several builds.
  double buildTime(const ToothpickOptions& options) {
    const MovingScene scene = makeToothpicks(options);
    LayerSorter sorter = makeSorter(scene, {.search = extentTree()});
    std::vector<Mat4> poses;
    pose(scene, 0, poses, sorter);
    sorter.update(scene.scene.paths.front().view(0, scene.scene.origin));
    double fastest = 1e300;
    for (int i = 0; i < 5; ++i) {
      Stopwatch watch;
      sorter.rebuildSearch();
      fastest = std::min(fastest, watch.lap());
    }
    return fastest;
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
      const LayerTotals incremental = sortAll(toothpicks(200, false, paper.at), {.sort = incrementalSort()});
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

  // With k = 1 the tree divides along the camera's depth alone; extents are still tested along all three.
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
    LayerSettings three{.search = extentTree()};
    LayerSettings one{.search = extentTree({.tree_axes = 1u << 2})};
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

  const ReproduceOptions& options_;
  std::vector<Plot> plots_;
};

}  // namespace

SortingTables sortingTables(const ReproduceOptions& options) {
  return SortingExperiments(options).run();
}

}  // namespace sightline::tool
