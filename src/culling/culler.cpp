#include "sightline/culling/culler.h"

#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include "src/culling/adaptive_coverage.h"
#include "src/culling/hierarchical_walk.h"
#include "src/culling/kept_planes.h"
#include "src/culling/scene_fit.h"
#include "src/culling/set_members.h"
#include "src/culling/set_walk.h"
#include "src/culling/wide_walk.h"
#include "src/scene/usable_view.h"

namespace sightline {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

using culling::AskAll;
using culling::KeptPlanes;
using culling::SceneSizes;
using culling::SetMembers;
using culling::WalkBox;

auto seeEverything() {
  return AskAll{[](const WalkBox&) { return Visibility::kVisible; }};
}

}  // namespace

struct Culler::Impl {
  using WalkOptions = culling::WalkOptions;

  Impl(const Hierarchy& h, std::span<const Box> bounds, const OccluderSet& o, const CullerSettings& s,
       const OccluderDatabases& d, VisibleSets* v)
      : hierarchy(h),
        object_bounds(bounds),
        occluders(o),
        settings(s),
        databases(d),
        sets(v),
        prepared(culling::isOf(h, bounds)),
        sizes(SceneSizes::of(h, o)),
        walk(preparedOf(h), bounds),
        search(preparedOf(h), bounds),
        tree(OcclusionTreeSettings{.variant = s.variant}),
        planes(planesSettings(s)),
        entered(h.nodes.size()),
        coverage(s.coverage_ratio),
        members(preparedOf(h), bounds, usesSets(s) ? v : nullptr, marksFor(s)),
        set_walk(s.method == CullMethod::kVisibilityOctree ? bounds.size() : 0) {
    if (s.method == CullMethod::kOpacityMap) {
      opacity_map.emplace(OpacityMapSettings{s.raster, s.depth_comparison, s.tolerance, s.coverage_ratio});
    } else if (s.method == CullMethod::kDepthPyramid) {
      pyramid.emplace(DepthPyramidSettings{s.raster});
      wide_walk.emplace(preparedOf(h), bounds);
      if (s.focus.magnification > 1.0 && s.raster.coverage == Coverage::kInner) {
        const DepthMapView map = pyramid->map();
        window.emplace(s.focus, map.width, map.height);
        RasterSettings fine = s.focus.raster;
        fine.coverage = s.raster.coverage;
        fine_pyramid.emplace(DepthPyramidSettings{fine});
      }
    }
  }

  // A hierarchy of other boxes is not looked into.
  const Hierarchy& preparedOf(const Hierarchy& h) const {
    static const Hierarchy kNone;
    return prepared ? h : kNone;
  }

  // Whether the scene is what the constructor saw, as far as that can be told in constant time.
  bool fits() const { return prepared && sizes == SceneSizes::of(hierarchy, occluders); }

  // Nothing is known of this frame's scene, or of its view.
  bool keepsEverything() const { return stats.unfit || stats.view_fault != nullptr; }
  void keepEverything() {
    visible.clear();
    culling::appendAll(hierarchy, object_bounds.size(), visible);
    has_previous = false;
  }

  static SupportingPlanesSettings planesSettings(const CullerSettings& settings) {
    SupportingPlanesSettings planes = settings.supporting_planes;
    planes.keep_relations = settings.temporal_coherence;
    return planes;
  }

  static bool usesSets(const CullerSettings& settings) {
    return settings.method == CullMethod::kVisibilityOctree ||
           (settings.visible_sets && settings.method != CullMethod::kFrustum);
  }
  static SetMembers::Marks marksFor(const CullerSettings& settings) {
    return settings.method == CullMethod::kVisibilityOctree ? SetMembers::Marks::kNone
                                                            : SetMembers::Marks::kAll;
  }

  // The set of the eye's cell, before all else.
  void lookUp(const View& view) {
    if (!usesSets(settings)) {
      return;
    }
    const Clock::time_point start = Clock::now();
    const bool another = members.find(view);
    if (another && wide_walk) {
      wide_walk->restrictTo(members.objects());
    }
    stats.set_nodes = static_cast<std::uint32_t>(members.nodes().size());
    stats.set_objects = members.objectCount();
    stats.look_up_us = microseconds(start, Clock::now());
  }

  // Maps draw a convex body as one.
  bool drawsBodies() const {
    return (settings.method == CullMethod::kOpacityMap || settings.method == CullMethod::kDepthPyramid) &&
           settings.raster.coverage == Coverage::kInner;
  }

  bool usesDatabase() const {
    return databases.from_eye != nullptr && settings.occluders == OccluderChoice::kDatabase;
  }

