#pragma once

// The sets of one cell, as runs of objects.

#include <cstdint>
#include <optional>
#include <vector>

#include "src/pvs/bake/bake_scene.h"

namespace sightline::pvs {

// What the doors of a group hide while all of them are closed, of what is seen while all doors are open. It
// contains what the groups within this one hide.
struct HiddenByDoors {
  std::uint32_t group = 0;  // into DoorGroups::groups
  Runs hidden{};            // not empty
};
// They are sorted by group; groups that hide nothing are left out.
using DoorRuns = std::vector<HiddenByDoors>;

struct CellSets {
  Runs whole{};  // seen from anywhere in the cell
  std::optional<CellPlane> plane{};
  Runs front{}, back{};  // with a plane only: seen from its front, from its back
  DoorRuns whole_doors{}, front_doors{}, back_doors{};
};

// Triangles compared with the budget: those of the side that sees more. Viewers between the sides do not
// count, as they are there only briefly.
std::uint64_t trianglesOf(const BakeScene& scene, const CellSets& sets);

// The corners of the regions in front of a cell's plane and behind it, as far as they are for viewers.
struct SideCorners {
  std::vector<Vec3d> front, back;

  SideCorners(const CellBox& box, const CellPlane& plane, double side_margin)
      : front(cornersBefore(box, plane.normal, plane.front - 2.0 * side_margin)),
        back(cornersBefore(box, -plane.normal, -plane.back - 2.0 * side_margin)) {}
};

}  // namespace sightline::pvs
