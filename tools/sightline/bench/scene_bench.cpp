#include "tools/sightline/bench/scene_bench.h"

#include <memory>
#include <utility>

#include "src/base/stopwatch.h"
#include "tools/sightline/bench/advice.h"
#include "tools/sightline/bench/machine.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/exact/exact_several_boxes.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

// Rays that look for visible objects before proofs decide about the others: as many as take little time.
constexpr std::uint32_t kRayColumns = 640, kRayRows = 360;

std::vector<View> viewsOf(const Walk& walk, const Scene& scene) {
  std::vector<View> views;
  for (const std::uint32_t frame : walk.frames) {
    views.push_back(walk.view(frame, scene));
  }
  return views;
}

std::uint64_t hashOf(const std::vector<View>& views) {
  pvs::Checksum hash;
  for (const View& view : views) {
    hash.add(viewBytes(view));
  }
  return hash.value();
}

}  // namespace

BenchRecord SceneBench::measure(const std::string& name, BenchInput& input) {
  const Scene& scene = input.data.scene;
  const Walk& walk = input.data.walk;
  const std::vector<View> views = viewsOf(walk, scene);
  BenchRecord record{.scene_name = name + crackText(input.data.closing.note()),
                     .path_name = walk.path.name.empty() ? "unnamed" : walk.path.name,
                     .scene = sceneId(scene.view()),
                     .cracks = input.data.closing.note(),
                     .views = hashOf(views),
                     .frames = views.size(),
                     .rounds = settings_.rounds,
                     .load_us = input.load_us};
  const PictureOptions size = pictureSize(settings_.picture, walk.path);
  const std::vector<ExactObjects> exact = exactFrames(scene, views, record);
  countSeveralBoxes(input.data, views, exact, record);
  run(input, views, exact, size, record);
  markFront(record);
  record.advice = adviceFor(record);
  return record;
}

std::vector<ExactObjects> SceneBench::exactFrames(const Scene& scene, const std::vector<View>& views,
                                                  BenchRecord& record) {
  const ExactSettings settings = exactSettings();
  std::unique_ptr<ExactVisibility> oracle;  // made when the first view needs it
  std::vector<ExactObjects> frames;
  ProgressBar progress("exact visibility of " + record.scene_name);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ExactKey key(record.scene, views[i], settings);
    std::optional<ExactObjects> frame = cache_.find(key);
    record.frames_from_cache += frame ? 1 : 0;
    if (!frame) {
      if (!oracle) {
        oracle = std::make_unique<ExactVisibility>(scene.view());
      }
      const auto object_count = static_cast<std::uint32_t>(scene.objects.size());
      frame = objectsOf(exactFrame(*oracle, views[i], object_count, settings, threads_.parallelFor()));
      addBoxes(*oracle, views[i], object_count, settings, threads_.parallelFor(), *frame);
      keep(key, *frame);
    }
    record.witnessed += frame->witnessed.size();
    record.undecided += frame->undecided.size();
    record.boxes += frame->witnessed.size() + frame->boxes.size();
    record.undecided_boxes += frame->undecided_boxes.size();
    frames.push_back(std::move(*frame));
    progress.update(static_cast<double>(i + 1) / static_cast<double>(views.size()));
  }
  return frames;
}

void SceneBench::countSeveralBoxes(const SceneAndWalk& input, const std::vector<View>& views,
                                   const std::vector<ExactObjects>& exact, BenchRecord& record) {
  const ExactSettings settings = exactSettings();
  const SceneView scene = input.scene.view();
  const ObjectBoxes boxes = findObjectBoxes(scene, {.margin = input.closing.margin}, threads_.parallelFor());
  std::unique_ptr<ExactSeveralBoxes> oracle;  // made when the first view needs it
  ProgressBar progress("exact visibility of boxes of " + record.scene_name);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ExactKey key = severalBoxesKey({record.scene, views[i], settings}, boxes);
    std::optional<ExactObjects> left = cache_.find(key);
    if (!left) {
      if (!oracle) {
        oracle = std::make_unique<ExactSeveralBoxes>(scene, boxes);
      }
      left = oracle->left(views[i], exact[i], settings, threads_.parallelFor());
      keep(key, *left);
    }
    record.several_boxes += exact[i].witnessed.size() + left->boxes.size();
    record.undecided_several_boxes += left->undecided_boxes.size();
    progress.update(static_cast<double>(i + 1) / static_cast<double>(views.size()));
  }
}

ExactSettings SceneBench::exactSettings() const {
  return {.width = kRayColumns, .height = kRayRows, .steps = settings_.steps};
}

void SceneBench::keep(const ExactKey& key, const ExactObjects& frame) {
  const Status kept = cache_.keep(key, frame);
  if (!kept && !told_) {
    printNote("exact visibility is not kept: {}", kept.error().message);
    told_ = true;
  }
}

void SceneBench::run(BenchInput& input, const std::vector<View>& views,
                     const std::vector<ExactObjects>& exact, const PictureOptions& size,
                     BenchRecord& record) {
  CullingData data(input.data, threads_.parallelFor());
  std::vector<BenchRun> runs = makeBenchRuns(methods_, data);
  warmUp(runs, views, exact);
  {
    const CorePin pin;
    record.core = pin.core();
    ProgressBar progress("culling " + record.scene_name);
    measureCulling(runs, views, settings_.rounds, [&](double done) { progress.update(done); });
  }
  if (settings_.draw) {
    draw(input.data.given(), runs, views, size, record);
  }
  data.noteUnknownSets();
  for (BenchRun& run : runs) {
    record.runs.push_back(std::move(run.record));
  }
}

void SceneBench::draw(const SceneView& scene, std::vector<BenchRun>& runs, const std::vector<View>& views,
                      const PictureOptions& size, BenchRecord& record) const {
  Result<Renderer> renderer = Renderer::create(scene, size.width, size.height);
  if (!renderer) {
    printNote("nothing is drawn: {}", renderer.error().message);
    return;
  }
  record.device = renderer->device();
  ProgressBar progress("drawing " + record.scene_name);
  measureDrawing(runs, views, settings_.rounds, *renderer, [&](double done) { progress.update(done); });
}

}  // namespace sightline::tool
