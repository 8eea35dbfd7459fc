#pragma once

// Validates hierarchies and octrees that come from outside. Errors say what is wrong, not where.

#include <cstdint>

#include "sightline/base/result.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

// Checks that there is at least one node; that subtrees nest; that boxes are not empty and enclose those
// below; that the objects of children make up their parent's; and that each object occurs once.
Status checkBoxTree(const BoxTreeView& tree);

// Checks that there is at least one node; that each leaf, and each node except the root, has exactly one
// parent; that depths, sets, planes and bounds of viewers are in range; and that the box of the root and all
// planes are finite.
Status checkOctree(const OctreeView& octree, std::uint64_t set_count);

}  // namespace sightline::pvs
