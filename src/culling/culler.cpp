#include "sightline/culling/culler.h"

#include <array>
#include <optional>
#include <utility>

#include "src/base/stopwatch.h"
#include "src/culling/last_view.h"
#include "src/culling/occluder_choice.h"
#include "src/culling/scene_fit.h"
#include "src/culling/set_filter.h"
#include "src/culling/several_boxes.h"
#include "src/culling/views_to_come.h"
#include "src/scene/usable_view.h"

namespace sightline {
namespace {

using culling::SceneSizes;
using culling::SetFilter;

// Replaces null pointers by an empty hierarchy and an empty set of occluders.
CullingScene withoutNulls(CullingScene scene) {
  static const Hierarchy kNoHierarchy;
  static const OccluderSet kNoOccluders;
  scene.hierarchy = scene.hierarchy != nullptr ? scene.hierarchy : &kNoHierarchy;
  scene.occluders = scene.occluders != nullptr ? scene.occluders : &kNoOccluders;
  return scene;
}

bool usesSets(SetUse use, const CullerSettings& settings) {
  return use == SetUse::kAlways || (use == SetUse::kIfAsked && settings.visible_sets);
}

// Why the parts of the scene do not belong together; null if they do.
const char* misfitOf(const CullingScene& scene, const MethodTraits& traits) {
  if (scene.hierarchy == nullptr) {
    return traits.hierarchy ? "CullingScene::hierarchy is null" : nullptr;
  }
  return culling::isOf(*scene.hierarchy, scene.object_bounds)
             ? nullptr
             : "CullingScene::hierarchy is not of CullingScene::object_bounds";
}

bool hidesNothing(const CullingScene& scene) {
  return scene.occluders->occluders.empty() && (scene.surfaces == nullptr || scene.surfaces->parts.empty());
}

}  // namespace

struct Culler::Impl {
  // The method goes into `owned` once this has succeeded.
  Impl(const CullingScene& g, CullingMethod& m, const CullerSettings& s)
      : given(g),
        scene(withoutNulls(g)),
        settings(s),
        method(&m),
        traits(m.traits()),
        misfit(misfitOf(given, traits)),
        sizes(SceneSizes::of(*scene.hierarchy, *scene.occluders)),
        views_to_come(s.views_at_once) {
    // A hierarchy that does not fit is never read.
    CullingScene checked = scene;
    if (misfit != nullptr) {
      checked.hierarchy = nullptr;
      checked = withoutNulls(checked);
    }
    method->prepare(checked);
    if (usesSets(traits.sets, settings)) {
      // Marks are for those who descend the hierarchy.
      const SetFilter::Marks marks =
          traits.hierarchy || traits.occluders ? SetFilter::Marks::kAll : SetFilter::Marks::kNone;
      filter.emplace(*checked.hierarchy, checked.object_bounds, checked.sets, marks);
    }
    if (traits.occluders) {
      choice.emplace(checked, settings.occluders);
    }
    if (scene.object_boxes != nullptr && settings.test_objects) {
      several_boxes.emplace(*scene.object_boxes, scene.object_bounds);
    }
    note = findNote();
    takeStatistics();
    clearStatistics();
  }

  const char* findNote() const {
    if (filter && scene.sets != nullptr && !filter->usesSets()) {
      return "CullingScene::sets are of other boxes than CullingScene::object_bounds, and are not used";
    }
    if (traits.occluders && hidesNothing(scene)) {
      return "CullingScene::surfaces and CullingScene::occluders are empty: only what moves can be drawn as "
             "an occluder";
    }
    return nullptr;
  }

  void takeStatistics() {
    const std::span<const MethodStatistic> of_method = method->statistics();
    statistics.assign(of_method.begin(), of_method.end());
  }
  void clearStatistics() {
    for (MethodStatistic& statistic : statistics) {
      statistic.value = 0;
    }
  }

  // Why the scene is not to be looked into, also if it is not the one given to the constructor, as far as
  // constant time allows to tell.
  const char* sceneFault() const {
    if (misfit != nullptr) {
      return misfit;
    }
    return sizes == SceneSizes::of(*scene.hierarchy, *scene.occluders)
               ? nullptr
               : "the hierarchy or the occluders changed without Culler::reset()";
  }

  // True if the scene does not fit together or the view is invalid, so that nothing may be culled.
  bool keepsEverything() const { return stats.scene_fault != nullptr || stats.view_fault != nullptr; }
  void keepEverything() {
    answer.clear();
    culling::appendAll(*scene.hierarchy, scene.object_bounds.size(), answer);
    last_view.forget();
    views_to_come.forget();
    of_several = false;
    clearStatistics();
  }

