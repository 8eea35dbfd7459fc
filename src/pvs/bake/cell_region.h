#pragma once

// The convex regions that viewers of a cell can be in, by their corners.

#include <optional>
#include <span>
#include <vector>

#include "sightline/pvs/format/visibility_octree.h"
#include "src/pvs/bake/convex_occluder.h"

namespace sightline::pvs {

// Box of a cell, scene space.
struct CellBox {
  Vec3d min, max;

  Vec3d corner(std::uint32_t i) const {
    return {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z};
  }
  Vec3d centre() const { return (min + max) * 0.5; }
  Vec3d extent() const { return max - min; }
  // Of its smallest face, square metres.
  double smallestFace() const;
};

// Borders included.
inline bool meet(const CellBox& a, const CellBox& b) {
  return a.min.x <= b.max.x && a.min.y <= b.max.y && a.min.z <= b.max.z && a.max.x >= b.min.x &&
         a.max.y >= b.min.y && a.max.z >= b.min.z;
}

inline bool meet(const CellBox& a, const Box& b) {
  return meet(a, CellBox{Vec3d(b.min), Vec3d(b.max)});
}

std::vector<Vec3d> cornersOf(const CellBox& cell);

// The corners of the part of the cell with dot(normal, x) >= least: corners of the cell and points on its
// edges. What lies in the cell with dot(normal, x) >= least + sideMargin(cell) is within their hull, rounding
// included. Empty: nothing is there.
std::vector<Vec3d> cornersBefore(const CellBox& cell, const Vec3d& normal, double least);
// Metres; above the rounding of dot(normal, x) for all x in the box, wherever it is computed. That of a root
// serves for its cells.
double sideMargin(const CellBox& cell);

// A face of an occluder that might divide cells.
struct DividingFace {
  Plane plane;                        // unit normal to its front
  std::span<const ConvexEdge> edges;  // its outline, counter-clockwise from the front
  double margin = 0.0;                // metres, of its occluder
  bool double_sided = false;
};

// The plane through the cell of which faces cover the most, half of its cross-section at least. Faces just
// outside count too, if viewers could come too near to them: a floor that the cell stands on. Of planes that
// are covered wholly, the one that passes nearest to the centre. Its back is that of the next faces behind it
// that look the other way, if any. Viewers nearer than near_distance, and a few side_margin (that of the
// root, so that neighbours find the same planes), count as between.
//
// The choice is free: whatever the plane, the two sides are convex, and their sets are found for themselves.
// (The paper asks for a polygon that covers the whole cross-section, so floors of many tiles divide nothing.)
std::optional<CellPlane> dividingPlane(const CellBox& cell, std::span<const DividingFace> faces,
                                       double near_distance, double side_margin);

}  // namespace sightline::pvs
