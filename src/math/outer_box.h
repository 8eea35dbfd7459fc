#pragma once

#include <cmath>
#include <limits>

#include "sightline/math/box.h"

namespace sightline::math {

// The largest number of single precision that is at most the value.
inline float floatAtMost(double value) {
  const auto rounded = static_cast<float>(value);
  return double{rounded} > value ? std::nextafterf(rounded, -std::numeric_limits<float>::infinity())
                                 : rounded;
}

// The smallest box of single precision that holds all points between two corners.
inline Box outerBox(const Vec3d& min, const Vec3d& max) {
  return {{floatAtMost(min.x), floatAtMost(min.y), floatAtMost(min.z)},
          {-floatAtMost(-max.x), -floatAtMost(-max.y), -floatAtMost(-max.z)}};
}

}  // namespace sightline::math
