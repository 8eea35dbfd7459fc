#include "src/culling/occluder_choice.h"

namespace sightline::culling {
namespace {

// Number of frames for which a search that found few new occluders is not repeated.
constexpr std::uint32_t kSearchPause = 16;

}  // namespace

std::span<const OccluderId> OccluderChoice::choose(const ChoiceFrame& frame) {
  const ChoiceSettings choice{
      .count = settings_.count, .direction = settings_.area_angle_direction, .bodies = frame.bodies};
  const OccluderLists* lists = scene_.occluder_lists;
  if (lists == nullptr) {
    return chooseAmongSeen(frame, choice);
  }
  const std::span<const OccluderId> list = lists->find(frame.view.eye, frame.view.forward);
  return lists->inOrder() ? chooser_.takeFirst(frame.view, *scene_.occluders, list, settings_.count)
                          : chooser_.choose(frame.view, *scene_.occluders, list, choice);
}

// Uses temporal coherence: the objects that were visible in the last frame provide the candidates of this
// one. After a jump, or when too few of these occluders are in view, all objects in the frustum are searched.
std::span<const OccluderId> OccluderChoice::chooseAmongSeen(const ChoiceFrame& frame, ChoiceSettings choice) {
  choice.max_distance = frame.jumped ? 0.0 : settings_.lambda_steps * frame.last_step;
  std::span<const OccluderId> chosen;
  if (!frame.jumped) {
    chosen = chooser_.choose(frame.view, *scene_.occluders, frame.last_visible, scene_.object_bounds, choice);
  }
  const bool few = chosen.size() < settings_.count / 2;
  if (!frame.jumped && !(few && frames_since_search_ >= frames_between_searches_)) {
    ++frames_since_search_;
    return chosen;
  }
  candidates_.clear();
  CullStats ignored;
  search_.run(frame.frustum, {.temporal_coherence = false, .filter = frame.filter}, seeEverything(), ignored,
              candidates_);
  const std::size_t before = chosen.size();
  chosen = chooser_.choose(frame.view, *scene_.occluders, candidates_, scene_.object_bounds, choice);
  frames_between_searches_ = chosen.size() > 2 * before ? 0 : kSearchPause;
  frames_since_search_ = 0;
  return chosen;
}

}  // namespace sightline::culling
