#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/sightline/bench/frame_times.h"
#include "tools/sightline/reproduce/bittner.h"
#include "tools/sightline/reproduce/range.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool::bittner {

const std::vector<Published>& publishedTable() {
  static const std::vector<Published> kTable{
      {"soda-5", "F", 0, 18192, 0.0, 276.5},    {"soda-5", "FME", 8, 9466, 3.7, 157.3},
      {"soda-5", "FME", 16, 7390, 5.9, 139.0},  {"soda-5", "FME", 24, 6537, 7.9, 116.0},
      {"soda-5", "FME", 32, 5941, 9.8, 109.8},  {"soda-5", "FME", 50, 5490, 14.2, 109.5},
      {"soda-5", "FSE", 16, 6512, 12.7, 120.5}, {"soda-5", "FSE", 24, 5569, 16.0, 110.5},
      {"soda-5", "FSE", 32, 4725, 19.1, 100.1}, {"soda-5", "FMC", 16, 7988, 5.4, 135.9},
      {"soda-5", "FMC", 24, 7362, 7.3, 129.3},  {"big-7", "F", 0, 12587, 0.0, 182.0},
      {"big-7", "FME", 16, 3641, 8.8, 71.5},    {"big-7", "FME", 24, 2286, 10.2, 54.6},
      {"big-7", "FME", 32, 1818, 11.6, 48.5},   {"big-7", "FSE", 24, 2214, 19.9, 63.4},
      {"big-7", "FMC", 16, 3640, 8.4, 74.3},    {"big-7", "FMC", 24, 2263, 9.7, 51.4},
      {"soda", "F", 0, 15297, 0.0, 315.2},      {"soda", "FME", 24, 4744, 10.1, 119.7},
      {"soda", "FSE", 24, 4388, 23.7, 128.0}};
  return kTable;
}

