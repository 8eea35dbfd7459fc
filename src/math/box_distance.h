#pragma once

#include "sightline/math/box.h"

namespace sightline::math {

// The square of a point's distance from a box; 0 inside.
constexpr double squaredDistance(const Box& box, const Vec3d& point) {
  const Vec3d nearest = max(Vec3d(box.min), min(Vec3d(box.max), point));
  return dot(nearest - point, nearest - point);
}

}  // namespace sightline::math
