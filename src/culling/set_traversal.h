#pragma once

// Hierarchical frustum culling of a potentially visible set.
//
// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.3.
// Differs from the paper in: nodes above those of the set are tested too, so that one test can reject many of
// them.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/math/frustum.h"
#include "src/culling/object_bits.h"

namespace sightline::culling {

class SetTraversal {
 public:
  explicit SetTraversal(std::size_t object_count) : visible_(object_count) {}

  // set: nodes of the tree, in the form of VisibleSet::nodes. Appends the objects below them whose boxes are
  // not outside the frustum to out, in ascending order, and adds to the counts of stats.
  void run(const Frustum& frustum, const BoxTreeView& tree, std::span<const std::uint32_t> set,
           CullStats& stats, std::vector<ObjectId>& out);

 private:
  struct Entry {
    std::uint32_t node;
    // The range of the set's nodes at or below this node; an empty range stands for everything below it.
    std::uint32_t begin, end;
    std::uint8_t planes;  // bit i is set if the frustum's plane i cuts the node
  };

  void visit(const Entry& entry, const Frustum& frustum, const BoxTreeView& tree,
             std::span<const std::uint32_t> set, CullStats& stats);
  void keep(std::span<const ObjectId> objects);
  void pushChildren(const Entry& parent, std::uint8_t planes, const BoxTreeView& tree,
                    std::span<const std::uint32_t> set);

  ObjectBits visible_;
  std::vector<Entry> stack_;
};

}  // namespace sightline::culling
