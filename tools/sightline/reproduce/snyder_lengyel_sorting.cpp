// Snyder and Lengyel 1997, section 12.1: figures 18 to 21 and the statistics of components.
//
// Figures 18, 20 and 21 are of the paper's algorithm, the incremental sort with candidates from the kd-tree,
// and of the library's own, the depth-first sort with candidates from the scan. As in the paper, means count
// the construction of the tree in the first frame, and largest times do not: those are of the frames after
// it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>

#include "sightline/comparison/layer_sorting.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/progress_bar.h"
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

// Times are the least of so many runs, frame by frame: what other programs take is in few of them. A short
// reproduction has one.
constexpr int kRuns = 3;

LayerSettings papersSorting(const ExtentTreeSettings& tree = {}) {
  return {.sort = incrementalSort(), .search = extentTree(tree)};
}

// By how much more is larger than less, in percent.
double percentMore(double more, double less) {
  return less > 0.0 ? 100.0 * (more / less - 1.0) : 0.0;
}

Plot growthPlot(const std::string& title, const char* doublings_of) {
  return {.title = title,
          .x_label = fmt::format("doublings of {} toothpicks", doublings_of),
          .y_label = "us; the paper's: ms",
          .log_y = true};
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
  LayerTotals sortTimed(const MovingScene& scene, const LayerSettings& settings) {
    LayerTotals totals = sortFrames(scene, settings, options_);
    for (int run = 1; run < (options_.fewer_frames ? 1 : kRuns); ++run) {
      totals.keepFaster(sortFrames(scene, settings, options_));
    }
    return totals;
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
      const LayerTotals totals = sortFrames(makeToothpicks(toothpicks(paper.at, i == 1)), {}, options_);
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
    Experiment table{
        "growth",
        "Figure 18: time of a frame by the number of toothpicks, us (paper: ms). Incremental: the "
        "paper's sort with its kd-tree",
        "about linear at the same density (ud); faster at the same size (us), where groups grow",
        {{"n", "toothpicks", 0}}};
    for (const char* scaling : {"ud", "us"}) {
      for (const auto& [key, head] : {std::pair("ivs", "incremental mean"),
                                      {"ivs_max", "max"},
                                      {"paper_mean", "paper mean"},
                                      {"paper_max", "max"},
                                      {"mean", "depth-first mean"},
                                      {"max", "max"}}) {
        table.columns.push_back({fmt::format("{}_{}", scaling, key), fmt::format("{} {}", scaling, head),
                                 std::string(key).starts_with("paper") ? 2 : 1});
      }
    }
    Plot papers =
        growthPlot("Figure 18: the incremental sort with the kd-tree, beside the paper's times", "25");
    Plot own = growthPlot("Figure 18: the same frames sorted depth-first, candidates from the scan", "25");
    own.y_label = "us";
    for (const char* scaling : {"ud", "us"}) {
      for (const char* of : {"mean", "max"}) {
        papers.series.push_back({fmt::format("{} {}", scaling, of)});
        own.series.push_back({fmt::format("{} {}", scaling, of)});
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      papers.series.push_back({papers.series[i].name + ", paper"});
    }
    ProgressBar progress("growth");
    for (std::size_t i = 0; i < kGrowth.size(); ++i) {
      const PaperRow& paper = kGrowth[i];
      Json row{{"n", paper.at}};
      for (const bool density : {true, false}) {
        const std::string scaling = density ? "ud" : "us";
        const std::size_t column = density ? 0 : 2;
        const MovingScene scene = makeToothpicks(toothpicks(paper.at, density));
        const LayerTotals incremental = sortTimed(scene, papersSorting());
        const LayerTotals depth_first = sortTimed(scene, {});
        const auto add = [&](const std::string& key, double value, PlotSeries& series) {
          row[scaling + key] = value;
          series.values.push_back(value);
        };
        add("_ivs", incremental.mean(&Frame::sort_us), papers.series[column]);
        add("_ivs_max", incremental.largestAfterFirst(&Frame::sort_us), papers.series[column + 1]);
        add("_paper_mean", paper.values[column], papers.series[column + 4]);
        add("_paper_max", paper.values[column + 1], papers.series[column + 5]);
        add("_mean", depth_first.mean(&Frame::sort_us), own.series[column]);
        add("_max", depth_first.largestAfterFirst(&Frame::sort_us), own.series[column + 1]);
      }
      table.rows.push_back(std::move(row));
      progress.update(static_cast<double>(i + 1) / kGrowth.size());
    }
    plots_.push_back(std::move(papers));
    plots_.push_back(std::move(own));
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
    Plot plot = growthPlot("Figure 19: time to build the kd-tree, beside the paper's", "25");
    plot.series = {{"ud"}, {"us"}, {"ud, paper"}, {"us, paper"}};
    for (const PaperRow& paper : kBuilds) {
      const double ud = buildTime(toothpicks(paper.at, true)), us = buildTime(toothpicks(paper.at, false));
      table.rows.push_back({{"n", paper.at},
                            {"ud", ud},
                            {"paper_ud", paper.values[0]},
                            {"us", us},
                            {"paper_us", paper.values[1]}});
      plot.series[0].values.push_back(ud);
      plot.series[1].values.push_back(us);
      plot.series[2].values.push_back(paper.values[0]);
      plot.series[3].values.push_back(paper.values[1]);
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
    pose(scene, 0, poses, sorter);
    sorter.update(scene.scene.paths.front().view(0, scene.scene.origin));
    double fastest = 1e300;
    for (int i = 0; i < 5; ++i) {
      base::Stopwatch watch;
      sorter.rebuildSearch();
      fastest = std::min(fastest, watch.lap());
    }
    return fastest;
  }

  Experiment velocities() {
    Experiment table{
        "velocities",
        "Figure 20: time of a frame by velocity, 200 toothpicks, us (paper: ms). Incremental: the "
        "paper's sort with its kd-tree",
        "slow growth as coherence is lost; the largest time is 17 to 30 % above the mean",
        {{"velocity", "velocity", 3},
         {"incremental", "incremental mean", 1},
         {"incremental_max", "max", 1},
         {"incremental_more", "diff %", 1},
         {"paper_mean", "paper mean", 2},
         {"paper_max", "max", 1},
         {"paper_more", "diff %", 1},
         {"reinsertions", "reinsertions", 1},
         {"mean", "depth-first mean", 1},
         {"max", "max", 1},
         {"more", "diff %", 1},
         {"pairs", "exact pairs", 1}}};
    Plot times{.title = "Figure 20: time of a frame by velocity, 200 toothpicks",
               .x_label = "place in the table: velocities of",
               .y_label = "us; the paper's: ms",
               .series = {{"incremental mean"},
                          {"incremental max"},
                          {"paper mean"},
                          {"paper max"},
                          {"depth-first mean"},
                          {"depth-first max"}},
               .log_y = true};
    Plot differences{.title = "Figure 20: by how much the largest time of a frame exceeds the mean",
                     .y_label = "%",
                     .series = {{"incremental"}, {"paper"}, {"depth-first"}}};
    ProgressBar progress("velocities");
    for (std::size_t i = 0; i < kVelocities.size(); ++i) {
      const PaperRow& paper = kVelocities[i];
      const MovingScene scene = makeToothpicks(toothpicks(200, false, paper.at));
      const LayerTotals incremental = sortTimed(scene, papersSorting());
      const LayerTotals depth_first = sortTimed(scene, {});
      Json row{{"velocity", paper.at},
               {"reinsertions", incremental.mean(&Frame::reinsertions)},
               {"pairs", depth_first.mean(&Frame::pair_queries)}};
      const auto add = [&](const std::string& prefix, double mean, double max, std::size_t series) {
        const bool own = prefix.empty();
        const double more = percentMore(max, mean);
        row[own ? "mean" : prefix == "paper" ? "paper_mean" : prefix] = mean;
        row[own ? "max" : prefix + "_max"] = max;
        row[own ? "more" : prefix + "_more"] = more;
        times.series[2 * series].values.push_back(mean);
        times.series[2 * series + 1].values.push_back(max);
        differences.series[series].values.push_back(more);
      };
      add("incremental", incremental.mean(&Frame::sort_us), incremental.largestAfterFirst(&Frame::sort_us),
          0);
      add("paper", paper.values[0], paper.values[1], 1);
      add("", depth_first.mean(&Frame::sort_us), depth_first.largestAfterFirst(&Frame::sort_us), 2);
      table.rows.push_back(std::move(row));
      times.x_label += fmt::format("{} {}", i == 0 ? "" : ",", paper.at);
      progress.update(static_cast<double>(i + 1) / kVelocities.size());
    }
    differences.x_label = times.x_label;
    plots_.push_back(std::move(times));
    plots_.push_back(std::move(differences));
    return table;
  }

  // With k = 1 the tree divides along the camera's depth alone; extents are still tested along all three.
  Experiment directions() {
    Experiment table{
        "directions",
        "Figure 21: time of a frame of the incremental sort with a kd-tree over three directions "
        "and over depth alone, us (paper: ms)",
        "three are much better, the more so the more toothpicks there are",
        {{"n", "toothpicks", 0}}};
    for (const char* scaling : {"ud", "us"}) {
      for (const auto& [key, head, decimals] : {std::tuple("k3", "k = 3", 1),
                                                {"k1", "k = 1", 1},
                                                {"more", "diff %", 1},
                                                {"paper_k3", "paper k = 3", 2},
                                                {"paper_k1", "k = 1", 2},
                                                {"paper_more", "diff %", 1}}) {
        table.columns.push_back(
            {fmt::format("{}_{}", scaling, key), fmt::format("{} {}", scaling, head), decimals});
      }
    }
    Plot plot =
        growthPlot("Figure 21: time of a frame by the kd-tree's directions, beside the paper's", "50");
    for (const char* whose : {"", ", paper"}) {
      for (const char* of : {"ud k = 3", "ud k = 1", "us k = 3", "us k = 1"}) {
        plot.series.push_back({std::string(of) + whose});
      }
    }
    const LayerSettings three = papersSorting(), one = papersSorting({.tree_axes = 1u << 2});
    ProgressBar progress("directions");
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
      const PaperRow& paper = kDirections[i];
      Json row{{"n", paper.at}};
      for (const bool density : {true, false}) {
        const std::string scaling = density ? "ud" : "us";
        const std::size_t column = density ? 0 : 2;
        const MovingScene scene = makeToothpicks(toothpicks(paper.at, density));
        const double k3 = sortTimed(scene, three).mean(&Frame::sort_us);
        const double k1 = sortTimed(scene, one).mean(&Frame::sort_us);
        const double paper_k3 = paper.values[column], paper_k1 = paper.values[column + 1];
        row[scaling + "_k3"] = k3;
        row[scaling + "_k1"] = k1;
        row[scaling + "_more"] = percentMore(k1, k3);
        row[scaling + "_paper_k3"] = paper_k3;
        row[scaling + "_paper_k1"] = paper_k1;
        row[scaling + "_paper_more"] = percentMore(paper_k1, paper_k3);
        plot.series[column].values.push_back(k3);
        plot.series[column + 1].values.push_back(k1);
        plot.series[column + 4].values.push_back(paper_k3);
        plot.series[column + 5].values.push_back(paper_k1);
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
