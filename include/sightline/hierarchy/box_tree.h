#pragma once

// A tree of boxes with any number of children a node, whose nodes stand for the objects below them: what
// potentially visible sets are written in.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/math/box.h"

namespace sightline {

// Nodes lie in depth-first order: the first child of an inner node follows it, the next sibling of any node
// is at its `end`. The objects below a node are one range of BoxTree::objects. 40 bytes.
struct BoxNode {
  Box bounds{};                    // of all objects below it
  std::uint32_t end = 0;           // one past the last node below it; a leaf's is its own number + 1
  std::uint32_t first_object = 0;  // into objects
  std::uint32_t object_count = 0;  // at least 1
  std::uint32_t triangles = 0;     // of all objects below it, at most 2^32 - 1
};
static_assert(sizeof(BoxNode) == 40);

struct BoxTreeView {
  std::span<const BoxNode> nodes{};     // [0] is the root; empty without objects
  std::span<const ObjectId> objects{};  // each once, in the order of the leaves

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

// Each object is a leaf. Objects with an empty or non-finite box are leaves below the root, with infinite
// boxes, and so is then the root's. object_triangles: as many as boxes, or empty for 1 each. The same input
// gives the same tree.
// Source: Goldsmith, Salmon. Automatic Creation of Object Hierarchies for Ray Tracing. IEEE CG&A 1987.
BoxTree buildBoxTree(std::span<const Box> object_bounds, std::span<const std::uint32_t> object_triangles);

}  // namespace sightline