  // Finds the set of the eye's cell. Returns true if it differs from that of the last frame.
  bool lookUp(const View& view) {
    base::Stopwatch watch;
    const bool another = filter->find(view);
    stats.set_nodes = static_cast<std::uint32_t>(filter->nodes().size());
    stats.set_objects = filter->objectCount();
    stats.look_up_us = watch.lap();
    return another;
  }

  void cullView(const View& view, const Frustum& frustum, const OccluderSet* moving,
                std::span<const MovingSurfaces> moving_surfaces) {
    const bool alone =
        moving == nullptr && moving_surfaces.empty();  // else what hides is another set in each
    const bool jumped = last_view.jumpsTo(view);
    views_to_come.see(view);
    if (alone && views_to_come.takeHeld()) {
      stats.held = true;
      ++held_frames;
      clearStatistics();
      keepInView(frustum);
      return;
    }
    of_several = alone && !jumped && !filter && method->answersForRegions() && views_to_come.plan();
    if (of_several) {
      culled_view = views_to_come.wide();
      cullObjects(culled_view, frustumOf(culled_view), views_to_come.viewers(), jumped, moving,
                  moving_surfaces);
      keepInView(frustum);
    } else {
      views_to_come.end();
      culled_view = view;
      cullObjects(view, frustum, {}, jumped, moving, moving_surfaces);
    }
    views_to_come.measure(culled_view, method->depthBuffer());
  }

  // Sets `in_view` to the objects of the answer that are in the view.
  void keepInView(const Frustum& frustum) {
    base::Stopwatch watch;
    in_view.clear();
    for (const ObjectId object : answer) {
      std::uint8_t cut = kAllFrustumPlanes;
      if (classify(frustum, scene.object_bounds[object.value], cut) != FrustumSide::kOutside) {
        in_view.push_back(object);
      }
    }
    stats.traverse_us += watch.lap();
  }

  void cullObjects(const View& view, const Frustum& frustum, const ViewerRegion& viewers, bool jumped,
                   const OccluderSet* moving, std::span<const MovingSurfaces> moving_surfaces) {
    const bool another_set = filter && lookUp(view);
    const SetFilter* set = filter && !filter->everything() ? &*filter : nullptr;
    base::Stopwatch watch;
    CullingFrame frame{.view = view,
                       .frustum = frustum,
                       .viewers = viewers,
                       .jumped = jumped,
                       .moving_surfaces = moving_surfaces,
                       .max_occluders = settings.occluders.count,
                       .last_visible = answer,
                       .held_before = std::exchange(held_frames, 0u),
                       .filter = set,
                       .filter_changed = another_set,
                       .min_node_cost = settings.min_node_cost,
                       .test_objects = settings.test_objects,
                       .parallel_for = &parallel_for};
    if (choice) {
      std::span<const OccluderId> chosen;
      if (method->wantsOccluders()) {
        chosen =
            choice->choose({view, frustum, jumped, last_view.step(), answer, set, method->drawsBodies()});
        stats.choose_us = watch.lap();
      }
      frame.occluders = inUse(chosen, moving);
    }
    method->build(frame);
    stats.build_us = watch.lap();
    answer.clear();
    frame.last_visible = {};
    method->traverse(frame, stats, answer);
    if (several_boxes) {
      several_boxes->removeHidden(frustum, *method, answer);
    }
    stats.traverse_us = watch.lap() - stats.detail_us;
  }

  // Returns the chosen occluders of the scene, followed by all moving ones. Valid until the next call.
  std::span<const ChosenOccluders> inUse(std::span<const OccluderId> chosen, const OccluderSet* moving) {
    in_use[0] = {scene.occluders, chosen};
    if (moving == nullptr) {
      return std::span(in_use).first(1);
    }
    all_moving.clear();
    for (std::size_t i = 0; i < moving->occluders.size(); ++i) {
      all_moving.push_back(OccluderId(i));
    }
    in_use[1] = {moving, all_moving};
    return in_use;
  }

  // Returns the time that it took, microseconds.
  double classifyMoving(const Frustum& frustum, std::span<const Box> boxes) {
    base::Stopwatch watch;
    dynamic_states.assign(boxes.size(), Visibility::kVisible);
    asked.clear();
    asked_boxes.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      std::uint8_t cut = kAllFrustumPlanes;
      if (sightline::classify(frustum, boxes[i], cut) == FrustumSide::kOutside) {
        dynamic_states[i] = Visibility::kHidden;
      } else if (boxes[i].wellFormed() && !keepsEverything()) {
        asked.push_back(i);
        asked_boxes.push_back({boxes[i], cut});
      }
    }
    asked_states.resize(asked.size());
    if (!asked.empty()) {
      method->classify(asked_boxes, asked_states);
    }
    for (std::size_t i = 0; i < asked.size(); ++i) {
      dynamic_states[asked[i]] = asked_states[i];
    }
    return watch.lap();
  }

