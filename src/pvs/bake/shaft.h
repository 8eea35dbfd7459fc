#pragma once

// The lines of sight from a region to a box, all within one convex body: the hull of both.

#include <array>
#include <cstdint>

#include "src/pvs/bake/cell_region.h"

namespace sightline::pvs {

// How far rounding may move a place on a segment, from 0 to 1.
inline constexpr double kAlongSegment = 0x1p-40;

class Shaft {
 public:
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
  // All of the shaft has dot(normal, x) <= level, however the product is rounded.
  struct Side {
    Vec3d normal;
    double level = 0.0;
  };
  void add(const Vec3d& normal, double level);

  // Six along the axes, and at most one for each quadrant of each pair of axes.
  std::array<Side, 18> sides_;
  std::uint32_t count_ = 0;
  double rounding_ = 0.0;  // of a product of a normal and a point, for each metre of the normal's size
};

}  // namespace sightline::pvs
