#pragma once

// Shared by both builders: the items, and the flat array of nodes that grows in depth-first order.

#include <span>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"

namespace sightline::hierarchy {

// The box of an object, or of its part in a region of a kd-tree.
struct Item {
  Box box;
  ObjectId object;
};

class FlatWriter {
 public:
  FlatWriter(Hierarchy& hierarchy, std::span<const std::uint32_t> object_cost)
      : hierarchy_(hierarchy), object_cost_(object_cost) {}

  // Appends a leaf with these items, of which there is at least one.
  void leaf(std::span<const Item> items, std::uint32_t level);
  // Appends an inner node; its left subtree must be appended next, then its right one, then finish(it).
  NodeIndex beginInner(std::span<const Item> items, std::uint32_t level);
  void finish(NodeIndex inner);

 private:
  HierarchyNode enclosing(std::span<const Item> items) const;

  Hierarchy& hierarchy_;
  std::span<const std::uint32_t> object_cost_;
};

struct BuildLimits {
  std::uint32_t max_leaf_objects = 1;
  std::uint32_t max_depth = 1;
  double median_window = 0.0;
};

// Each appends the subtree of the items (at least one, well-formed boxes) to the writer.
void buildKdTree(FlatWriter& writer, std::vector<Item> items, const BuildLimits& limits, std::uint32_t level);
void buildBvh(FlatWriter& writer, std::span<Item> items, const BuildLimits& limits, std::uint32_t level);

}  // namespace sightline::hierarchy
