#pragma once

// Finds the objects in a shadow with a tree of boxes, laid out to test several boxes at a time.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "src/pvs/bake/cell_region.h"
#include "src/pvs/bake/convex/shadow.h"
#include "src/pvs/bake/runs.h"

namespace sightline::pvs {

// The boxes of a tree, with the children of a node side by side. Nodes with few children are dissolved into
// their parent to fill vector lanes; leaves are those of the tree. Immutable.
class ShadowTree {
 public:
  // reach: see makeShadow. For shadows of up to that reach, what is hidden depends on the leaves' boxes alone
  // and not on the nodes above them, also where rounding decides.
  explicit ShadowTree(const BoxTreeView& tree, double reach = 0.0);

  // Appends the objects that the shadow hides, as ascending runs that are not empty and do not touch each
  // other. An object is hidden if its leaf's closed box is. Boxes that are empty or not finite are never
  // hidden. Every instruction set gives the same runs.
  void hiddenBy(const Shadow& shadow, std::vector<ObjectRun>& runs) const;

  struct Node {
    std::uint32_t first_child = 0, child_count = 0;  // indices of nodes
    ObjectRun objects;
  };
  // Node 0 is the root; there is none without boxes.
  std::span<const Node> nodes() const { return arrays_.nodes; }
  // Bits of those of the nodes first ... first + count - 1, at most kGroup, that each of the shadows hides,
  // with all that is below them.
  std::uint32_t hidden(std::span<const Shadow> shadows, std::uint32_t first, std::uint32_t count) const;
  static constexpr std::uint32_t kGroup = 8;
  // False if something below the node is empty or not finite, and so is its box.
  bool mayBeHidden(std::uint32_t node) const { return std::isfinite(arrays_.hx[node]); }
  Vec3d centreOf(std::uint32_t node) const { return {arrays_.cx[node], arrays_.cy[node], arrays_.cz[node]}; }
  CellBox boxOf(std::uint32_t node) const {
    const Vec3d half{arrays_.hx[node], arrays_.hy[node], arrays_.hz[node]};
    return {centreOf(node) - half, centreOf(node) + half};
  }
  // False if no leaf below the node may be hidden.
  bool mayHoldHidden(std::uint32_t node) const { return lowest_[node].min.x <= lowest_[node].max.x; }
  // Bounds of corner i of the boxes of all leaves below a node that may be hidden, of which there must be
  // some. The bits of i are those of CellBox::corner.
  CellBox cornersBelow(std::uint32_t node, std::uint32_t i) const {
    const CellBox &low = lowest_[node], &high = highest_[node];
    CellBox bounds;
    for (int axis = 0; axis < 3; ++axis) {
      const CellBox& side = ((i >> axis) & 1u) != 0 ? high : low;
      bounds.min[axis] = side.min[axis];
      bounds.max[axis] = side.max[axis];
    }
    return bounds;
  }
  // The leaf of an object, by its place in BoxTree::objects.
  std::uint32_t leafAt(std::uint32_t position) const { return leaf_of_[position]; }

  // Read by the vector code. Node 0 is the root. Padded, so that a whole vector can be read starting at any
  // node.
  struct Arrays {
    std::vector<Node> nodes;
    // A node's box: its centre, and its half extents rounded up.
    std::vector<double> cx, cy, cz, hx, hy, hz;
    // Half extents of the region in which the innermost points of its leaves' boxes may lie: those of the
    // box, less twice the minimum half extents of the leaves below; for a leaf, its own, negated. If no point
    // of this region is behind a plane, no leaf is.
    std::vector<double> rx, ry, rz;
  };

 private:
  // from: by node, its node in the tree.
  void findCorners(const BoxTreeView& tree, std::span<const std::uint32_t> from);

  Arrays arrays_;
  // By node: bounds of the least and of the greatest points of the boxes below that may be hidden.
  std::vector<CellBox> lowest_, highest_;
  std::vector<std::uint32_t> leaf_of_;  // by place in BoxTree::objects: its node
};

}  // namespace sightline::pvs