  bool usesViewpoints() const {
    return databases.from_viewpoints != nullptr && (settings.occluders == OccluderChoice::kMinimumSets ||
                                                    settings.occluders == OccluderChoice::kFirstHit ||
                                                    settings.occluders == OccluderChoice::kProjectedSize);
  }

  std::span<const OccluderId> chooseOccluders(const View& view, const Frustum& frustum) {
    ChoiceSettings choice;
    choice.count = settings.occluder_count;
    choice.direction = settings.area_angle_direction;
    choice.bodies = drawsBodies();
    if (usesDatabase()) {
      return chooser.choose(view, occluders, databases.from_eye->find(view.eye, view.forward), choice);
    }
    if (usesViewpoints()) {
      return chooser.takeFirst(view, occluders, databases.from_viewpoints->find(view.eye, view.forward),
                               settings.occluder_count);
    }
    return chooseByAreaAngle(view, frustum, choice);
  }

  // Temporal coherence of the choice: what was seen in the last frame holds the occluders of this one.
  // Without a last frame that resembles this one, or when little of it is left in view, all that the frustum
  // holds is looked through; a search that found little is not repeated for a while.
  std::span<const OccluderId> chooseByAreaAngle(const View& view, const Frustum& frustum,
                                                ChoiceSettings choice) {
    const bool jump = view_jumped;
    choice.max_distance = jump ? 0.0 : settings.lambda_steps * last_step;
    std::span<const OccluderId> chosen;
    if (!jump) {
      chosen = chooser.choose(view, occluders, visible, object_bounds, choice);
    }
    const bool few = chosen.size() < settings.occluder_count / 2;
    if (jump || (few && frames_since_search >= frames_between_searches)) {
      candidates.clear();
      CullStats ignored;
      search.run(frustum, {.temporal_coherence = false, .members = membersOrNull()}, seeEverything(), ignored,
                 candidates);
      const std::size_t before = chosen.size();
      chosen = chooser.choose(view, occluders, candidates, object_bounds, choice);
      frames_between_searches = chosen.size() > 2 * before ? 0 : kSearchPause;
      frames_since_search = 0;
    } else {
      ++frames_since_search;
    }
    return chosen;
  }

  // Whether this view has little to do with the last one; remembers it for the next call.
  bool jumped(const View& view) {
    const double step = has_previous ? length(view.eye - previous_eye) : 0.0;
    const bool jump = !has_previous || dot(view.forward, previous_forward) < kJumpCosine ||
                      (last_step > 0.0 && step > kJumpSteps * last_step);
    last_step = !jump && step > 0.0 ? step : last_step;
    has_previous = true;
    previous_eye = view.eye;
    previous_forward = view.forward;
    return jump;
  }

  // Choose, build, walk. build(chosen) makes the structure ready for the view; walk_with() fills `visible`.
  template <typename Build, typename Walk>
  void cullWith(const View& view, const Frustum& frustum, Build&& build, Walk&& walk_with) {
    const Clock::time_point start = Clock::now();
    const std::span<const OccluderId> chosen = chooseOccluders(view, frustum);
    const Clock::time_point chosen_at = Clock::now();
    build(chosen);
    const Clock::time_point built_at = Clock::now();
    visible.clear();
    walk_with();
    stats.choose_us = microseconds(start, chosen_at);
    stats.build_us = microseconds(chosen_at, built_at);
    stats.walk_us = microseconds(built_at, Clock::now());
  }

  void cullWithTree(const View& view, const Frustum& frustum, const OccluderSet* moving) {
    cullWith(
        view, frustum, [&](std::span<const OccluderId> chosen) { tree.build(view, inUse(chosen, moving)); },
        [&] {
          walkWith(frustum, settings.temporal_coherence, AskAll{[this](const WalkBox& asked) {
                     return tree.classify(asked.box, asked.frustum_planes);
                   }});
        });
    stats.occluders = tree.stats().occluders;
    stats.tree_nodes = tree.stats().nodes;
    stats.tree_dropped = tree.stats().dropped;
  }

  // Supporting planes have temporal coherence of their own, which needs every node's lists.
  void cullWithPlanes(const View& view, const Frustum& frustum, const OccluderSet* moving) {
    cullWith(
        view, frustum, [&](std::span<const OccluderId> chosen) { planes.build(view, inUse(chosen, moving)); },
        [&] {
          walkWith(frustum, false, KeptPlanes{planes, hierarchy, entered});
        });
    stats.occluders = planes.stats().occluders;
  }

