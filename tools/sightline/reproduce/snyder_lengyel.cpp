// The experiments and pictures of Snyder and Lengyel 1997, section 12: figures 16 to 23, the statistics of
// components, and the canyon's tables with the results of saved rendering.
//
// Differs from the paper in: the machine and, where the text does not describe it, the scene. The published
// times, in ms on one 300 MHz Pentium II, stand beside ours in us.

#include "tools/sightline/reproduce/snyder_lengyel.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "src/base/stopwatch.h"
#include "tools/sightline/reproduce/layer_figures.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/reproduce/saved_rendering.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kShortSortFrames = 25;

template <typename T>
void append(std::vector<T>& to, std::vector<T> items) {
  to.insert(to.end(), std::make_move_iterator(items.begin()), std::make_move_iterator(items.end()));
}

void add(LayerFigures figures, Reproduction& result, Report& report) {
  append(result.experiments, std::move(figures.experiments));
  append(result.findings, std::move(figures.findings));
  append(result.files, std::move(figures.files));
  append(report.pictures, std::move(figures.pictures));
}

}  // namespace

LayerTotals sortFrames(
    const MovingScene& scene, const LayerSettings& settings, const ReproduceOptions& options,
    const std::function<void(std::uint32_t frame, const LayerOrder& order, const View& view)>& visit) {
  LayerSorter sorter = makeSorter(scene, settings);
  LayerTotals totals;
  std::vector<Mat4> poses;
  const std::uint32_t frames = options.fewer_frames ? std::min(kShortSortFrames, scene.frames) : scene.frames;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const View view = scene.scene.paths.front().view(frame, scene.scene.origin);
    pose(scene, frame, poses, sorter);
    base::Stopwatch watch;
    const LayerOrder& order = sorter.update(view);
    totals.add(order, 0.0, 0.0, watch.lap());
    if (visit) {
      visit(frame, order, view);
    }
  }
  return totals;
}

Result<Reproduction> reproduceSnyderLengyel(const ReproduceOptions& options,
                                            const std::vector<SceneAndWalk>&) {
  Reproduction result;
  Report report;
  report.title = "Snyder and Lengyel 1997";
  report.summary =
      "Visibility sorting without splitting, and what it is for: tumbling toothpicks and the canyon.";
  report.command = options.command_line;
  SortingTables sorting = sortingTables(options);
  result.experiments = std::move(sorting.experiments);
  report.plots = std::move(sorting.plots);
  result.experiments.push_back(canyonTable(options));
  result.experiments.push_back(inflationTable());
  Result<std::vector<Experiment>> saved = savedRendering(savedRenderingOptions(options));
  if (saved) {
    append(result.experiments, std::move(*saved));
  } else {
    result.notes.push_back("Saved rendering was not measured: " + saved.error().message);
  }
  const LayerFigureOptions figures = layerFigureOptions(options);
  add(hiddenLineFigure(figures), result, report);
  Result<LayerFigures> pictures = layerFigures(figures);
  if (pictures) {
    add(std::move(*pictures), result, report);
  } else {
    result.notes.push_back("Figures 16, 22 and 23 were not drawn: " + pictures.error().message);
  }
  append(result.findings, snyderLengyelFindings(result.experiments));
  report.notes = result.notes;
  result.reports.push_back(std::move(report));
  return result;
}

}  // namespace sightline::tool