namespace {

const Published& publishedFrustum(const std::string& scene) {
  return *std::find_if(publishedTable().begin(), publishedTable().end(),
                       [&](const Published& line) { return scene == line.scene && line.occluders == 0; });
}

// Microseconds that the paper's machine took for a triangle: soda-5 with view-frustum culling alone.
double publishedTriangleUs() {
  const Published& line = publishedFrustum("soda-5");
  return 1e3 * line.time_ms / line.polygons;
}

double trianglesOf(const FrameRecord& frame) {
  return static_cast<double>(frame.triangles);
}
double frameMs(const FrameRecord& frame) {
  return frame.frameUs() * 1e-3;
}
double chooseMs(const FrameRecord& frame) {
  return frame.stats.choose_us * 1e-3;
}
double buildMs(const FrameRecord& frame) {
  return frame.stats.build_us * 1e-3;
}
double traverseMs(const FrameRecord& frame) {
  return frame.stats.traverse_us * 1e-3;
}

// The median over the frames, which other load on the machine hardly changes.
template <typename Of>
double medianOf(const WalkRun& run, Of of) {
  std::vector<double> values;
  for (const FrameRecord& frame : run.frames) {
    values.push_back(of(frame));
  }
  return tool::medianOf(std::move(values));
}

double overheadOf(const WalkRun& run) {
  return medianOf(run, chooseMs) + medianOf(run, buildMs) + medianOf(run, traverseMs);
}

double queriesOf(const FrameRecord& frame) {
  return static_cast<double>(frame.stats.nodes_tested) + static_cast<double>(frame.stats.objects_tested);
}
// The time of a frame if drawing took as long for each triangle as on the paper's machine.
double modelledMs(const WalkRun& run) {
  return overheadOf(run) + 1e-3 * publishedTriangleUs() * run.mean(trianglesOf);
}

// Comparisons with planes for one box.
double stepsOf(const Measured& measured, std::size_t one) {
  return measured.trees[one].plane_tests / std::max(1.0, measured.record.runs[one].mean(queriesOf));
}

double percentOf(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

double percentOfFrustum(const Measured& measured, const WalkRun& run) {
  return percentOf(run.mean(trianglesOf), measured.record.baseline().mean(trianglesOf));
}

double speedUp(const Measured& measured, const WalkRun& run) {
  return measured.record.baseline().mean(frameMs) / run.mean(frameMs);
}

double modelledSpeedUp(const Measured& measured, const WalkRun& run) {
  return modelledMs(measured.record.baseline()) / modelledMs(run);
}

// Adds the published figures for the same method and number of occluders.
void addPublished(const Case& one, Json& row) {
  for (const Published& line : publishedTable()) {
    if (one.method == line.method && one.occluders == line.occluders) {
      const Published& frustum = publishedFrustum(line.scene);
      row[fmt::format("{}_percent", line.scene)] = percentOf(line.polygons, frustum.polygons);
      row[fmt::format("{}_speed_up", line.scene)] = frustum.time_ms / line.time_ms;
    }
  }
}

Json caseRow(const Measured& measured, const Case& one) {
  Json row = {{"scene", measured.name}, {"method", one.method}};
  if (one.occluders > 0) {
    row["occluders"] = one.occluders;
  }
  return row;
}

Experiment table2(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "table2",
      "Table 2. Polygons rendered and time of a frame in ms, means of the walk; overhead in ms, medians; "
      "beside "
      "them the paper's",
      "speed-ups of 1.75 to 3.75 over view-frustum culling (F).",
      {{"scene", "scene"},
       {"method", "method"},
       {"occluders", "k", 0},
       {"triangles", "polygons", 0},
       {"percent_of_frustum", "% of F", 1},
       {"choose_ms", "choose", 3},
       {"build_ms", "build", 3},
       {"traverse_ms", "traverse", 3},
       {"overhead_ms", "overhead", 3},
       {"frame_ms", "frame", 2},
       {"speed_up", "speed-up", 2},
       {"modelled_speed_up", fmt::format("at {:.1f} us a polygon", publishedTriangleUs()), 2}}};
  for (const char* scene : kPublishedScenes) {
    experiment.columns.push_back({fmt::format("{}_percent", scene), fmt::format("{} %", scene), 1});
    experiment.columns.push_back({fmt::format("{}_speed_up", scene), "speed-up", 2});
  }
  for (const Measured& measured : scenes) {
    for (std::size_t c = 0; c < measured.cases.size(); ++c) {
      const WalkRun& run = measured.record.runs[c];
      Json row = caseRow(measured, measured.cases[c]);
      row["triangles"] = run.mean(trianglesOf);
      row["percent_of_frustum"] = percentOfFrustum(measured, run);
      row["choose_ms"] = medianOf(run, chooseMs);
      row["build_ms"] = medianOf(run, buildMs);
      row["traverse_ms"] = medianOf(run, traverseMs);
      row["overhead_ms"] = overheadOf(run);
      if (measured.drawn()) {
        row["frame_ms"] = run.mean(frameMs);
        row["speed_up"] = speedUp(measured, run);
      }
      row["modelled_speed_up"] = modelledSpeedUp(measured, run);
      addPublished(measured.cases[c], row);
      experiment.rows.push_back(std::move(row));
    }
  }
  return experiment;
}

Experiment publishedTable2() {
  Experiment experiment{"table2_published",
                        "Table 2 as published: SGI O2, ms",
                        "",
                        {{"scene", "scene"},
                         {"method", "method"},
                         {"occluders", "k", 0},
                         {"triangles", "polygons", 0},
                         {"percent_of_frustum", "% of F", 1},
                         {"overhead_ms", "overhead", 1},
                         {"frame_ms", "frame", 1},
                         {"speed_up", "speed-up", 2}}};
  for (const Published& line : publishedTable()) {
    const Published& frustum = publishedFrustum(line.scene);
    Json row = {
        {"scene", line.scene},        {"method", line.method},
        {"triangles", line.polygons}, {"percent_of_frustum", percentOf(line.polygons, frustum.polygons)},
        {"frame_ms", line.time_ms},   {"speed_up", frustum.time_ms / line.time_ms}};
    if (line.occluders > 0) {
      row["occluders"] = line.occluders;
      row["overhead_ms"] = line.overhead_ms;
    }
    experiment.rows.push_back(std::move(row));
  }
  return experiment;
}

Experiment stepTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "steps",
      "Steps of a query: comparisons with planes of the tree for one box, means of the walk",
      "the number of steps is usually much lower than the number of occluders; skipping nodes that were "
      "partial saves up to half of the tests.",
      {{"scene", "scene"},
       {"method", "method"},
       {"occluders", "k", 0},
       {"occluders_in_tree", "in the tree", 1},
       {"tree_nodes", "tree nodes", 1},
       {"queries", "queries", 1},
       {"skipped_percent", "% skipped", 1},
       {"steps", "steps", 2},
       {"steps_of_occluders", "steps / k", 3}}};
  for (const Measured& measured : scenes) {
    for (std::size_t c = 1; c < measured.cases.size(); ++c) {
      const WalkRun& run = measured.record.runs[c];
      const double skipped = run.mean([](const FrameRecord& frame) { return frame.stats.nodes_skipped; });
      Json row = caseRow(measured, measured.cases[c]);
      row["occluders_in_tree"] = run.mean([](const FrameRecord& frame) { return frame.stats.occluders; });
      row["tree_nodes"] = measured.trees[c].nodes;
      row["queries"] = run.mean(queriesOf);
      row["skipped_percent"] = percentOf(skipped, skipped + run.mean(queriesOf));
      row["steps"] = stepsOf(measured, c);
      row["steps_of_occluders"] = stepsOf(measured, c) / measured.cases[c].occluders;
      experiment.rows.push_back(std::move(row));
    }
  }
  return experiment;
}

