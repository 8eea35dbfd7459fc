#pragma once

// From double to single precision, never inwards.

#include <cmath>
#include <limits>

namespace sightline::layers {

// Conversion rounds by 2^-24 of the value or by 2^-150; twice that is taken off before. What is beyond the
// range of single precision becomes infinite.
inline float roundedDown(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  const double lower = value - (std::abs(value) * 0x1p-23 + 0x1p-148);
  return lower < -kMax  ? -std::numeric_limits<float>::infinity()
         : lower > kMax ? std::numeric_limits<float>::max()
                        : static_cast<float>(lower);
}
inline float roundedUp(double value) {
  return -roundedDown(-value);
}

}  // namespace sightline::layers
