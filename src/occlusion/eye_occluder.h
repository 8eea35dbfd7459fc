#pragma once

// An occluder as one eye sees it: whether it can be used from there, with which margins, and which of its
// edges are shared. Every occlusion structure starts from it.

#include <cstdint>
#include <optional>

#include "sightline/geometry/tolerance.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"
#include "src/scene/usable_view.h"

namespace sightline::occlusion {

// The eye as occluders need it: a point, or a direction for orthographic views.
struct Eye {
  Vec3d position;
  Vec3d forward;  // along which depths are measured
  Vec3d sight;    // orthographic: the direction of the lines of sight, scene::sightDirection()
  double near = 0.0;
  bool orthographic = false;

  Eye() = default;
  // view: one that validate() accepts.
  explicit Eye(const View& view)
      : position(view.eye),
        forward(view.forward),
        sight(view.orthographic ? scene::sightDirection(view) : view.forward),
        near(view.z_near),
        orthographic(view.orthographic) {}

  // Returns the plane through the eye and the line from p to q, with unit normal, such that a polygon with
  // the edge p -> q, counter-clockwise as seen from the eye, lies behind it. sine: becomes that of the angle
  // that the edge spans (1 for orthographic eyes).
  Plane shadowPlane(const Vec3d& p, const Vec3d& q, double& sine) const;
};

// Planes and positions are relative to the eye.
struct EyeOccluder {
  OccluderId id;
  bool flipped = false;      // seen from the back of a double-sided polygon
  Plane support;             // the polygon's plane, unit normal towards the eye
  double inset = 0.0;        // metres by which open edges are drawn in
  double deviation = 0.0;    // metres, Occluder::slack
  double depth_slack = 0.0;  // metres by which a point must be behind it, in addition to kDepthMargin
  double reach = 0.0;        // largest l1Norm() of a corner, metres
  double clip_depth = 0.0;   // metres along forward: what is nearer hides nothing
  double nearest = 0.0;      // depth of its nearest corner, metres along forward
  double grazing = 0.0;      // a lower bound of the sine of the angle at which it is seen
  Vec3d centroid;            // of the unclipped polygon
};

// Returns the metres by which an occluder's outline is drawn in, in its plane: as far as a point that is off
// by the slack may appear to move there, with room for sharp corners of three degrees. slack, reach: metres,
// as in EyeOccluder.
inline double outlineInset(double slack, double reach, double grazing) {
  return (32.0 * slack + kEdgeMargin * reach) / grazing;
}
// Returns EyeOccluder::depth_slack: at a grazing angle, what kEdgeMargin allows sideways becomes depth.
inline double depthSlack(double slack, double reach, double grazing) {
  return (4.0 * slack + kDepthMargin * 0x1p-8 * reach) / grazing;
}
// Returns EyeOccluder::clip_depth.
inline double clipDepth(double near, double depth_slack, double reach) {
  return near + depth_slack + kDepthMargin * (near + reach);
}

// Returns the occluder without its inset, which depends on the structure. Nothing where the occluder cannot
// be used from here, because it is seen from behind, edge-on, or lies wholly before the near plane.
std::optional<EyeOccluder> faceOccluder(const Eye& eye, const OccluderSet& set, OccluderId id);
// Whether a polygon that is drawn in by `inset` metres keeps its shape.
bool keepsShape(const Occluder& occluder, double inset);

// Returns the occluder with the inset that shadow planes through its edges need; nothing also where that
// inset is too large.
std::optional<EyeOccluder> seeOccluder(const Eye& eye, const OccluderSet& set, OccluderId id);

// An edge as the eye sees it, the polygon on its left, relative to the eye.
struct Outline {
  Vec3d from, to;
  std::uint32_t edge = 0;  // into OccluderSet::edges
};
// side: 0 to vertex_count - 1, counter-clockwise as the eye sees it.
Outline outlineOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& occluder, std::uint32_t side);

// An edge at which other occluders may go on: the shadow plane through the line that they share.
struct SharedEdge {
  Plane plane;           // relative to the eye; its side follows from the direction of the line
  bool flipped = false;  // the line runs against the outline
  // How far from the plane the mesh's own edge may appear to lie, see VolumeBuilder::tolerances.
  double tolerance = 0.0;

  // The plane with the occluder behind it.
  Plane oriented() const { return flipped ? plane.flipped() : plane; }
};
// Nothing where no occluder adjoins the edge, or where it is badly conditioned from here.
std::optional<SharedEdge> sharedEdgeOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& occluder,
                                       const Outline& outline);

// Returns the mesh edges of an edge, a bit each from bit 0 on.
inline std::uint64_t allMeshEdges(const OccluderEdge& edge) {
  return edge.mesh_edge_count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge.mesh_edge_count) - 1;
}

// Returns those mesh edges beyond which no active occluder goes on; at all others the edge is watertight.
// oriented: SharedEdge::oriented() of the edge. centroid_of(id): the centroid of an active occluder relative
// to the eye; null for all others.
template <typename CentroidOf>
std::uint64_t openMeshEdges(const OccluderSet& set, const OccluderEdge& edge, const Plane& oriented,
                            CentroidOf&& centroid_of) {
  std::uint64_t open = allMeshEdges(edge);
  for (const EdgeNeighbour& neighbour : set.neighboursOf(edge)) {
    const Vec3d* centroid = centroid_of(neighbour.occluder);
    if (centroid != nullptr && oriented.evaluate(*centroid) > 0.0) {
      open &= ~(std::uint64_t{1} << neighbour.mesh_edge);
    }
  }
  return open;
}

}  // namespace sightline::occlusion
