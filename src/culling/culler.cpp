#include "sightline/culling/culler.h"

#include <chrono>

#include "culling/hierarchical_walk.h"

namespace sightline {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

Visibility seeEverything(const Box&) {
  return Visibility::kVisible;
}

}  // namespace

struct Culler::Impl {
  Impl(const Hierarchy& h, std::span<const Box> bounds, const OccluderSet& o, const CullerSettings& s)
      : object_bounds(bounds),
        occluders(o),
        settings(s),
        walk(h, bounds),
        search(h, bounds),
        tree(OcclusionTreeSettings{.variant = s.variant}) {}

  // Temporal coherence of the choice: what was seen in the last frame holds the occluders of this one.
  // Without a last frame that resembles this one, or when little of it is left in view, all that the frustum
  // holds is looked through; a search that found little is not repeated for a while.
  std::span<const OccluderId> choose(const View& view, const Frustum& frustum) {
    const bool jump = jumped(view);
    ChoiceSettings choice;
    choice.count = settings.occluder_count;
    choice.direction = settings.area_angle_direction;
    choice.max_distance = jump ? 0.0 : settings.lambda_steps * last_step;
    std::span<const OccluderId> chosen;
    if (!jump) {
      chosen = chooser.choose(view, occluders, visible, object_bounds, choice);
    }
    const bool few = chosen.size() < settings.occluder_count / 2;
    if (jump || (few && frames_since_search >= frames_between_searches)) {
      candidates.clear();
      CullStats ignored;
      search.run(frustum, {.temporal_coherence = false}, seeEverything, ignored, candidates);
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

  void cullWithTree(const View& view, const Frustum& frustum, std::span<const Box> dynamic_boxes) {
    const Clock::time_point start = Clock::now();
    const std::span<const OccluderId> chosen = choose(view, frustum);
    const Clock::time_point chosen_at = Clock::now();
    tree.build(view, occluders, chosen);
    const Clock::time_point built_at = Clock::now();
    const auto classify = [this](const Box& box) { return tree.classify(box); };
    finish(frustum, dynamic_boxes, classify);
    const Clock::time_point end = Clock::now();
    stats.choose_us = microseconds(start, chosen_at);
    stats.build_us = microseconds(chosen_at, built_at);
    stats.walk_us = microseconds(built_at, end);
    stats.occluders = tree.stats().occluders;
    stats.tree_nodes = tree.stats().nodes;
    stats.tree_dropped = tree.stats().dropped;
  }

  void cullByFrustum(const Frustum& frustum, std::span<const Box> dynamic_boxes) {
    const Clock::time_point start = Clock::now();
    finish(frustum, dynamic_boxes, seeEverything);
    stats.walk_us = microseconds(start, Clock::now());
  }

  template <typename Classify>
  void finish(const Frustum& frustum, std::span<const Box> dynamic_boxes, Classify&& classify) {
    visible.clear();
    const WalkOptions options{settings.min_node_cost, settings.temporal_coherence, settings.test_objects};
    walk.run(frustum, options, classify, stats, visible);
    dynamic_states.clear();
    for (const Box& box : dynamic_boxes) {
      std::uint8_t planes = kAllFrustumPlanes;
      const bool outside = sightline::classify(frustum, box, planes) == FrustumSide::kOutside;
      dynamic_states.push_back(outside ? Visibility::kHidden : classify(box));
    }
  }

  using WalkOptions = culling_detail::WalkOptions;
  // A turn by more than 60 degrees, or a step ten times the last one, is a jump.
  static constexpr double kJumpCosine = 0.5;
  static constexpr double kJumpSteps = 10.0;
  static constexpr std::uint32_t kSearchPause = 16;

  std::span<const Box> object_bounds;
  const OccluderSet& occluders;
  CullerSettings settings;
  culling_detail::HierarchicalWalk walk, search;  // search: for occluders
  OccluderChooser chooser;
  OcclusionTree tree;
  std::vector<ObjectId> visible, candidates;
  std::vector<Visibility> dynamic_states;
  CullStats stats;
  bool has_previous = false;
  Vec3d previous_eye, previous_forward;
  double last_step = 0.0;
  std::uint32_t frames_since_search = 0, frames_between_searches = 0;
};

Culler::Culler(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
               const CullerSettings& settings)
    : impl_(std::make_unique<Impl>(hierarchy, object_bounds, occluders, settings)) {}
Culler::~Culler() = default;
Culler::Culler(Culler&&) noexcept = default;
Culler& Culler::operator=(Culler&&) noexcept = default;

void Culler::cull(const View& view, std::span<const Box> dynamic_boxes) {
  const Frustum frustum = frustumOf(view);
  impl_->stats = {};
  if (impl_->settings.method == CullMethod::kOcclusionTree) {
    impl_->cullWithTree(view, frustum, dynamic_boxes);
  } else {
    impl_->cullByFrustum(frustum, dynamic_boxes);
  }
}

std::span<const ObjectId> Culler::visible() const {
  return impl_->visible;
}
std::span<const Visibility> Culler::dynamicStates() const {
  return impl_->dynamic_states;
}
std::span<const OccluderId> Culler::occludersUsed() const {
  return impl_->settings.method == CullMethod::kOcclusionTree ? impl_->tree.occluders()
                                                              : std::span<const OccluderId>();
}
const CullStats& Culler::stats() const {
  return impl_->stats;
}

void Culler::reset() {
  impl_->has_previous = false;
  impl_->last_step = 0.0;
  impl_->frames_between_searches = 0;
  impl_->walk.forget();
}

}  // namespace sightline
