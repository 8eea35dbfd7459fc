#pragma once

#include <vector>

#include "src/occlusion/occlusion_volume.h"
#include "src/occlusion/polygon_split.h"

namespace sightline::occlusion {

// Where a branch of the tree leads: to a node, or to one of three kinds of leaves.
struct Link {
  std::int32_t value = -1;

  static constexpr Link out() { return {-1}; }      // nothing there hides
  static constexpr Link outside() { return {-2}; }  // outside the view's frustum: says nothing
  static constexpr Link node(std::size_t i) { return {static_cast<std::int32_t>(i)}; }
  static constexpr Link shadow(std::size_t leaf) { return {-3 - static_cast<std::int32_t>(leaf)}; }
  bool isNode() const { return value >= 0; }
  bool isOut() const { return value == -1; }
  bool isOutside() const { return value == -2; }
  std::size_t nodeIndex() const { return static_cast<std::size_t>(value); }
  std::size_t leafIndex() const { return static_cast<std::size_t>(-3 - value); }
};

// Nodes on a path at most, which bounds what queries keep for a path. They use no recursion, nor does
// building, so the size of the thread's stack does not matter.
inline constexpr std::uint32_t kMaxTreeDepth = 1500;

// A shadow plane; the occluder that made it lies behind. Positions are relative to the eye.
struct TreeNode {
  Plane plane;             // unit normal
  double tolerance = 0.0;  // VolumeBuilder::tolerances
  bool repeated = false;   // stands on the path already: all that comes here counts as behind
  Link front, back;
};

// A leaf in shadow: the cone of a fragment of an occluder, as cut out by the planes on the path to it.
struct ShadowLeaf {
  std::uint32_t volume = 0;
  std::uint32_t first_corner = 0, corner_count = 0;  // of the fragment, into TreeData::corners
};

// How near to a seam's plane, in metres, a box that reaches so far from the eye is looked at on both sides:
// the seam's own width, and more than the rounding of all that is computed for the box. The same for all
// planes that a box meets, so that what is overlap at one is not taken for more at another.
inline double overlapWidth(double tolerance, double reach, const Eye& eye, double on_plane_scale) {
  return tolerance * (eye.orthographic ? 1.0 : reach) + 16.0 * kOnPlane * (reach + on_plane_scale);
}

struct TreeData {
  Link root = Link::out();
  std::vector<TreeNode> nodes;
  std::vector<PlaneRef> node_plane;  // of each node, for building
  std::vector<ShadowLeaf> leaves;
  std::vector<Vec3d> corners;
  VolumeBuilder volumes;
  double on_plane_scale = 0.0;  // see PolygonStack::split
  std::uint32_t depth = 0;
  // The first nodes, one a side plane of the frustum in its order, if the tree has them: node i + 1 is behind
  // node i, and outside() in front of each.
  std::uint32_t frustum_nodes = 0;

  // Where the occluders' own planes begin.
  Link belowFrustum() const { return frustum_nodes == 0 ? root : nodes[frustum_nodes - 1].back; }
};

}  // namespace sightline::occlusion