  CullingScene given;  // as the caller passed it
  CullingScene scene;  // the same without null pointers
  CullerSettings settings;
  std::unique_ptr<CullingMethod> owned;
  CullingMethod* method;  // owned, or about to be
  MethodTraits traits;
  const char* misfit;                             // why its parts do not belong together; null: they do
  const char* note = nullptr;                     // see CullStats::scene_note
  SceneSizes sizes;                               // at construction
  std::optional<SetFilter> filter;                // if sets are used
  std::optional<culling::OccluderChoice> choice;  // if the method uses occluders
  std::optional<culling::SeveralBoxes> several_boxes;
  culling::LastView last_view;
  culling::ViewsToCome views_to_come;
  View culled_view;              // the last one that was culled
  std::vector<ObjectId> answer;  // what was kept in it
  bool of_several = false;       // it was found for several views, of which this frame's keeps `in_view`
  std::vector<ObjectId> in_view;
  std::uint32_t held_frames = 0;  // since the last view that was culled
  ParallelFor parallel_for = serialFor;
  std::array<ChosenOccluders, 2> in_use;  // see inUse()
  std::vector<OccluderId> all_moving;
  std::vector<Visibility> dynamic_states;
  // The moving boxes that the method classifies: their indices, the boxes and the results.
  std::vector<std::size_t> asked;
  std::vector<MovingBox> asked_boxes;
  std::vector<Visibility> asked_states;
  CullStats stats;
  std::vector<MethodStatistic> statistics;  // of the method in the last frame
};

Culler::Culler(const CullingScene& scene, std::unique_ptr<CullingMethod> method,
               const CullerSettings& settings)
    : impl_(std::make_unique<Impl>(scene, *method, settings)) {
  impl_->owned = std::move(method);
}
Culler::~Culler() = default;
Culler::Culler(Culler&&) noexcept = default;
Culler& Culler::operator=(Culler&&) noexcept = default;

void Culler::cull(const View& given, std::span<const Box> dynamic_boxes, const OccluderSet* moving,
                  std::span<const MovingSurfaces> moving_surfaces) {
  View view = given;
  const char* fault = scene::makeUsable(view);
  const Frustum frustum = frustumOf(view);
  impl_->stats = {};
  impl_->stats.view_fault = fault;
  impl_->stats.scene_fault = impl_->sceneFault();
  impl_->stats.scene_note = impl_->note;
  if (impl_->keepsEverything()) {
    impl_->keepEverything();
    impl_->stats.traverse_us = impl_->classifyMoving(frustum, dynamic_boxes);
    return;
  }
  impl_->cullView(view, frustum, moving, moving_surfaces);
  if (impl_->stats.held) {
    impl_->stats.traverse_us += impl_->classifyMoving(frustum, dynamic_boxes);
    return;
  }
  const double moving_us = impl_->classifyMoving(frustum, dynamic_boxes);
  impl_->method->finish(impl_->stats);
  impl_->takeStatistics();
  impl_->stats.traverse_us += moving_us;
}

std::span<const ObjectId> Culler::visible() const {
  return impl_->of_several ? impl_->in_view : impl_->answer;
}
std::span<const Visibility> Culler::dynamicStates() const {
  return impl_->dynamic_states;
}
std::span<const OccluderId> Culler::occludersUsed() const {
  return impl_->keepsEverything() ? std::span<const OccluderId>() : impl_->method->occludersUsed();
}
const CullStats& Culler::stats() const {
  return impl_->stats;
}
std::span<const MethodStatistic> Culler::statistics() const {
  return impl_->statistics;
}
std::uint64_t Culler::statistic(std::string_view group, std::string_view name) const {
  for (const MethodStatistic& statistic : statistics()) {
    if (statistic.group == group && statistic.name == name) {
      return statistic.value;
    }
  }
  return 0;
}
DepthBufferView Culler::depthBuffer() const {
  return impl_->keepsEverything() ? DepthBufferView{} : impl_->method->depthBuffer();
}

const View& Culler::depthBufferView() const {
  return impl_->culled_view;
}

void Culler::setParallelFor(ParallelFor parallel_for) {
  impl_->parallel_for = std::move(parallel_for);
}

void Culler::reset() {
  reset(CullingScene(impl_->given));
}

void Culler::reset(const CullingScene& scene) {
  // Should the new one throw for want of memory, the method is of neither scene, and this keeps everything.
  impl_->misfit = "Culler::reset() did not succeed";
  auto anew = std::make_unique<Impl>(scene, *impl_->method, impl_->settings);
  anew->owned = std::move(impl_->owned);
  anew->parallel_for = std::move(impl_->parallel_for);
  impl_ = std::move(anew);
}

}  // namespace sightline
