#pragma once

// The convex regions of a cell in which viewers can be, given by their corners.

#include <optional>
#include <span>
#include <vector>

#include "sightline/pvs/format/visibility_octree.h"
#include "src/pvs/bake/convex/convex_occluder.h"

namespace sightline::pvs {

// Box of a cell, scene space.
struct CellBox {
  Vec3d min, max;

  Vec3d corner(std::uint32_t i) const {
    return {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z};
  }
  Vec3d centre() const { return (min + max) * 0.5; }
  Vec3d extent() const { return max - min; }
  // Area of the smallest face, square metres.
  double smallestFace() const;
};

// The box grown by a distance on all sides, metres.
inline CellBox grown(const CellBox& box, double distance) {
  const Vec3d by{distance, distance, distance};
  return {box.min - by, box.max + by};
}

// True if the closed boxes intersect.
inline bool intersects(const CellBox& a, const CellBox& b) {
  return a.min.x <= b.max.x && a.min.y <= b.max.y && a.min.z <= b.max.z && a.max.x >= b.min.x &&
         a.max.y >= b.min.y && a.max.z >= b.min.z;
}

inline bool intersects(const CellBox& a, const Box& b) {
  return intersects(a, CellBox{Vec3d(b.min), Vec3d(b.max)});
}

// The least distance between the boxes along each axis, 0 where they overlap.
inline Vec3d gapBetween(const CellBox& a, const Box& b) {
  return max(max(Vec3d(b.min) - a.max, a.min - Vec3d(b.max)), Vec3d{});
}

std::vector<Vec3d> cornersOf(const CellBox& cell);
// The box around the points, at least one.
CellBox boundsOf(std::span<const Vec3d> points);

// The corners of the part of the cell with dot(normal, x) >= level: corners of the cell and points on its
// edges. Every point of the cell with dot(normal, x) >= level + sideMargin(cell) is within their convex hull,
// including rounding. Empty if there is no such part.
std::vector<Vec3d> cornersBefore(const CellBox& cell, const Vec3d& normal, double level);
// A bound in metres on the rounding of dot(normal, x) for all x in the box, wherever it is computed. The
// margin of a root is valid for its cells.
double sideMargin(const CellBox& cell);

// A face of an occluder that may divide cells.
struct DividingFace {
  Plane plane;                        // its outline, counter-clockwise seen from the front
  std::span<const ConvexEdge> edges;  // its outline, counter-clockwise from the front
  double margin = 0.0;                // margin of its occluder, metres
  bool double_sided = false;
};

// The plane through the cell whose faces cover the most of its cross-section, and at least half. Faces just
// outside the cell count too if viewers could come too close to them, such as the floor that a cell stands
// on. Of planes that are completely covered, the one nearest to the centre is taken. The back of the plane is
// that of the next faces behind it that face the other way, if any. Viewers closer than near_distance plus a
// few side_margin count as between the sides. side_margin: that of the root, so that neighbouring cells find
// the same planes.
//
// Any choice is safe: for every plane the two sides are convex, and their sets are computed separately. (The
// paper requires a polygon that covers the whole cross-section, so that floors of many tiles divide nothing.)
std::optional<CellPlane> dividingPlane(const CellBox& cell, std::span<const DividingFace> faces,
                                       double near_distance, double side_margin);

}  // namespace sightline::pvs
