#pragma once

// Potential occluders of the bake: convex bodies, and convex polygons that are not faces of bodies.
//
// If one convex set C hides something from all corners of a convex region, it hides it from every point of
// the region (Saona-Vazquez, Navazo, Brunet 1999, theorem 1). C must be the same for all viewpoints. Polygons
// and triangles differ by up to Occluder::slack, so the sets used here are inset by
//
//   margin = 2 slack + how far corners lie off their planes + 2^-44 of the coordinates' size.
//
//   A polygon P  is shrunk about its centre until each edge has moved inwards by the margin. Of it two sets
//                are made, one the margin before P's plane, one the margin behind; what both hide is hidden.
//                A line that crosses both stays farther than slack from P's boundary, and its ends are
//                farther than slack from P's plane, so it really hits P's triangles (docs/conservative.md).
//   A body       is shrunk about its centre until each corner is behind every face by the margin. A line that
//                comes from outside to any point there crosses the closed surface of the triangles.
//
// Shrinking is a homothety, so it keeps corners, edges and faces, whatever joins in a corner.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"

namespace sightline::pvs {

// An edge of an outline.
struct ConvexEdge {
  Vec3d from, to;  // scene space
};

// An edge of the inset set; of a polygon, before it is moved across its plane. Counter-clockwise around its
// left face as seen from outside, clockwise around its right one.
struct DrawnEdge {
  Vec3d from, along;                 // scene space; `along` points to the other end
  std::uint8_t left = 0, right = 0;  // body: indices of faces within the body
};

// A face of a body, or the polygon.
struct DrawnFace {
  Plane plane;  // not inset; unit normal, outwards (polygon: to its front); scene space
  // All corners x of the inset face have min_height <= dot(plane.normal, x - base) <=
  // max_height, including rounding.
  Vec3d base;
  double min_height = 0.0, max_height = 0.0;
};

struct ConvexOccluder {
  std::uint32_t first_edge = 0, first_face = 0;  // indices into ConvexOccluders
  std::uint16_t edge_count = 0, face_count = 0;  // polygon: one face
  bool body = false;
  bool double_sided = false;  // polygon
  OccluderId id;              // of the polygon, or of the body's first face
  ObjectId object;
  Box bounds;           // of the corners, not inset
  double margin = 0.0;  // metres
  double area = 0.0;    // of its largest face, square metres
  double volume = 0.0;  // cubic metres; 0 for a polygon
  double size = 0.0;    // upper bound of |x| + |y| + |z| over all its points, including the margin
};

class ConvexOccluders {
 public:
  // Omits occluders that are not clearly larger than their margin. Of a body that is too thin, the faces are
  // kept.
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

  std::vector<ConvexOccluder> occluders_;  // largest area first, ties by id
  std::vector<DrawnEdge> edges_;
  std::vector<DrawnFace> faces_;
};

// True if an occluder may be used for a convex region, given by all its corners in scene space: a plane
// separates them, all viewpoints are on the one side of a polygon from which it hides, and the whole occluder
// is farther than near_distance from the whole region.
bool separated(const ConvexOccluders& all, const ConvexOccluder& occluder, std::span<const Vec3d> corners,
               double near_distance);

}  // namespace sightline::pvs
