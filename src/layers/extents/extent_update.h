#pragma once

// Brings a table of extents up to date with parts and looks.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/extents/axis_look.h"
#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/plane_angle.h"
#include "src/layers/pairs/part_store.h"

namespace sightline::layers {

// Along which heights are taken, and above which point. Axes share them.
struct ExtentRow {
  Vec3d direction, from;

  friend bool operator==(const ExtentRow&, const ExtentRow&) = default;
};

// How one axis is measured now.
struct MeasuredAxis {
  AxisLook look;
  std::uint32_t along = 0, zero = 0;  // rows of the look's directions; zero: of angles
  std::uint32_t first_vertex = 0;     // its place among an instance's numbers
};

// What is the same for all parts that share a hull.
struct HullBounds {
  double reach = 0.0;  // no vertex is farther from the hull's origin
  double error = 0.0;  // of support along a direction of unit length
};
HullBounds boundsOf(const ConvexHull& hull);

// A row as a part has it.
struct PlacedRow {
  Vec3d direction;      // in the hull's space
  double base = 0.0;    // height of the hull's origin
  double offset = 0.0;  // magnitude of the way from the row's point to it
};
// Of a part along an axis, not yet rounded.
struct PartBounds {
  double low = 0.0, high = 0.0;  // heights
  AngleRange angles;
};

struct ExtentUpdate {
  std::vector<MeasuredAxis> axes;
  std::vector<ExtentRow> rows;  // of all axes, each once
  std::vector<HullBounds> hulls;
  std::uint32_t vertices_of_instance = 0;
  std::vector<std::uint32_t> vertices;  // instances * vertices_of_instance: where the next search begins
  // Scratch, of the part that is looked at.
  std::array<PlacedRow, 2 * kMaxExtentAxes> placed_rows;
  std::array<PartBounds, kMaxExtentAxes> part_bounds;
};

// Numbers kept for an instance and an axis.
inline constexpr std::uint32_t kHeightVertices = 2;  // lowest, highest
inline constexpr std::uint32_t kAngleVertices = 3;   // AngularVertices; heights need the first two

// The intervals of some parts along some axes. axes_of: one a part, a bit an axis.
void updateExtents(ExtentUpdate& update, const PartStore& parts, std::span<const std::uint32_t> axes_of,
                   ExtentTable& table);

}  // namespace sightline::layers
