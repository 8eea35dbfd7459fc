#pragma once

// The tangent vertices of an axis-aligned box as seen from a line: where the two planes through the line that
// have the box on one side touch it. For a line through an edge of an occluder these are its supporting and
// its separating plane.
//
// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 3.3
// (tangentsByTables).
// Differs from the paper in: ties and thin boxes are defined, and signs are exact; every loop has six signs,
// so that one table of 64 rows serves all regions.
//
// All functions: `box_min`, `box_max` are relative to a point of the line, finite, min <= max on each axis
// (equal: a flat box, a segment, a point). `direction` is of the line, finite, not zero, of any length; its
// opposite is the same line with `low` and `high` exchanged. No state: any thread may call them.

#include <array>
#include <cstdint>

#include "sightline/math/vec3.h"

namespace sightline::geometry {

// Number of a box's corner, 0 to 7. Bit 0 set: maximal x, bit 1: maximal y, bit 2: maximal z.
using BoxCorner = std::uint8_t;

constexpr Vec3d cornerOf(const Vec3d& box_min, const Vec3d& box_max, BoxCorner corner) {
  return {(corner & 1) != 0 ? box_max.x : box_min.x, (corner & 2) != 0 ? box_max.y : box_min.y,
          (corner & 4) != 0 ? box_max.z : box_min.z};
}

// With det(a, b, c) = dot(cross(a, b), c), for every corner x of the box:
//   det(direction, low, x) >= 0 and det(direction, high, x) <= 0.
// They do not exist where the line intersects or touches the box. Where several corners lie in a
// tangent plane, any of them is named; the plane is well defined all the same: a tangent vertex is never on
// the line.
struct BoxTangents {
  BoxCorner low = 0, high = 0;
  bool exist = false;
};

// The paper's method: from which of 27 regions the point of the line sees the box gives the silhouette, the
// signs of the direction against the silhouette's edges give the tangent vertices. Exact for the numbers
// given, unless products of a component of `direction` and one of the box leave the range of double.
BoxTangents tangentsByTables(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction);

// The direct method, to compare with: the plane through the line and each corner, checked against all
// corners. Within rounding of double precision, not exact: where the line is parallel to a face or an edge,
// rounding may put corners of one tangent plane on both sides of it, and exist is then false.
BoxTangents tangentsOfAllVertices(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction);

// ---- The tables of tangentsByTables

inline constexpr int kRegions = 27;

// The region of the origin with respect to a box: x + 3 y + 9 z, where each of x, y, z is 0 between the two
// planes of that axis (or on one of them), 1 below the box, 2 above it. Region 0 is the box itself.
constexpr int regionOfOrigin(const Vec3d& box_min, const Vec3d& box_max) {
  const auto digit = [](double low, double high) { return (low > 0.0 ? 1 : 0) + (high < 0.0 ? 2 : 0); };
  return digit(box_min.x, box_max.x) + 3 * digit(box_min.y, box_max.y) + 9 * digit(box_min.z, box_max.z);
}

// First table. The corners of a box's silhouette, in an order that has the box on the positive side of each
// edge's plane: det(corner, next corner, x) >= 0 for every x in the box.
struct Silhouette {
  int count = 0;  // 0 inside the box, 4 where one face is seen, 6 where two or three are
  std::array<BoxCorner, 6> corners{};
};
const Silhouette& silhouetteFrom(int region);

// Second table. Bit i of `positive` (of 64 values): the direction is on the positive side of the plane of the
// silhouette's edge i, that from corner i to the next; where there are four edges, bits 4 and 5 repeat bit 3.
// `low` and `high` are positions in Silhouette::corners. A convex silhouette is seen from outside as one run
// of positive edges: other rows do not occur, except by numbers out of range, and do not exist.
struct TangentPositions {
  std::uint8_t low = 0, high = 0;
  bool exist = false;
};
const TangentPositions& tangentPositions(unsigned positive);

}  // namespace sightline::geometry
