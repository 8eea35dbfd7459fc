#pragma once

// One ray against triangles in 113-bit arithmetic, for the few results that must be beyond doubt.

#include <optional>

#include "sightline/math/vec3.h"

namespace sightline {

// At least 113 bits of mantissa if the compiler supports them.
#if defined(__SIZEOF_FLOAT128__)
using Wide = __float128;
#else
using Wide = long double;
#endif

class WideRay {
 public:
  // The ray origin + s * direction, s >= 0.
  WideRay(const Vec3d& origin, const Vec3d& direction);
  // The ray from `origin` with direction to - origin, computed without rounding the difference.
  static WideRay towards(const Vec3d& origin, const Vec3d& to);

  // The parameter where the line intersects the closed triangle. Points on an edge within the rounding of
  // this arithmetic (2^-100, relative) belong to the triangle. Returns nothing if the line misses the
  // triangle or is parallel to it, or if the triangle is degenerate. Without both_sides, a triangle hit on
  // its back (clockwise as seen from the origin) is missed.
  std::optional<Wide> intersect(const Vec3f& a, const Vec3f& b, const Vec3f& c, bool both_sides) const;

  Wide along(const Vec3d& axis) const;  // dot(direction, axis)

 private:
  WideRay() = default;
  bool surelyMisses(const Vec3f& a, const Vec3f& b, const Vec3f& c) const;

  Wide origin_[3], direction_[3];
  Vec3d origin_double_, direction_double_;
};

}  // namespace sightline
