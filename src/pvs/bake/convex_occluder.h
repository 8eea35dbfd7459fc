#pragma once

// Potential occluders of the bake: convex bodies, and convex polygons that are no faces of bodies.
//
// What one convex set C hides from all corners of a convex region, it hides from every point of the region
// (Saona-Vazquez, Navazo, Brunet 1999, theorem 1). C must be the same for all viewpoints. Polygons and
// triangles lie apart by up to Occluder::slack, so the sets used here are drawn in by
//
//   margin = 2 slack + how far corners lie off their planes + 2^-44 of the coordinates' size.
//
//   A polygon P  is shrunk about its centre until each edge has moved inwards by the margin. Of it two sets
//                are made, one the margin before P's plane, one the margin behind; what both hide is hidden.
//                A line that crosses both stays farther than slack from P's boundary, and its ends are
//                farther than slack from P's plane, so it really meets P's triangles (docs/conservative.md).
//   A body       is shrunk about its centre until each corner is behind every face by the margin. A line that
//                comes from outside to any point there crosses the closed surface of the triangles.
//
// Shrinking is a homothety: corners, edges and faces stay as they are, whatever meets in a corner.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"

namespace sightline::pvs {

// An edge of an outline.
struct ConvexEdge {
  Vec3d from, to;  // scene space
};

// An edge of the set drawn in; of a polygon, not yet moved across its plane. Counter-clockwise around its
// left face as seen from outside, clockwise around its right one.
struct DrawnEdge {
  Vec3d from, along;                 // scene space; `along` leads to the other end
  std::uint8_t left = 0, right = 0;  // body: numbers of faces within the body
};

// A face of a body, or the polygon.
struct DrawnFace {
  Plane plane;  // not drawn in; unit normal, outwards (polygon: to its front); scene space
  // All corners x of the face drawn in have least <= dot(plane.normal, x - base) <= most, rounding included.
  Vec3d base;
  double least = 0.0, most = 0.0;
};

struct ConvexOccluder {
  std::uint32_t first_edge = 0, first_face = 0;  // into ConvexOccluders
  std::uint16_t edge_count = 0, face_count = 0;  // polygon: one face
  bool body = false;
  bool double_sided = false;  // polygon
  OccluderId id;              // of the polygon; of the body's first face
  ObjectId object;
  Box bounds;           // of the corners, not drawn in
  double margin = 0.0;  // metres
  double area = 0.0;    // of its largest face, square metres
  double volume = 0.0;  // cubic metres; polygon: 0
  double size = 0.0;    // bounds |x| + |y| + |z| of all its points, and the margin
};

class ConvexOccluders {
 public:
  // Leaves out what is not clearly larger than its margin. A body that is too thin leaves its faces.
  explicit ConvexOccluders(const OccluderSet& set);

  std::uint32_t size() const { return static_cast<std::uint32_t>(occluders_.size()); }
  const ConvexOccluder& operator[](std::uint32_t i) const { return occluders_[i]; }
  std::span<const DrawnEdge> edgesOf(const ConvexOccluder& o) const {
    return std::span(edges_).subspan(o.first_edge, o.edge_count);
  }
  std::span<const DrawnFace> facesOf(const ConvexOccluder& o) const {
    return std::span(faces_).subspan(o.first_face, o.face_count);
  }

 private:
  bool addPolygon(const OccluderSet& set, OccluderId id);
  bool addBody(const OccluderSet& set, const OccluderBody& body);

  std::vector<ConvexOccluder> occluders_;  // by area, largest first; ties by id
  std::vector<DrawnEdge> edges_;
  std::vector<DrawnFace> faces_;
};

// Whether an occluder may be used for a convex region, given by all its corners (scene space): a plane
// separates them, all viewpoints are before one and the same side of a polygon that hides, and all of the
// occluder lies farther than near_distance from all of the region.
bool separated(const ConvexOccluders& all, const ConvexOccluder& occluder, std::span<const Vec3d> corners,
               double near_distance);

}  // namespace sightline::pvs
