#pragma once

// Whether the parts of a scene that a culler is given belong together, and what to keep where they do not.

#include <cstddef>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/math/box.h"
#include "sightline/occluders/occluder_set.h"

namespace sightline::culling {

// Whether the hierarchy is of these boxes, by ObjectId: its leaves name every object and no other one, and
// the box around the leaves that name an object holds the object's box. It takes time in proportion to both.
bool isOf(const Hierarchy& hierarchy, std::span<const Box> object_bounds);

// Whether each leaf of the tree is one object with this very box (an infinite one where the object's is not
// well formed), and each object is a leaf. A set of any other tree would hide what it does not know.
bool isOf(const BoxTreeView& tree, std::span<const Box> object_bounds);

// What a change of the scene in place nearly always changes; read in constant time.
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
