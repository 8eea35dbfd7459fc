#pragma once

#include <cmath>
#include <limits>

#include "sightline/base/inline.h"
#include "sightline/math/vec3.h"

namespace sightline {

// Closed axis-aligned box, 24 bytes. Default-constructed, it is empty (min > max) and grows by extend().
struct Box {
  Vec3f min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
            std::numeric_limits<float>::infinity()};
  Vec3f max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
            -std::numeric_limits<float>::infinity()};

  SIGHTLINE_INLINE constexpr bool empty() const {
    return !(min.x <= max.x && min.y <= max.y && min.z <= max.z);
  }
  SIGHTLINE_INLINE constexpr void extend(const Vec3f& p) {
    min = sightline::min(min, p);
    max = sightline::max(max, p);
  }
  SIGHTLINE_INLINE constexpr void extend(const Box& b) {
    min = sightline::min(min, b.min);
    max = sightline::max(max, b.max);
  }
  SIGHTLINE_INLINE constexpr Vec3f extent() const { return max - min; }
  // True if the box is finite and not empty. Only such a box may be classified as other than visible.
  SIGHTLINE_INLINE bool wellFormed() const { return isFinite(min) && isFinite(max) && !empty(); }
  SIGHTLINE_INLINE friend constexpr bool operator==(const Box&, const Box&) = default;
};

SIGHTLINE_INLINE constexpr double surfaceArea(const Box& b) {
  if (b.empty()) {
    return 0.0;
  }
  const Vec3d e(b.extent());
  return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}
SIGHTLINE_INLINE constexpr Vec3d center(const Box& b) {
  return (Vec3d(b.min) + Vec3d(b.max)) * 0.5;
}
SIGHTLINE_INLINE constexpr Box intersection(const Box& a, const Box& b) {
  return {max(a.min, b.min), min(a.max, b.max)};
}
SIGHTLINE_INLINE constexpr bool overlaps(const Box& a, const Box& b) {
  return !intersection(a, b).empty();
}
// The box moved outwards on all sides by at least this much, and by the next number of single precision at
// most more; the same box for 0 or an empty one. What contains another box does so afterwards.
SIGHTLINE_INLINE Box widened(const Box& box, double by) {
  Box wide = box;
  const Vec3d low(box.min), high(box.max);
  for (int axis = 0; by > 0.0 && !box.empty() && axis < 3; ++axis) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    wide.min[axis] = std::nextafterf(static_cast<float>(low[axis] - by), -kFar);
    wide.max[axis] = std::nextafterf(static_cast<float>(high[axis] + by), kFar);
  }
  return wide;
}
SIGHTLINE_INLINE constexpr bool contains(const Box& a, const Box& b) {
  return a.min.x <= b.min.x && a.min.y <= b.min.y && a.min.z <= b.min.z && a.max.x >= b.max.x &&
         a.max.y >= b.max.y && a.max.z >= b.max.z;
}

}  // namespace sightline