Experiment parameterTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "parameters",
      fmt::format("One parameter of the paper at a time replaced by the library's, {} with {} "
                  "occluders",
                  kPlotted, kPlottedOccluders),
      "",
      {{"scene", "scene"},
       {"changed", "changed"},
       {"triangles", "polygons", 0},
       {"percent_of_frustum", "% of F", 1},
       {"overhead_ms", "overhead", 3}}};
  const std::vector<Case> cases = parameterCases();
  for (const Measured& measured : scenes) {
    for (std::size_t c = 0; c < cases.size(); ++c) {
      const WalkRun& run = measured.parameter_runs[c];
      experiment.rows.push_back({{"scene", measured.name},
                                 {"changed", cases[c].method},
                                 {"triangles", run.mean(trianglesOf)},
                                 {"percent_of_frustum", percentOfFrustum(measured, run)},
                                 {"overhead_ms", overheadOf(run)}});
    }
  }
  return experiment;
}

// The share of frames in which the run's value is below that of the baseline.
template <typename Of>
double percentBelow(const WalkRun& run, const WalkRun& baseline, Of of) {
  double below = 0.0;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    below += of(run.frames[i]) < of(baseline.frames[i]) ? 1.0 : 0.0;
  }
  return percentOf(below, static_cast<double>(run.frames.size()));
}

template <typename Of>
void addCurve(const Measured& measured, const char* figure, const char* unit, Of of, Experiment& experiment) {
  const WalkRun& baseline = measured.record.baseline();
  for (const WalkRun* run : {&baseline, measured.runOf(kPlotted, kPlottedOccluders)}) {
    const auto less = [&](const FrameRecord& a, const FrameRecord& b) { return of(a) < of(b); };
    const auto [low, high] = std::minmax_element(run->frames.begin(), run->frames.end(), less);
    Json row = {{"scene", measured.name}, {"figure", figure},
                {"unit", unit},           {"curve", run == &baseline ? "A" : "B"},
                {"mean", run->mean(of)},  {"min", of(*low)},
                {"max", of(*high)}};
    if (run != &baseline) {
      row["below_percent"] = percentBelow(*run, baseline, of);
    }
    experiment.rows.push_back(std::move(row));
  }
}

Experiment curveTable(const std::vector<Measured>& scenes) {
  Experiment experiment{
      "curves",
      fmt::format(
          "Figures 9 and 10. The walk frame by frame: view-frustum culling (A) and {} with {} occluders "
          "(B)",
          kPlotted, kPlottedOccluders),
      "B is below A in both figures.",
      {{"scene", "scene"},
       {"figure", "figure"},
       {"curve", "curve"},
       {"unit", "unit"},
       {"mean", "mean", 2},
       {"min", "min", 2},
       {"max", "max", 2},
       {"below_percent", "% of frames below A", 1}}};
  for (const Measured& measured : scenes) {
    if (measured.drawn()) {
      addCurve(measured, "9", "ms", frameMs, experiment);
    }
    addCurve(measured, "10", "polygons", trianglesOf, experiment);
  }
  return experiment;
}

