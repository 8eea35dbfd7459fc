#pragma once

// Brings a table of extents up to date with the parts and the view.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/extents/axis_look.h"
#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/plane_angle.h"
#include "src/layers/pairs/part_store.h"

namespace sightline::layers {

// A direction along which heights are measured, and the point above which they are. Axes share rows.
struct ExtentRow {
  Vec3d direction, from;

  friend bool operator==(const ExtentRow&, const ExtentRow&) = default;
};

// How one axis is measured in the current view.
struct MeasuredAxis {
  AxisLook look;
  std::uint32_t along = 0, zero = 0;  // rows of the look's directions; zero: for angles only
  std::uint32_t first_vertex = 0;     // index of the axis's first number among those of an instance
};

// Bounds that all parts with the same hull share.
struct HullBounds {
  double reach = 0.0;  // upper bound of the vertices' distances from the hull's origin
  double error = 0.0;  // supportError() along a direction of unit length
};
HullBounds boundsOf(const ConvexHull& hull);

// A row in the space of a part.
struct PlacedRow {
  Vec3d direction;      // in the hull's space
  double base = 0.0;    // height of the hull's origin
  double offset = 0.0;  // magnitude of the vector from the row's point to the hull's origin
};
// The bounds of a part along an axis, not yet rounded.
struct PartBounds {
  double low = 0.0, high = 0.0;  // heights
  AngleRange angles;
};

struct ExtentUpdate {
  std::vector<MeasuredAxis> axes;
  std::vector<ExtentRow> rows;    // the distinct rows of all axes
  std::vector<HullBounds> hulls;  // one per hull
  std::uint32_t vertices_of_instance = 0;
  std::vector<std::uint32_t> vertices;  // instances * vertices_of_instance elements: where searches start
  // Scratch for one part.
  std::array<PlacedRow, 2 * kMaxExtentAxes> placed_rows;
  std::array<PartBounds, kMaxExtentAxes> part_bounds, hull_bounds;
};

// Vertex numbers kept per instance and axis.
inline constexpr std::uint32_t kHeightVertices = 2;  // the lowest and the highest vertex
inline constexpr std::uint32_t kAngleVertices = 3;   // AngularVertices; heights use the first two

// Computes intervals of parts and of their hulls. axes_of: one element per part, with bit a set if axis a is
// to be computed. table: one row per part. hulls: one row per instance.
void updateExtents(ExtentUpdate& update, const PartStore& parts, std::span<const std::uint32_t> axes_of,
                   ExtentTable& table, ExtentTable& hulls);

}  // namespace sightline::layers
