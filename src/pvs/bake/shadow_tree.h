#pragma once

// Which objects of a scene lie in a shadow: a tree of boxes, laid out to be asked several boxes at a time.

#include <cstdint>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "src/pvs/bake/runs.h"
#include "src/pvs/bake/shadow.h"

namespace sightline::pvs {

// The boxes of a tree, the children of a node side by side. Nodes of few children are dissolved in their
// parent, so that vector lanes are filled; leaves are those of the tree. Does not change once made.
class ShadowTree {
 public:
  explicit ShadowTree(const BoxTreeView& tree);

  // Appends the objects that the shadow hides: runs ascending, neither empty nor touching each other. An
  // object is hidden where its leaf's box is, closed. Boxes that are empty or not finite are never hidden.
  // Every instruction set gives the same runs.
  void hiddenBy(const Shadow& shadow, std::vector<ObjectRun>& runs) const;

  struct Node {
    std::uint32_t first_child = 0, child_count = 0;  // numbers of nodes
    ObjectRun objects;
  };
  // Read by the vector code. Node 0 is the root. Padded, so that a whole vector may be read from any node on.
  struct Arrays {
    std::vector<Node> nodes;
    // A node's box: its centre and half extents, rounded up.
    std::vector<double> cx, cy, cz, hx, hy, hz;
    // Half extents of where the inmost points of its leaves' boxes may be: of the box, less twice the least
    // half extents of leaves below; a leaf's own, negated. Beyond a plane that all of this does not reach,
    // no leaf is behind it.
    std::vector<double> rx, ry, rz;
  };

 private:
  Arrays arrays_;
};

}  // namespace sightline::pvs
