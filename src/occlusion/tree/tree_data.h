#pragma once

#include <vector>

#include "src/occlusion/tree/occlusion_volume.h"
#include "src/occlusion/tree/polygon_split.h"

namespace sightline::occlusion {

// What a branch of the tree leads to: a node, or one of three kinds of leaves.
struct Link {
  std::int32_t value = -1;

  static constexpr Link out() { return {-1}; }      // a region in no shadow
  static constexpr Link outside() { return {-2}; }  // a region outside the view's frustum
  static constexpr Link node(std::size_t i) { return {static_cast<std::int32_t>(i)}; }
  static constexpr Link shadow(std::size_t leaf) { return {-3 - static_cast<std::int32_t>(leaf)}; }
  bool isNode() const { return value >= 0; }
  bool isOut() const { return value == -1; }
  bool isOutside() const { return value == -2; }
  std::size_t nodeIndex() const { return static_cast<std::size_t>(value); }
  std::size_t leafIndex() const { return static_cast<std::size_t>(-3 - value); }
};

// The largest number of nodes on a path, which bounds what queries keep for a path. Neither queries nor
// building use recursion, so the size of the thread's stack does not matter.
inline constexpr std::uint32_t kMaxTreeDepth = 1500;

// A shadow plane; the occluder that made it lies behind. Positions are relative to the eye.
struct TreeNode {
  Plane plane;             // unit normal
  double tolerance = 0.0;  // VolumeBuilder::tolerances, and a little more where repeated
  bool repeated = false;   // the plane or its like is on the path: all that comes here counts as behind
  Link front, back;
};

// A leaf in shadow: the cone of a fragment of an occluder, cut out by the planes on the path to the leaf.
struct ShadowLeaf {
  std::uint32_t volume = 0;
  std::uint32_t first_corner = 0, corner_count = 0;  // the fragment's, in TreeData::corners
};

// Returns the distance in metres from the plane of a shared edge within which a box is tested on both sides:
// the width of the shared edge, and more than the rounding of all that is computed for the box. reach: how
// far the box reaches from the eye, metres. The width is the same for all planes that a box intersects, so
// that the overlap at one plane is not taken for more at another.
inline double overlapWidth(double tolerance, double reach, const Eye& eye, double on_plane_scale) {
  return tolerance * (eye.orthographic ? 1.0 : reach) + 16.0 * kOnPlane * (reach + on_plane_scale);
}

struct TreeData {
  Link root = Link::out();
  std::vector<TreeNode> nodes;
  std::vector<PlaneRef> node_plane;  // by node, for building
  std::vector<ShadowLeaf> leaves;
  std::vector<Vec3d> corners;
  VolumeBuilder volumes;
  double on_plane_scale = 0.0;  // see PolygonStack::split
  std::uint32_t depth = 0;
  // The first so many nodes are the side planes of the frustum in its order: node i + 1 is behind node i, and
  // outside() is in front of each. 0 without clip_to_frustum.
  std::uint32_t frustum_nodes = 0;

  // The root of the tree of the occluders' own planes.
  Link belowFrustum() const { return frustum_nodes == 0 ? root : nodes[frustum_nodes - 1].back; }
};

}  // namespace sightline::occlusion
