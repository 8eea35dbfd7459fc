#pragma once

// What was visible of late: hysteresis and fades over the answers of a WorldCuller.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"

namespace sightline {

struct VisibleHistorySettings {
  double hold_s = 0.5;      // an instance is held for so long after it was last visible
  double fade_in_s = 0.25;  // and becomes opaque within so long after it appeared; 0: at once
};

// Holds what was visible a moment ago, so that it is not dropped and fetched again whenever something passes
// before it (textures, skeletons, sounds, finer levels of detail), and fades in what appears. It adds to what
// may be seen and takes nothing away. Use by one thread at a time.
class VisibleHistory {
 public:
  explicit VisibleHistory(const VisibleHistorySettings& settings = {}) : settings_(settings) {}

  // Call this after each cull() of the same culler, and start with a new history when that was reset.
  // seconds: since the last call.
  void update(const World& world, const WorldCuller& culler, double seconds);

  // Visible ones, and those that were so within hold_s and are still there; ascending.
  std::span<const InstanceId> held() const { return held_; }
  // 0 to 1: rises while an instance is visible, and falls as fast while it is held. Instances that are
  // visible in the first update() have 1.
  float opacity(InstanceId instance) const {
    return instance.value < states_.size() ? states_[instance.value].opacity : 0.0f;
  }

 private:
  struct State {
    double seen_at = 0.0;  // time_s_ of the last update() in which it was visible
    float opacity = 0.0f;
    bool held = false;
    std::uint64_t born = 0;  // World::bornOf()
  };

  VisibleHistorySettings settings_;
  double time_s_ = 0.0;
  bool first_ = true;
  std::vector<State> states_;  // by InstanceId
  std::vector<InstanceId> held_, last_held_;
};

}  // namespace sightline
