#pragma once

// A hierarchy with many children a node, whose boxes lie side by side: for tests of many boxes at once.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"

namespace sightline::hierarchy {

// The largest number of children of a node, except of one made from a leaf with more objects.
inline constexpr std::uint32_t kWideChildren = 16;

// Its children are a range of WideHierarchy::boxes: first the nodes, the ones with most triangles first, then
// the objects. Nodes that are its children are numbered one after the other, in the same order.
struct WideNode {
  std::uint32_t first_child = 0;  // in WideHierarchy::boxes
  std::uint32_t child_end = 0;
  std::uint32_t first_node = 0;                    // the number of its first child that is a node
  std::uint32_t first_object = 0, object_end = 0;  // what is below it, in Hierarchy::objects
  std::uint32_t node_count = 0;                    // children that are nodes
  std::uint32_t cost = 0;                          // triangles below it, at most HierarchyNode::kMaxCost
};
static_assert(sizeof(WideNode) == 28);

// Made by collapsing a binary hierarchy; the root is node 0. Some 36 bytes an object. Boxes that are not well
// formed are children like any other.
struct WideHierarchy {
  std::vector<WideNode> nodes;   // empty for a scene without objects
  std::vector<Box> boxes;        // of children: a node's bounds, or the object's own box
  std::vector<ObjectId> object;  // of the child with the same number, where that is an object

  std::size_t bytes() const {
    return nodes.size() * sizeof(WideNode) + boxes.size() * sizeof(Box) + object.size() * sizeof(ObjectId);
  }
};

// Greedily: the child with the largest surface area is opened first, until there are kWideChildren. Subtrees
// of so few objects are never cut. object_bounds: as many boxes as there are objects.
WideHierarchy collapse(const Hierarchy& hierarchy, std::span<const Box> object_bounds);

}  // namespace sightline::hierarchy