// Calls add(scene, index of the case) for the paper's variants.
template <typename Add>
void forVariants(const std::vector<Measured>& scenes, Add&& add) {
  for (const Measured& measured : scenes) {
    for (std::size_t c = 1; c < measured.cases.size(); ++c) {
      if (measured.cases[c].method != kOwn) {
        add(measured, c);
      }
    }
  }
}

// How a quotient of two runs of each scene ranges.
template <typename Of>
Range ratios(const std::vector<Measured>& scenes, const std::pair<const char*, std::uint32_t>& above,
             const std::pair<const char*, std::uint32_t>& below, Of of) {
  Range range;
  for (const Measured& measured : scenes) {
    range.add(of(*measured.runOf(above.first, above.second)) /
              of(*measured.runOf(below.first, below.second)));
  }
  return range;
}

double meanTriangles(const WalkRun& run) {
  return run.mean(trianglesOf);
}

Finding speedUpFinding(const std::vector<Measured>& scenes) {
  Range drawn, modelled;
  forVariants(scenes, [&](const Measured& measured, std::size_t c) {
    const WalkRun& run = measured.record.runs[c];
    if (measured.drawn()) {
      drawn.add(speedUp(measured, run));
    }
    modelled.add(modelledSpeedUp(measured, run));
  });
  constexpr double kLow = 1.75, kHigh = 3.75;
  const bool any_drawn = drawn.low <= drawn.high;
  const Range& judged = any_drawn ? drawn : modelled;
  return {"speed-ups of 1.75 to 3.75", judged.low <= kHigh && judged.high >= kLow,
          (any_drawn
               ? fmt::format("{} as drawn here, where a software renderer spends much of a frame on pixels, "
                             "which culling leaves the same; ",
                             drawn.text(2))
               : "") +
              fmt::format("{} if each polygon took the {:.1f} us of the paper's machine", modelled.text(2),
                          publishedTriangleUs())};
}

Finding sublinearFinding(const std::vector<Measured>& scenes) {
  const Range gain = ratios(scenes, {"FME", 16}, {"FME", 32}, modelledMs);
  return {
      "twice as many occluders raise the speed-up much less than twice", gain.high < 1.6,
      fmt::format("from 16 to 32 occluders the frame of a renderer bound by polygons gets {} times as fast, "
                  "because the largest occluders come first",
                  gain.text(2))};
}

Finding overheadFinding(const std::vector<Measured>& scenes) {
  const Range growth = ratios(scenes, {"FME", 32}, {"FME", 16}, overheadOf);
  return {
      "twice as many occluders raise the overhead less than twice", growth.high < 2.0,
      fmt::format("{} times from 16 to 32 occluders, because occluders behind others add no nodes, and fewer "
                  "boxes stay partial",
                  growth.text(2))};
}

// Steps of the modified tree for each occluder.
Range stepShare(const std::vector<Measured>& scenes, std::uint32_t occluders) {
  Range share;
  forVariants(scenes, [&](const Measured& measured, std::size_t c) {
    const Case& one = measured.cases[c];
    if (one.occluders == occluders && (one.method == "FME" || one.method == "FMC")) {
      share.add(stepsOf(measured, c) / occluders);
    }
  });
  return share;
}

Finding stepFinding(const std::vector<Measured>& scenes) {
  const Range few = stepShare(scenes, 8), many = stepShare(scenes, 50);
  return {
      "a query takes far fewer steps than there are occluders", many.high < 0.5,
      fmt::format("in the modified tree {} steps for each of 50 occluders, {} for each of 8: the frustum's "
                  "planes and the edges of the nearest occluders are always asked, and a path through the "
                  "tree passes few of the others",
                  many.text(2), few.text(2))};
}

Finding splittingFinding(const std::vector<Measured>& scenes) {
  const Range cost = ratios(scenes, {"FSE", 24}, {"FME", 24}, overheadOf);
  return {
      "splitting faces (FSE) costs about twice the overhead of comparing boxes with planes (FME): 1.95 to "
      "2.35 times with 24 occluders",
      cost.low > 1.2, fmt::format("{} times, because fragments have to be made and kept", cost.text(2))};
}

