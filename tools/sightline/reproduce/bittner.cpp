// The experiments of Bittner, Havran and Slavik 1998, section 7: table 2, figures 9 and 10, and the pictures
// of figures 1, 2 and 5 to 8.
//
// Differs from the paper in: scenes, machine and renderer are those of today. Occluders are found in all
// triangles, ranked with the view that uses them. The conservative variants cut a box's image where a leaf
// would change the answer (see docs/algorithms/occlusion-tree.md).

#include "tools/sightline/reproduce/bittner.h"

#include <fmt/format.h>

#include <utility>

#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/reproduce/renderer_or_note.h"
#include "tools/sightline/walk/walk_report.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {

using namespace bittner;

namespace bittner {
namespace {

constexpr std::uint32_t kCounts[] = {8, 16, 24, 32, 50};
constexpr std::uint32_t kMinNodeCost = 50;
constexpr double kLambdaSteps = 100.0;
constexpr std::pair<const char*, OcclusionTreeVariant> kVariants[] = {{"FME", OcclusionTreeVariant::kFME},
                                                                      {"FSE", OcclusionTreeVariant::kFSE},
                                                                      {"FMC", OcclusionTreeVariant::kFMC},
                                                                      {"FSC", OcclusionTreeVariant::kFSC}};

// Hierarchical culling by the frustum in the paper's kd-tree.
Setting frustumSetting() {
  Setting setting;
  setting.hierarchy = HierarchyKind::kKdTree;
  setting.method = &methodNamed("frustum");
  return setting;
}

// The paper's parameters.
Setting treeSetting(OcclusionTreeVariant variant, std::uint32_t occluders) {
  Setting setting;
  setting.hierarchy = HierarchyKind::kKdTree;
  setting.method = &methodNamed("occlusion-tree");
  setting.variant = variant;
  setting.culler.occluders = {
      .count = occluders, .area_angle_direction = AreaAngleDirection::kView, .lambda_steps = kLambdaSteps};
  setting.culler.min_node_cost = kMinNodeCost;
  setting.culler.test_objects = false;
  return setting;
}

// What the library does unless it is told otherwise.
Setting ownSetting(std::uint32_t occluders) {
  Setting setting;
  setting.method = &methodNamed("occlusion-tree");
  setting.culler.occluders.count = occluders;
  return setting;
}

}  // namespace

std::vector<Case> allCases() {
  std::vector<Case> cases{{"F", 0, frustumSetting()}};
  for (const auto& [name, variant] : kVariants) {
    for (const std::uint32_t count : kCounts) {
      cases.push_back({name, count, treeSetting(variant, count)});
    }
  }
  for (const std::uint32_t count : kCounts) {
    cases.push_back({kOwn, count, ownSetting(count)});
  }
  return cases;
}

std::vector<Case> parameterCases() {
  const Setting paper = treeSetting(OcclusionTreeVariant::kFME, kPlottedOccluders);
  const auto changed = [&](const char* what, auto change) {
    Case one{what, kPlottedOccluders, paper};
    change(one.setting);
    return one;
  };
  return {
      {"none: the paper's", kPlottedOccluders, paper},
      changed("no limit of distance", [](Setting& s) { s.culler.occluders.lambda_steps = 0.0; }),
      changed("V towards the occluder",
              [](Setting& s) { s.culler.occluders.area_angle_direction = AreaAngleDirection::kOccluder; }),
      changed("objects tested", [](Setting& s) { s.culler.test_objects = true; }),
      changed("minimum cost 0", [](Setting& s) { s.culler.min_node_cost = 0; }),
      changed("bounding-volume hierarchy", [](Setting& s) { s.hierarchy = HierarchyKind::kBvh; }),
      {"all: the library's", kPlottedOccluders, ownSetting(kPlottedOccluders)}};
}

const WalkRun* Measured::runOf(const std::string& method, std::uint32_t occluders) const {
  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (cases[c].method == method && cases[c].occluders == occluders) {
      return &record.runs[c];
    }
  }
  return nullptr;
}

}  // namespace bittner

