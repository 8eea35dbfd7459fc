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
#include "tools/sightline/reproduce/coorg_teller.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/reproduce/renderer_or_note.h"
#include "tools/sightline/walk/walk_pictures.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {
namespace {

using namespace coorg_teller;

constexpr std::uint32_t kStretchFrames = 800, kFewerStretchFrames = 160;

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

std::size_t nodesInFrustum(const Hierarchy& hierarchy, const View& view) {
  const Frustum frustum = frustumOf(view);
  return static_cast<std::size_t>(
      std::count_if(hierarchy.nodes.begin(), hierarchy.nodes.end(), [&](const HierarchyNode& node) {
        std::uint8_t planes = kAllFrustumPlanes;
        return classify(frustum, node.bounds, planes) != FrustumSide::kOutside;
      }));
}

// Without a renderer (null) nothing is drawn.
void walkThrough(SceneTimes& measured, Renderer* renderer) {
  const Walk& walk = measured.input.walk;
  const Hierarchy& kd_tree = measured.data.hierarchy(HierarchyKind::kKdTree);
  measured.record.runs = makeRuns(allSettings(), measured.data);
  measured.record.device = renderer != nullptr ? renderer->device() : "";
  measured.record.shown = kKeptPlanes;
  PictureChooser chooser(walk.frames);
  ProgressBar progress("walking");
  for (std::size_t i = 0; i < walk.frames.size(); ++i) {
    const View view = walk.view(walk.frames[i], measured.input.scene);
    cullFrame(measured.record.runs, measured.data, walk.frames[i], view);
    if (renderer != nullptr) {
      drawFrame(measured.record.runs, view, *renderer, nullptr);
      chooser.offer(keptFrame(measured.record, measured.data, walk.frames[i], view));
    }
    measured.nodes_in_frustum += static_cast<double>(nodesInFrustum(kd_tree, view));
    progress.update(static_cast<double>(i + 1) / static_cast<double>(walk.frames.size()));
  }
  measured.nodes_in_frustum /= static_cast<double>(walk.frames.size());
  measured.record.pictures = chooser.chosen();
}

// The colour plate: snapshots of the walk through scene `index`, each beside its plan, which shows what was
// culled by which occluders. Their files go to `files`.
Status drawPlate(SceneTimes& measured, Renderer& renderer, std::size_t index,
                 std::vector<ReportFile>& files) {
  Result<std::vector<ReportPicture>> pictures =
      drawPictures(measured.record, measured.input.scene, measured.data.occluders(), &renderer,
                   [&](Image image, const std::string& file) -> Status {
                     files.push_back({file, std::move(image), {}, index});
                     return Success{};
                   });
  if (!pictures) {
    return pictures.error();
  }
  for (ReportPicture& picture : *pictures) {
    picture.heading =
        fmt::format("Colour plate: frame {} of the walk through {}", picture.frame, measured.name);
  }
  measured.plate = std::move(*pictures);
  return Success{};
}

}  // namespace

Result<Reproduction> reproduceCoorgTeller(const ReproduceOptions& options,
                                          const std::vector<SceneAndWalk>& inputs) {
  const Threads threads(options.threads);
  Reproduction result;
  std::vector<SceneTimes> scenes;
  scenes.reserve(inputs.size());  // cullers hold on to their scene's data
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const SceneAndWalk& input = inputs[i];
    SceneTimes& measured = scenes.emplace_back(
        SceneTimes{options.scenes[i], input, CullingData(input.scene, threads.parallelFor(), input.walk)});
    const PictureOptions size = pictureSize(options.picture, input.walk.path);
    std::optional<Renderer> renderer = rendererOrNote(input.scene.view(), size, measured.name, result.notes);
    measured.record.width = size.width;
    measured.record.height = size.height;
    walkThrough(measured, renderer ? &*renderer : nullptr);
    if (renderer) {
      if (const Status drawn = drawPlate(measured, *renderer, i, result.files); !drawn) {
        return drawn.error();
      }
    }
    measured.speeds = measureSpeeds(input, measured.data, allSettings()[kKeptPlanes],
                                    options.fewer_frames ? kFewerStretchFrames : kStretchFrames);
    if (measured.speeds.empty()) {
      result.notes.push_back(measured.name + ": its path is too short for experiment 3.");
    }
  }
  result.experiments = tablesOf(scenes);
  result.findings = findingsOf(scenes);
  for (const SceneTimes& measured : scenes) {
    result.reports.push_back(reportOf(measured, result.experiments, options));
  }
  return result;
}

}  // namespace sightline::tool
