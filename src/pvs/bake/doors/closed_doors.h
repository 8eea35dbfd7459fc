#pragma once

// What doors hide from a cell while they are closed, of what is seen while all of them are open.
//
// A claim about a group of closed doors holds as well while more doors are closed, for what is closed besides
// only blocks more lines of sight. So what a set of closed doors hides is at least the union over the groups
// that are part of it (docs/conservative.md, "Doors").

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "src/pvs/bake/convex/samples.h"
#include "src/pvs/bake/object_mask.h"
#include "src/pvs/bake/seen_sets.h"
#include "src/pvs/bake/surfaces/node_occlusion.h"

namespace sightline::pvs {

// Use by one thread at a time.
class ClosedDoors {
 public:
  // Both must outlive this.
  ClosedDoors(const BakeScene& scene, SampleStore& samples);

  // Sets what each group hides of the finished sets of a cell and of the sides of its plane. search: single
  // convex occluders count that intersect this box; surfaces do wherever they are. A set of viewers who see
  // nothing becomes that of all doors, so that only those of no viewers are empty.
  void hide(const CellBox& cell, const CellBox& search, CellSets& sets);

 private:
  // A region of which some is known: `doors` holds what the groups hide from more than the region.
  struct Region {
    std::span<const Vec3d> corners;
    CellBox box;               // around the corners
    bool ask_surfaces = true;  // false: they hide from the box no more than is known
  };
  void hideFrom(const Region& region, const CellBox& search, Runs& seen, DoorRuns& doors);
  // What of the seen objects known_ holds, or the group hides by being asked about. Takes time for each
  // object of the scene. Requires seen_doors_.
  Runs hiddenBy(std::uint32_t group, const Region& region, const CellBox& search, const Runs& seen);
  // Sets seen_doors_ to the doors of the group that may be seen.
  void findSeenDoors(std::uint32_t group, const Runs& seen);
  // Adds to hidden_ what a door's own convex occluders hide.
  void hideByConvex(ObjectId door, const Region& region, const CellBox& search);
  // Adds to hidden_ what surfaces hide of a node while the group is closed, where a line of sight may meet
  // one of its doors that are seen.
  void hideBelow(std::uint32_t node, std::uint32_t group, const CellBox& region);

  const BakeScene& scene_;
  SampleStore& samples_;
  std::deque<NodeOcclusion> surfaces_;  // by group; none if only convex occluders hide
  // Scratch for the current region and group.
  std::vector<ObjectId> seen_doors_;
  ObjectMask hidden_;
  Runs common_, left_;
  Runs known_;  // hidden by more than the region, and by the groups within this one
};

}  // namespace sightline::pvs