namespace {

// Adds the work of the frame that was culled last to the means of all frames.
void addTreeWork(Measured& measured) {
  const auto frames = static_cast<double>(measured.input.walk.frames.size());
  for (std::size_t c = 0; c < measured.cases.size(); ++c) {
    const Culler& culler = measured.record.runs[c].run.culler;
    measured.trees[c].nodes += static_cast<double>(culler.statistic("tree", "nodes")) / frames;
    measured.trees[c].plane_tests += static_cast<double>(culler.statistic("tree", "plane_tests")) / frames;
  }
}

std::vector<Setting> settingsOf(const std::vector<Case>& cases) {
  std::vector<Setting> settings;
  for (const Case& one : cases) {
    settings.push_back(one.setting);
  }
  return settings;
}

// Without a renderer (null) nothing is drawn.
void walkThrough(Measured& measured, Renderer* renderer) {
  const Walk& walk = measured.input.walk;
  measured.record.runs = makeRuns(settingsOf(measured.cases), measured.data);
  measured.parameter_runs = makeRuns(settingsOf(parameterCases()), measured.data);
  measured.record.device = renderer != nullptr ? renderer->device() : "";
  measured.trees.resize(measured.cases.size());
  ProgressBar progress("walking");
  for (std::size_t i = 0; i < walk.frames.size(); ++i) {
    const View view = walk.view(walk.frames[i], measured.input.scene);
    cullFrame(measured.record.runs, measured.data, walk.frames[i], view);
    addTreeWork(measured);
    cullFrame(measured.parameter_runs, measured.data, walk.frames[i], view);
    if (renderer != nullptr) {
      drawFrame(measured.record.runs, view, *renderer, nullptr);
    }
    progress.update(static_cast<double>(i + 1) / static_cast<double>(walk.frames.size()));
  }
}

template <typename Of>
Plot plotOf(const Measured& measured, const std::string& title, const std::string& y_label, Of of) {
  const std::vector<std::uint32_t>& frames = measured.input.walk.frames;
  Plot plot{.title = title};
  plot.y_label = y_label;
  plot.first_x = frames.front();
  plot.step_x = frames.size() > 1 ? frames[1] - frames[0] : 1.0;
  const std::pair<std::string, const WalkRun*> curves[] = {
      {"A: view-frustum culling", &measured.record.baseline()},
      {fmt::format("B: {}, {} occluders", kPlotted, kPlottedOccluders),
       measured.runOf(kPlotted, kPlottedOccluders)}};
  for (const auto& [name, run] : curves) {
    PlotSeries series{name};
    for (const FrameRecord& frame : run->frames) {
      series.values.push_back(of(frame));
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// Figures 9 and 10.
std::vector<Plot> framePlots(const Measured& measured) {
  std::vector<Plot> plots;
  if (measured.drawn()) {
    plots.push_back(plotOf(measured, "Figure 9: time of a frame", "ms",
                           [](const FrameRecord& frame) { return frame.frameUs() * 1e-3; }));
  }
  plots.push_back(plotOf(measured, "Figure 10: polygons rendered", "triangles",
                         [](const FrameRecord& frame) { return static_cast<double>(frame.triangles); }));
  return plots;
}

// The frames of both curves as a table.
std::string framesCsv(const Measured& measured) {
  std::string text = "frame,frustum_polygons,polygons,frustum_ms,ms\n";
  const WalkRun &a = measured.record.baseline(), &b = *measured.runOf(kPlotted, kPlottedOccluders);
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    text += fmt::format("{},{},{},{:.4f},{:.4f}\n", a.frames[i].frame, a.frames[i].triangles,
                        b.frames[i].triangles, a.frames[i].frameUs() * 1e-3, b.frames[i].frameUs() * 1e-3);
  }
  return text;
}

Report reportOf(const Measured& measured, const ReproduceOptions& options) {
  Report report;
  report.title = "Bittner, Havran and Slavik 1998: " + measured.name;
  report.summary = "Occlusion trees with the paper's parameters against hierarchical view-frustum culling.";
  report.command = options.command_line;
  report.drawn = measured.drawn();
  report.facts = walkFacts(
      {measured.name, measured.input.scene, measured.input.walk, measured.data, measured.input.closing},
      measured.record);
  report.plots = framePlots(measured);
  for (std::size_t c = 0; c < measured.cases.size(); ++c) {
    ReportRow& row = report.rows.emplace_back(rowOf(measured.record.runs[c], measured.record));
    row.method = measured.cases[c].method;
    row.options = c == 0 ? "" : fmt::format("{} occluders", measured.cases[c].occluders);
    row.frames_differing.reset();  // pictures were timed, not compared
  }
  return report;
}

// Puts the figures into the report of this index.
void addFigures(Figures figures, std::size_t report, Reproduction& result) {
  for (ReportPicture& picture : figures.pictures) {
    result.reports[report].pictures.push_back(std::move(picture));
  }
  for (ReportFile& file : figures.files) {
    file.report = report;
    result.files.push_back(std::move(file));
  }
}

void addReport(Measured& measured, const ReproduceOptions& options, Reproduction& result) {
  const std::size_t index = result.reports.size();
  result.reports.push_back(reportOf(measured, options));
  addFigures(traversalFigures(measured), index, result);
  result.files.push_back({.name = "frames.csv", .text = framesCsv(measured), .report = index});
  for (const Plot& plot : result.reports[index].plots) {
    const std::string name = plot.title.substr(0, plot.title.find(':'));  // "Figure 9"
    result.files.push_back({.name = "figure-" + name.substr(name.rfind(' ') + 1) + ".svg",
                            .text = toSvg(plot),
                            .report = index});
  }
}

// Small pictures for few frames, unless the user names a size.
PictureOptions pictureOf(const ReproduceOptions& options, const CameraPath& path) {
  constexpr PictureOptions kSmall{480, 270};
  const bool small = options.fewer_frames && options.picture.width == 0 && options.picture.height == 0;
  return pictureSize(small ? kSmall : options.picture, path);
}

}  // namespace

Result<Reproduction> reproduceBittner(const ReproduceOptions& options,
                                      const std::vector<SceneAndWalk>& inputs) {
  const Threads threads(options.threads);
  Reproduction result;
  std::vector<Measured> scenes;
  scenes.reserve(inputs.size());  // cullers hold on to their scene's data
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const SceneAndWalk& input = inputs[i];
    Measured& measured = scenes.emplace_back(Measured{
        options.scenes[i], input, CullingData(input.scene, threads.parallelFor(), input.walk), allCases()});
    const PictureOptions size = pictureOf(options, input.walk.path);
    std::optional<Renderer> renderer = rendererOrNote(input.scene.view(), size, measured.name, result.notes);
    measured.record.width = size.width;
    measured.record.height = size.height;
    walkThrough(measured, renderer ? &*renderer : nullptr);
  }
  result.experiments = tablesOf(scenes);
  result.findings = findingsOf(scenes);
  for (Measured& measured : scenes) {
    addReport(measured, options, result);
  }
  if (!result.reports.empty()) {
    addFigures(treeFigures(), 0, result);
  }
  return result;
}

}  // namespace sightline::tool