Finding tightnessFinding(const std::vector<Measured>& scenes) {
  const Range less = ratios(scenes, {"FME", 24}, {"FSE", 24}, meanTriangles);
  return {
      "FSE renders fewer polygons than FME: 3 to 15 % with 24 occluders", less.high > 1.02,
      fmt::format("FME renders {} times as many as FSE. The library cuts a box's image where a leaf would "
                  "change the answer, so that comparing with planes misses no hidden box (figure 8)",
                  less.text(3))};
}

Finding leafTestFinding(const std::vector<Measured>& scenes) {
  const Range more = ratios(scenes, {"FMC", 24}, {"FME", 24}, meanTriangles);
  return {"without the exact test in leaves (FMC) up to 13 % more polygons are rendered", more.high >= 1.0,
          fmt::format(
              "{} times as many as with it. The test hides more of a frame in any case; but occluders are "
              "looked for among what the last frame kept, so that in the long run it may also keep more",
              more.text(3))};
}

// The one parameter whose change leaves the fewest polygons: "demo:city: no limit of distance, 19.3 %".
std::string decisiveParameter(const Measured& measured) {
  const std::vector<Case> cases = parameterCases();
  std::size_t best = 1;
  for (std::size_t c = 2; c + 1 < cases.size(); ++c) {
    if (measured.parameter_runs[c].mean(trianglesOf) < measured.parameter_runs[best].mean(trianglesOf)) {
      best = c;
    }
  }
  return fmt::format("{}: {}, {:.1f} %", measured.name, cases[best].method,
                     percentOfFrustum(measured, measured.parameter_runs[best]));
}

Finding shareFinding(const std::vector<Measured>& scenes) {
  Range paper, own;
  std::string decisive;
  for (const Measured& measured : scenes) {
    paper.add(percentOfFrustum(measured, measured.parameter_runs.front()));
    own.add(percentOfFrustum(measured, measured.parameter_runs.back()));
    decisive += (decisive.empty() ? "" : "; ") + decisiveParameter(measured);
  }
  return {"with 32 occluders 14 to 33 % of the polygons in the frustum are rendered",
          paper.low <= 33.0 && paper.high >= 14.0,
          fmt::format("{} % with the paper's parameters, {} % with the library's. The one parameter that "
                      "matters most is, "
                      "in {}",
                      paper.text(1), own.text(1), decisive)};
}

}  // namespace

std::vector<Experiment> tablesOf(const std::vector<Measured>& scenes) {
  return {table2(scenes), publishedTable2(), parameterTable(scenes), stepTable(scenes), curveTable(scenes)};
}

namespace {

// Figures 9 and 10: curve A is view-frustum culling, B the paper's method.
Finding curvesFinding(const std::vector<Measured>& scenes) {
  Finding finding{
      "figures 9 and 10: frames take less time, and render fewer polygons, with occlusion culling", true, ""};
  for (const Measured& measured : scenes) {
    if (const WalkRun* run = measured.runOf(kPlotted, kPlottedOccluders)) {
      const WalkRun& baseline = measured.record.baseline();
      const double polygons = percentBelow(*run, baseline, trianglesOf);
      finding.agrees = finding.agrees && polygons > 50.0 && run->mean(frameMs) <= baseline.mean(frameMs);
      finding.text += fmt::format("{}in {:.0f} % of the frames fewer polygons, in {:.0f} % less time in {}",
                                  finding.text.empty() ? "" : "; ", polygons,
                                  percentBelow(*run, baseline, frameMs), measured.name);
    }
  }
  finding.text += ". The others show next to nothing that could be hidden, and culling takes its time anyway";
  return finding;
}

}  // namespace

std::vector<Finding> findingsOf(const std::vector<Measured>& scenes) {
  return {speedUpFinding(scenes),   shareFinding(scenes),    sublinearFinding(scenes),
          overheadFinding(scenes),  stepFinding(scenes),     splittingFinding(scenes),
          tightnessFinding(scenes), leafTestFinding(scenes), curvesFinding(scenes)};
}

}  // namespace sightline::tool::bittner
