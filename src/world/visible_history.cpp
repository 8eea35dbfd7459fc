#include "sightline/world/visible_history.h"

#include <algorithm>
#include <iterator>

namespace sightline {

void VisibleHistory::update(const World& world, const WorldCuller& culler, double seconds) {
  const double step = seconds > 0.0 ? seconds : 0.0;
  time_s_ += step;
  const float change =
      settings_.fade_in_s > 0.0 ? static_cast<float>(std::min(step / settings_.fade_in_s, 1.0)) : 1.0f;
  states_.resize(std::max(states_.size(), world.idBound()));
  std::swap(held_, last_held_);
  held_.clear();
  std::set_union(last_held_.begin(), last_held_.end(), culler.visible().begin(), culler.visible().end(),
                 std::back_inserter(held_));
  std::erase_if(held_, [&](InstanceId id) {
    State& state = states_[id.value];
    const std::uint64_t born = world.bornOf(id);
    if (state.born != born) {  // another instance has the id by now
      state = {.born = born};
    }
    const bool visible = culler.isVisible(id) && born != 0;
    if (visible) {
      state.seen_at = time_s_;
      state.opacity = first_ ? 1.0f : std::min(state.opacity + change, 1.0f);
    } else {
      state.opacity = std::max(state.opacity - change, 0.0f);
    }
    state.held = born != 0 && (visible || (state.held && time_s_ - state.seen_at < settings_.hold_s));
    if (!state.held) {
      state = {};
    }
    return !state.held;
  });
  first_ = false;
}

}  // namespace sightline
