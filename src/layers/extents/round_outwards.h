#pragma once

// Rounding from double to single precision, always outwards.

#include <cmath>
#include <limits>

namespace sightline::layers {

// Conversion rounds by up to 2^-24 of the value or 2^-150, so twice that is subtracted first. A value beyond
// the range of float becomes infinite.
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
