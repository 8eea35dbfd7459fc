#pragma once

#include <cmath>
#include <cstdint>

#include "sightline/math/mat4.h"

namespace sightline::io {

// What a transform makes of the order of a triangle's corners, which says where its front is.
enum class CornerOrder : std::uint8_t {
  kKept,
  kReversed,  // it mirrors
  kUnknown,   // it flattens: the sign of its determinant is that of a rounding error
};

// Compares the determinant with the product of the columns' lengths. rounding: how large their ratio may be
// in a transform that is flat but for rounding. With elements of double precision, that is a few times 2^-53;
// 1e-12 is 9007 times 2^-53. Columns of something that is not flat, however small or thin, lie in a plane
// less nearly than that. A product with what is flat is flat, but may have a larger ratio where it shrinks
// the plane: ask about each factor, too.
inline CornerOrder cornerOrder(const Mat4& transform, double rounding = 1e-12) {
  Mat4 unit;
  for (int column = 0; column < 3; ++column) {
    const Vec3d axis(transform(0, column), transform(1, column), transform(2, column));
    const double size = length(axis);
    for (int row = 0; row < 3; ++row) {
      unit(row, column) = axis[row] / size;  // of length 0: not a number, and so is the determinant
    }
  }
  const double determinant = determinant3(unit);
  if (!(std::abs(determinant) > rounding)) {
    return CornerOrder::kUnknown;
  }
  return determinant < 0.0 ? CornerOrder::kReversed : CornerOrder::kKept;
}

}  // namespace sightline::io
