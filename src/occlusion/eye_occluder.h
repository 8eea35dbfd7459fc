#pragma once

// An occluder as one eye sees it: whether it can be used from there, with which margins, and which of its
// edges may be sealed. What every occlusion structure starts from.

#include <cstdint>
#include <optional>

#include "sightline/geometry/tolerance.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"

namespace sightline::occlusion {

// The eye as occluders need it: a point, or a direction for orthographic views. Everything is relative to it.
struct Eye {
  Vec3d position;
  Vec3d forward;
  double near = 0.0;
  bool orthographic = false;

  Eye() = default;
  explicit Eye(const View& view)
      : position(view.eye), forward(view.forward), near(view.near), orthographic(view.orthographic) {}

  // A plane through the eye and the line from p to q, unit normal, such that a polygon with the edge p -> q,
  // counter-clockwise as seen from the eye, lies behind it. sine: of the angle the edge spans (1 for
  // orthographic eyes).
  Plane shadowPlane(const Vec3d& p, const Vec3d& q, double& sine) const;
};

struct EyeOccluder {
  OccluderId id;
  bool flipped = false;      // seen from the back of a double-sided polygon
  Plane support;             // of the polygon, unit normal towards the eye, relative to the eye
  double inset = 0.0;        // metres by which open edges are drawn in
  double deviation = 0.0;    // metres, Occluder::slack
  double depth_slack = 0.0;  // metres that a point must be behind it, in addition to kDepthMargin
  double reach = 0.0;        // largest magnitude of a corner, relative to the eye
  double clip_depth = 0.0;   // metres along forward: what is nearer hides nothing
  double nearest = 0.0;      // depth of its nearest corner, metres along forward
  double grazing = 0.0;      // sine of the angle at which it is seen, at least
  Vec3d centroid;            // of the unclipped polygon, relative to the eye
};

// Metres in its plane by which the outline of an occluder is drawn in: what a point that is off by the slack
// may appear to move there, with room for sharp corners of three degrees. slack, reach: metres, as in
// EyeOccluder.
inline double outlineInset(double slack, double reach, double grazing) {
  return (32.0 * slack + kEdgeMargin * reach) / grazing;
}
// EyeOccluder::depth_slack: what kEdgeMargin allows sideways becomes depth at a grazing angle.
inline double depthSlack(double slack, double reach, double grazing) {
  return (4.0 * slack + kDepthMargin * 0x1p-8 * reach) / grazing;
}
// EyeOccluder::clip_depth.
inline double clipDepth(double near, double depth_slack, double reach) {
  return near + depth_slack + kDepthMargin * (near + reach);
}

// Without the inset, which depends on the structure. Nothing where the occluder is of no use from here: seen
// from behind, edge-on, wholly before the near plane.
std::optional<EyeOccluder> faceOccluder(const Eye& eye, const OccluderSet& set, OccluderId id);
// Whether a polygon that is drawn in by so much keeps its shape.
bool keepsShape(const Occluder& occluder, double inset);

// With the inset that shadow planes through its edges need; nothing also where that is too large.
std::optional<EyeOccluder> seeOccluder(const Eye& eye, const OccluderSet& set, OccluderId id);

// An edge as the eye sees it, the polygon on its left, relative to the eye.
struct Outline {
  Vec3d from, to;
  std::uint32_t edge = 0;  // into OccluderSet::edges
};
// side: 0 to vertex_count - 1, counter-clockwise as the eye sees it.
Outline outlineOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& occluder, std::uint32_t side);

// A seam that may be sealed: the shadow plane through its line.
struct SharedEdge {
  Plane plane;             // relative to the eye, as the line is directed
  bool flipped = false;    // the line runs against the outline
  double tolerance = 0.0;  // how far the mesh's seam may appear from the plane (VolumeBuilder::tolerances)

  // The occluder lies behind it.
  Plane oriented() const { return flipped ? plane.flipped() : plane; }
};
// Nothing where nothing adjoins the edge or it is badly conditioned from here.
std::optional<SharedEdge> sharedEdgeOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& occluder,
                                       const Outline& outline);

// The mesh edges of an edge, a bit each, from 0.
inline std::uint64_t allElements(const OccluderEdge& edge) {
  return edge.chain >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge.chain) - 1;
}

// Those of them beyond which none of the occluders begins that are in use; beyond the others the seam lets
// nothing through. oriented: of the edge's seam. centroid_of(id): of an occluder in use, relative to the eye,
// or null.
template <typename CentroidOf>
std::uint64_t openElements(const OccluderSet& set, const OccluderEdge& edge, const Plane& oriented,
                           CentroidOf&& centroid_of) {
  std::uint64_t open = allElements(edge);
  for (const EdgeCover& cover : set.coversOf(edge)) {
    const Vec3d* centroid = centroid_of(cover.occluder);
    if (centroid != nullptr && oriented.evaluate(*centroid) > 0.0) {
      open &= ~(std::uint64_t{1} << cover.element);
    }
  }
  return open;
}

}  // namespace sightline::occlusion
