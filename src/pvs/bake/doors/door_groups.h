#pragma once

// The doors of a bake and the groups in which they are closed.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/scene/scene.h"

namespace sightline::pvs {

struct DoorGroups {
  std::vector<ObjectId> all{};  // ascending
  // The doors of each group, ascending: each door by itself, the groups that were asked for, and all doors.
  // Each group is there once, and after all groups that are part of it.
  std::vector<std::vector<ObjectId>> groups{};

  bool isDoor(ObjectId object) const;
  // Whether all doors of the group `part` belong to the group `whole` as well.
  bool isWithin(std::uint32_t part, std::uint32_t whole) const;
};

// given: BakeSettings::doors.
DoorGroups doorGroupsOf(std::span<const std::vector<ObjectId>> given);
// What is wrong with them; empty if nothing is.
std::string problemWithDoors(const SceneView& scene, std::span<const std::vector<ObjectId>> given);

// The scene's objects with these doors closed and all others open: an open door is no occluder.
std::vector<Object> withClosed(const SceneView& scene, const DoorGroups& doors,
                               std::span<const ObjectId> closed);

}  // namespace sightline::pvs
