#pragma once

// Checks whether the parts of a scene that a culler is given belong together; if not, all objects are kept.

#include <cstddef>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/math/box.h"
#include "sightline/occluders/occluder_set.h"

namespace sightline::culling {

// Whether the hierarchy was built from these boxes (one per ObjectId): its leaves name every object and no
// other, and the box around the leaves that name an object contains the object's box. The time is linear in
// the sizes of both.
bool isOf(const Hierarchy& hierarchy, std::span<const Box> object_bounds);

// Whether each leaf of the tree is one object with exactly its box (an infinite box if the object's own is
// not well formed), and each object is a leaf. Sets of any other tree could hide objects that they do not
// know.
bool isOf(const BoxTreeView& tree, std::span<const Box> object_bounds);

// Four sizes of a scene, read in constant time. Nearly every change of a scene in place changes one of them.
struct SceneSizes {
  std::size_t nodes = 0, leaf_entries = 0, occluders = 0, corners = 0;

  static SceneSizes of(const Hierarchy& hierarchy, const OccluderSet& occluders) {
    return {hierarchy.nodes.size(), hierarchy.objects.size(), occluders.occluders.size(),
            occluders.vertices.size()};
  }
  friend bool operator==(const SceneSizes&, const SceneSizes&) = default;
};

// Appends all objects that have a box or that the hierarchy names, ascending.
void appendAll(const Hierarchy& hierarchy, std::size_t box_count, std::vector<ObjectId>& out);

}  // namespace sightline::culling
