#pragma once

// Signs that RegionProof relies on: in doubles, each with a bound of its rounding.

#include <cmath>
#include <optional>

#include "sightline/math/vec3.h"

namespace sightline {

struct Sign {
  double value = 0.0, doubt = 0.0;
  bool positive() const { return value > doubt; }
  bool negative() const { return value < -doubt; }
};

struct Corners {
  Vec3d a, b, c;
};

// A dot product of a vector and a difference of points is off by at most this fraction of their sizes, which
// is far more than IEEE arithmetic can lose in so few operations.
inline constexpr double kProductDoubt = 0x1p-46;

inline double sizeOf(const Vec3d& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}
// dot(n, a - b), where n may have any value.
inline Sign along(const Vec3d& n, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = a - b;
  return {dot(n, d), kProductDoubt * sizeOf(n) * (sizeOf(d) + 0x1p-6 * (sizeOf(a) + sizeOf(b)))};
}
// Six times the volume of the triangle and the point: positive in front of it.
Sign sideOf(const Corners& t, const Vec3d& p);
// How a segment meets a triangle: 1 from its front, -1 from its back, 0 not at all; nothing if in doubt.
std::optional<int> crossing(const Corners& t, const Vec3d& from, const Vec3d& to);

}  // namespace sightline
