#pragma once

// Whether hierarchies and octrees that come from outside are sound. Errors say what is wrong, not where.

#include <cstdint>

#include "sightline/base/result.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

// At least one node; subtrees nest; boxes are not empty and enclose those below; the objects of children make
// up their parent's; each object once.
Status checkBoxTree(const BoxTreeView& tree);

// At least one node; each but the root, and each leaf, belongs to exactly one parent; depths, sets and planes
// are in range; the box of the root and all planes are finite.
Status checkOctree(const OctreeView& octree, std::uint64_t set_count);

}  // namespace sightline::pvs
