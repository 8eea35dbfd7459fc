#pragma once

// A tree of boxes with any number of children per node. A node stands for the objects below it, so
// potentially visible sets are written as lists of nodes.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/math/box.h"

namespace sightline {

// Nodes are in depth-first order: the first child of an inner node follows it, and the next sibling of a node
// is at its `end`. The objects below a node are one range of BoxTree::objects. 40 bytes.
struct BoxNode {
  Box bounds{};                    // of all objects below
  std::uint32_t end = 0;           // one past the last node below; a leaf's own index + 1
  std::uint32_t first_object = 0;  // index into BoxTree::objects
  std::uint32_t object_count = 0;  // at least 1
  std::uint32_t triangles = 0;     // of all objects below; saturates at 2^32 - 1
};
static_assert(sizeof(BoxNode) == 40);

struct BoxTreeView {
  std::span<const BoxNode> nodes{};     // [0] is the root; empty if there are no objects
  std::span<const ObjectId> objects{};  // each object once, in the order of the leaves

  bool leaf(std::uint32_t node) const { return nodes[node].end == node + 1; }
  std::span<const ObjectId> objectsBelow(std::uint32_t node) const {
    return objects.subspan(nodes[node].first_object, nodes[node].object_count);
  }
};

struct BoxTree {
  std::vector<BoxNode> nodes{};
  std::vector<ObjectId> objects{};

  BoxTreeView view() const { return {nodes, objects}; }
};

// Builds the tree; each object is a leaf. Objects with an empty or non-finite box are leaves below the root
// with infinite boxes, and the root's box is then infinite too. object_triangles: one per box, or empty for 1
// each. The same input gives the same tree.
// Source: Goldsmith, Salmon. Automatic Creation of Object Hierarchies for Ray Tracing. IEEE CG&A 1987.
BoxTree buildBoxTree(std::span<const Box> object_bounds, std::span<const std::uint32_t> object_triangles);

}  // namespace sightline
