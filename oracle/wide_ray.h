#pragma once

// One ray against triangles in 113-bit arithmetic, for the few answers that must be beyond doubt.

#include <optional>

#include "sightline/math/vec3.h"

namespace sightline {

// At least 113 bits of mantissa where the compiler has them.
#if defined(__SIZEOF_FLOAT128__)
using Wide = __float128;
#else
using Wide = long double;
#endif

class WideRay {
 public:
  // The points origin + s * direction, s >= 0.
  WideRay(const Vec3d& origin, const Vec3d& direction);
  // From `origin` with the direction to - origin, without rounding of the difference.
  static WideRay towards(const Vec3d& origin, const Vec3d& to);

  // The parameter where the line meets the closed triangle. What lies on an edge within the rounding of this
  // arithmetic (2^-100, relative) belongs to the triangle. None: missed, degenerate, or parallel to it.
  // Without both_sides, a triangle whose back is met (clockwise seen from the origin) is missed.
  std::optional<Wide> intersect(const Vec3f& a, const Vec3f& b, const Vec3f& c, bool both_sides) const;

  Wide along(const Vec3d& axis) const;  // dot(direction, axis)

 private:
  WideRay() = default;
  bool surelyMisses(const Vec3f& a, const Vec3f& b, const Vec3f& c) const;

  Wide origin_[3], direction_[3];
  Vec3d origin_double_, direction_double_;
};

}  // namespace sightline
