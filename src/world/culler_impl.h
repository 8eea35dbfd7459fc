#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sightline/world/world_culler.h"
#include "src/world/id_bits.h"
#include "src/world/world_data.h"
#include "src/world/world_eye.h"

namespace sightline {

struct WorldCuller::Impl {
  explicit Impl(const WorldCullerSettings& given) : settings(given) { eyes.emplace_back(given); }

  void cull(const world::WorldData& data, std::span<const View> given);
  bool takeViews(std::span<const View> given);
  void keepEverything(const world::WorldData& data);

  WorldCullerSettings settings;
  std::vector<world::WorldEye> eyes;  // at least one; more than there are views after a cull() of more
  std::vector<View> views;            // usable ones
  bool has_culled = false;
  WorldCullStats counts;
  world::IdBits kept, last_kept;
  std::vector<InstanceId> visible, appeared, disappeared;
  std::uint64_t last_version = 0;  // of the world
  Plane clip_plane;
  std::vector<std::pair<SetsId, VisibleSets*>> sets;
};

}  // namespace sightline
