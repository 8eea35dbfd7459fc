#pragma once

// The inside of an occlusion tree as plain data, for pictures of trees and for measurements that only a
// paper's comparison needs.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// What lies on one side of a node's plane.
struct TreeBranch {
  enum class Kind : std::uint8_t {
    kLit,      // a leaf in no shadow (an out-leaf)
    kShadow,   // a leaf in the shadow of an occluder's fragment (an in-leaf)
    kOutside,  // a leaf outside the view's frustum
    kNode,
  };
  Kind kind = Kind::kLit;
  std::uint32_t index = 0;  // kNode: into TreeShape::nodes; kShadow: into TreeShape::leaves
};

// One side of a node, which tells leaves apart that are alike.
struct TreePlace {
  std::uint32_t node = 0xffffffffu;  // that: above the root
  bool front = false;

  friend bool operator==(const TreePlace&, const TreePlace&) = default;
};

// Planes and positions are relative to the eye, in metres.
struct TreeShapeNode {
  Plane plane{};          // unit normal; occluders lie behind their own shadow planes
  bool repeated = false;  // the same plane is on the path above: the edge is flagged in the paper's words
  TreeBranch front{}, back{};
};

struct TreeShapeLeaf {
  OccluderId occluder{};
  Plane support{};               // the occluder's plane, unit normal towards the eye
  std::vector<Vec3d> corners{};  // of the fragment that casts the shadow
};

struct TreeShape {
  std::vector<TreeShapeNode> nodes{};
  std::vector<TreeShapeLeaf> leaves{};
  TreeBranch root{};
  // The first so many nodes are the frustum's side planes: each has the next one behind it.
  std::uint32_t frustum_nodes = 0;

  TreeBranch at(const TreePlace& place) const {
    return place.node >= nodes.size() ? root : place.front ? nodes[place.node].front : nodes[place.node].back;
  }
  // The root of the tree of the occluders' own planes.
  TreeBranch belowFrustum() const { return frustum_nodes == 0 ? root : nodes[frustum_nodes - 1].back; }
};

// The tree that OcclusionTree builds of these occluders. modified: edges that lie in a plane of the tree
// above add no node (MOBSP in Bittner et al. 1998, section 6.1); otherwise they do (OBSP).
TreeShape shapeOfTree(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
                      bool modified);

// How the paper's own conservative test of a region (section 6.2, with the plane test of a leaf) classifies a
// box: it is compared with planes and never cut, and each leaf to which that leads counts.
// `leaves`, if not null, receives the places of all leaves that were reached.
Visibility classifyUncut(const TreeShape& tree, const Vec3d& eye, const Box& box,
                         std::vector<TreePlace>* leaves = nullptr);

}  // namespace sightline
