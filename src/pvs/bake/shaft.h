#pragma once

// The lines of sight from a region to a box, all within one convex body: the hull of both.

#include <array>
#include <cstdint>
#include <limits>

#include "src/pvs/bake/cell_region.h"

namespace sightline::pvs {

// How far rounding may move a place on a segment, from 0 to 1.
inline constexpr double kAlongSegment = 0x1p-40;

class Shaft {
 public:
  // Slanted sides, whose normals are across one axis: all of the shaft has
  // normal_i * x_i + normal_j * x_j <= level along the two other axes, however the products are rounded. At
  // most one side for each quadrant of these. Nothing is beyond those from `count` on.
  struct Sides {
    Sides() { level.fill(std::numeric_limits<double>::infinity()); }

    alignas(32) std::array<double, 4> normal_i{}, normal_j{}, level;
    std::uint32_t count = 0;
  };

  Shaft() = default;
  // magnitude: an upper bound of the absolute coordinates of both boxes and of whatever is asked about,
  // metres. slack: how far what is asked about may be off.
  Shaft(const CellBox& region, const CellBox& target, double magnitude, double slack);

  // True only if no point of the closed box, or of the closed segment, is in the shaft.
  bool misses(const Box& box) const;
  bool misses(const Vec3d& from, const Vec3d& to) const;
  // A bit for each side that the point is surely beyond. A segment misses the shaft where both of its ends
  // are beyond the same one, and does not where there is none for one of them.
  std::uint32_t sidesBeyond(const Vec3d& point) const;

 private:
  Vec3d low_, high_;                // of all of the shaft
  std::array<Sides, 3> slanted_{};  // by the axis that the normals are across
};

}  // namespace sightline::pvs