  // The chosen occluders of the culler's own set, and then all that move. Valid until the next call.
  std::span<const ChosenOccluders> inUse(std::span<const OccluderId> chosen, const OccluderSet* moving) {
    in_use[0] = {&occluders, chosen};
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

  // Returns how many of the map's occluders are of the culler's own set: what moves has ids of its own.
  template <typename Map>
  std::size_t draw(Map& map, const View& view, std::span<const OccluderId> chosen,
                   const OccluderSet* moving) {
    map.begin(view);
    const std::span<const ChosenOccluders> parts = inUse(chosen, moving);
    map.draw(*parts[0].set, parts[0].chosen, parallel_for);
    const std::size_t own = map.occluders().size();
    for (const ChosenOccluders& part : parts.subspan(1)) {
      map.draw(*part.set, part.chosen, parallel_for);
    }
    return own;
  }

  // The finer map: of the first one's occluders, and of those that the last frame kept in the window.
  void drawFocus(std::span<const OccluderId> chosen, const OccluderSet* moving) {
    candidates.clear();
    for (const ObjectId object : visible) {
      if (window->mayShow(object_bounds[object.value])) {
        candidates.push_back(object);
      }
    }
    fine_chosen.clear();
    for (const OccluderId id : chosen) {
      const OccluderBody* body = occluders.bodyOf(id);
      if (body == nullptr || window->mayShow(body->bounds)) {
        fine_chosen.push_back(id);
      }
    }
    const ChoiceSettings choice{.count = settings.focus.occluder_count, .bodies = true};
    const auto more = fine_chooser.choose(window->view(), occluders, candidates, object_bounds, choice);
    fine_chosen.insert(fine_chosen.end(), more.begin(), more.end());
    draw(*fine_pyramid, window->view(), fine_chosen, moving);
    fine_pyramid->finish(parallel_for);
  }

  void takeRasterStats(const RasterStats& raster) {
    stats.occluders = raster.occluders;
    stats.occluders_hidden = raster.hidden;
  }

  void cullWithOpacityMap(const View& view, const Frustum& frustum, const OccluderSet* moving) {
    opacity_map->setCoverageRatio(coverage.ratio());
    stats.coverage_ratio = coverage.ratio();
    stats.suspended = coverage.suspended();
    if (stats.suspended) {
      cullByFrustum(frustum);
    } else {
      cullWith(
          view, frustum,
          [&](std::span<const OccluderId> chosen) {
            used_count = draw(*opacity_map, view, chosen, moving);
            opacity_map->finish();
          },
          [&] {
            walkWith(frustum, false,
                     AskAll{[this](const WalkBox& asked) { return opacity_map->classify(asked.box); }});
          });
      stats.opacity = opacity_map->stats();
      takeRasterStats(stats.opacity.raster);
    }
    if (settings.triangle_us > 0.0) {
      coverage.frame(stats.choose_us + stats.build_us + stats.walk_us,
                     static_cast<double>(stats.hidden_triangles) * settings.triangle_us);
    }
  }

  void cullWithPyramid(const View& view, const Frustum& frustum, const OccluderSet* moving) {
    if (view_jumped) {
      wide_walk->forget();
    }
    cullWith(
        view, frustum,
        [&](std::span<const OccluderId> chosen) {
          used_count = draw(*pyramid, view, chosen, moving);
          pyramid->finish(parallel_for);
          if (window) {
            window->begin(view, !view_jumped && settings.occluder_count > 0);
            stats.focused = window->found();
            if (stats.focused) {
              drawFocus(chosen, moving);
            }
          }
        },
        [&] {
          const culling::WalkMaps maps{*pyramid, window ? &*window : nullptr,
                                       stats.focused ? &*fine_pyramid : nullptr};
          wide_walk->run(maps, walkOptions(settings.temporal_coherence), stats, visible, parallel_for);
        });
    takeRasterStats(pyramid->stats().raster);
  }

  // The second test of what the walk kept: is the eye hidden from the object by occluders near the object?
  void testDetailObjects(const View& view) {
    const Clock::time_point start = Clock::now();
    if (settings.method != CullMethod::kSupportingPlanes) {
      planes.build(view, occluders, {});
    }
    const auto first_item = static_cast<std::uint32_t>(hierarchy.nodes.size() + hierarchy.objects.size());
    std::span<const OccluderId> last_near;
    OccluderList list;
    std::erase_if(visible, [&](ObjectId object) {
      const Box& box = object_bounds[object.value];
      if (!box.wellFormed()) {
        return false;
      }
      const Vec3d middle = center(box);
      // Towards the eye: what stands in between faces the eye, and turns its back to the object.
      const Vec3d to_eye = view.orthographic ? -view.forward : view.eye - middle;
      const std::span<const OccluderId> found = databases.from_objects->find(middle, to_eye);
      const auto near = found.subspan(0, std::min<std::size_t>(found.size(), settings.detail_occluder_count));
      if (near.data() != last_near.data() || near.size() != last_near.size()) {
        last_near = near;
        list = planes.add(near);
      }
      OccluderList touching;
      const bool hidden =
          planes.classify(box, first_item + object.value, list, touching) == Visibility::kHidden;
      stats.detail_tested += 1;
      stats.detail_culled += hidden ? 1 : 0;
      return hidden;
    });
    stats.detail_us = microseconds(start, Clock::now());
  }

  void cullByFrustum(const Frustum& frustum) {
    const Clock::time_point start = Clock::now();
    visible.clear();
    walkWith(frustum, settings.temporal_coherence, seeEverything());
    stats.walk_us = microseconds(start, Clock::now());
  }

  // No more than the set of the eye's cell, as far as it meets the frustum.
  void cullBySet(const Frustum& frustum) {
    if (members.everything()) {
      cullByFrustum(frustum);
      return;
    }
    const Clock::time_point start = Clock::now();
    visible.clear();
    set_walk.run(frustum, members.boxes(), members.nodes(), stats, visible);
    stats.walk_us = microseconds(start, Clock::now());
  }

  const SetMembers* membersOrNull() const { return members.everything() ? nullptr : &members; }

  WalkOptions walkOptions(bool skip_partial) const {
    return {settings.min_node_cost, skip_partial, settings.test_objects, membersOrNull()};
  }

  // skip_partial: nodes that were partly visible in the last frame.
  template <typename Structure>
  void walkWith(const Frustum& frustum, bool skip_partial, Structure&& structure) {
    walk.run(frustum, walkOptions(skip_partial), structure, stats, visible);
  }

  void classifyAll(const Frustum& frustum, std::span<const Box> dynamic_boxes) {
    const Clock::time_point start = Clock::now();
    dynamic_states.clear();
    for (const Box& box : dynamic_boxes) {
      std::uint8_t cut = kAllFrustumPlanes;
      const bool outside = sightline::classify(frustum, box, cut) == FrustumSide::kOutside;
      dynamic_states.push_back(outside ? Visibility::kHidden : classifyDynamic(box, cut));
    }
    stats.walk_us += microseconds(start, Clock::now());
  }

  // frustum_planes: those that the box may cross.
  Visibility classifyDynamic(const Box& box, std::uint8_t frustum_planes) {
    if (!box.wellFormed() || keepsEverything()) {
      return Visibility::kVisible;
    }
    switch (settings.method) {
      case CullMethod::kOcclusionTree:
        return tree.classify(box, frustum_planes);
      case CullMethod::kSupportingPlanes:
        return planes.classify(box);
      case CullMethod::kOpacityMap:
        return stats.suspended ? Visibility::kVisible : opacity_map->classify(box);
      case CullMethod::kDepthPyramid:
        return pyramid->classify(box);
      case CullMethod::kFrustum:
      case CullMethod::kVisibilityOctree:  // sets know nothing of what moves
        break;
    }
    return Visibility::kVisible;
  }

  // A turn by more than 60 degrees, or a step ten times the last one, is a jump.
  static constexpr double kJumpCosine = 0.5;
  static constexpr double kJumpSteps = 10.0;
  static constexpr std::uint32_t kSearchPause = 16;

  const Hierarchy& hierarchy;
  std::span<const Box> object_bounds;
  const OccluderSet& occluders;
  CullerSettings settings;
  OccluderDatabases databases;
  VisibleSets* sets;
  bool prepared;                           // the hierarchy is of the boxes
  SceneSizes sizes;                        // as the constructor saw them
  culling::HierarchicalWalk walk, search;  // search: for occluders
  OccluderChooser chooser;
  OcclusionTree tree;
  SupportingPlanes planes;
  std::vector<bool> entered;              // by node, see KeptPlanes
  std::optional<OpacityMap> opacity_map;  // with the method
  std::optional<DepthPyramid> pyramid;    // with the method
  std::optional<culling::WideWalk> wide_walk;
  std::optional<culling::FocusWindow> window;  // with the settings
  std::optional<DepthPyramid> fine_pyramid;    // of the window
  OccluderChooser fine_chooser;
  std::vector<OccluderId> fine_chosen;
  culling::AdaptiveCoverage coverage;
  SetMembers members;
  culling::SetWalk set_walk;  // with the method
  ParallelFor parallel_for = serialFor;
  std::vector<OccluderId> all_moving;
  std::array<ChosenOccluders, 2> in_use;  // see inUse()
  std::size_t used_count = 0;             // of the map's occluders those of the culler's own set
  std::vector<ObjectId> visible, candidates;
  std::vector<Visibility> dynamic_states;
  CullStats stats;
  bool has_previous = false;
  bool view_jumped = true;  // the last view has little to do with the one before
  Vec3d previous_eye, previous_forward;
  double last_step = 0.0;
  std::uint32_t frames_since_search = 0, frames_between_searches = 0;
};

Culler::Culler(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
               const CullerSettings& settings, const OccluderDatabases& databases, VisibleSets* sets)
    : impl_(std::make_unique<Impl>(hierarchy, object_bounds, occluders, settings, databases, sets)) {}
Culler::~Culler() = default;
Culler::Culler(Culler&&) noexcept = default;
Culler& Culler::operator=(Culler&&) noexcept = default;

void Culler::cull(const View& given, std::span<const Box> dynamic_boxes, const OccluderSet* moving) {
  View view = given;
  const char* fault = makeUsable(view);
  const Frustum frustum = frustumOf(view);
  impl_->stats = {};
  impl_->stats.view_fault = fault;
  impl_->stats.unfit = !impl_->fits();
  if (impl_->keepsEverything()) {
    impl_->keepEverything();
    impl_->classifyAll(frustum, dynamic_boxes);
    return;
  }
  impl_->view_jumped = impl_->jumped(view);
  impl_->lookUp(view);
  const CullMethod method = impl_->settings.method;
  switch (method) {
    case CullMethod::kFrustum:
      impl_->cullByFrustum(frustum);
      break;
    case CullMethod::kOcclusionTree:
      impl_->cullWithTree(view, frustum, moving);
      break;
    case CullMethod::kSupportingPlanes:
      impl_->cullWithPlanes(view, frustum, moving);
      break;
    case CullMethod::kOpacityMap:
      impl_->cullWithOpacityMap(view, frustum, moving);
      break;
    case CullMethod::kDepthPyramid:
      impl_->cullWithPyramid(view, frustum, moving);
      break;
    case CullMethod::kVisibilityOctree:
      impl_->cullBySet(frustum);
      break;
  }
  impl_->classifyAll(frustum, dynamic_boxes);
  if (impl_->settings.detail_objects && impl_->databases.from_objects != nullptr &&
      method != CullMethod::kFrustum && method != CullMethod::kVisibilityOctree) {
    impl_->testDetailObjects(view);
  }
  impl_->stats.relations = impl_->planes.stats().relations;
  if (method == CullMethod::kOcclusionTree) {
    impl_->stats.tree_plane_tests = impl_->tree.stats().plane_tests;
  }
}

std::span<const ObjectId> Culler::visible() const {
  return impl_->visible;
}
std::span<const Visibility> Culler::dynamicStates() const {
  return impl_->dynamic_states;
}
std::span<const OccluderId> Culler::occludersUsed() const {
  if (impl_->keepsEverything()) {
    return {};
  }
  switch (impl_->settings.method) {
    case CullMethod::kOcclusionTree:
      return impl_->tree.occluders();
    case CullMethod::kSupportingPlanes:
      return impl_->planes.occluders();
    case CullMethod::kOpacityMap:
      return impl_->stats.suspended ? std::span<const OccluderId>()
                                    : impl_->opacity_map->occluders().first(impl_->used_count);
    case CullMethod::kDepthPyramid:
      return impl_->pyramid->occluders().first(impl_->used_count);
    case CullMethod::kFrustum:
    case CullMethod::kVisibilityOctree:
      break;
  }
  return {};
}
const CullStats& Culler::stats() const {
  return impl_->stats;
}
DepthMapView Culler::depthMap() const {
  if (impl_->keepsEverything()) {
    return {};
  }
  if (impl_->opacity_map) {
    return impl_->opacity_map->map();
  }
  return impl_->pyramid ? impl_->pyramid->map() : DepthMapView{};
}

void Culler::setParallelFor(ParallelFor parallel_for) {
  impl_->parallel_for = std::move(parallel_for);
}

void Culler::reset() {
  reset(impl_->hierarchy, impl_->object_bounds, impl_->occluders, impl_->databases, impl_->sets);
}

void Culler::reset(const Hierarchy& hierarchy, std::span<const Box> object_bounds,
                   const OccluderSet& occluders, const OccluderDatabases& databases, VisibleSets* sets) {
  auto anew = std::make_unique<Impl>(hierarchy, object_bounds, occluders, impl_->settings, databases, sets);
  anew->parallel_for = std::move(impl_->parallel_for);
  impl_ = std::move(anew);
}

}  // namespace sightline
