#pragma once

// How a line of sight crosses sheets, four at a time.

#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::pvs {

// Determinants are rounded by less than this fraction of the product of the sizes of their vectors.
inline constexpr double kDeterminantRounding = 0x1p-44;

// Bounds the error of a determinant of three vectors, from bounds of the sums of their coordinates. error: of
// each coordinate.
inline double doubtOf(double a, double b, double c, double error) {
  return kDeterminantRounding * a * b * c + 4.0 * error * (a * b + b * c + c * a);
}

// A line of sight from one point to another, metres.
struct SightLine {
  Vec3d from, to;
  double error = 0.0;  // of each coordinate of a sheet's corner relative to these
};

struct SheetCrossings {
  std::int32_t sum = 0;   // of crossings from the front, less those from the back
  bool front = false;     // some are from the front
  bool in_doubt = false;  // rounding does not tell for some of the sheets
  bool any() const { return front || in_doubt || sum != 0; }
};

// Adds up the crossings of all sheets. corners: three for each sheet, counter-clockwise as seen from its
// front, into vertices. far: an upper bound of l1Norm(corner - from) for all of the corners. The same on
// every instruction set.
SheetCrossings crossSheets(std::span<const Vec3d> vertices, std::span<const std::uint32_t> corners,
                           const SightLine& line, double far);

}  // namespace sightline::pvs
