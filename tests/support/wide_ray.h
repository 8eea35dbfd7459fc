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

namespace wide {

// Rounding of a triple product, relative to the sum of its terms' magnitudes: about ten operations each.
inline constexpr double kDoubleError = 1e-14;
inline constexpr double kWideError = 7.9e-31;  // 2^-100

struct Wide3 {
  Wide x, y, z;
};
inline Wide3 operator-(const Wide3& a, const Wide3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Wide dot(const Wide3& a, const Wide3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Wide l1Norm(Wide a) {
  return a < 0 ? -a : a;
}
inline Wide maxNorm(const Wide3& a) {
  const Wide x = l1Norm(a.x), y = l1Norm(a.y), z = l1Norm(a.z);
  return x > y ? (x > z ? x : z) : (y > z ? y : z);
}
inline Wide3 wide(const Vec3f& p) {
  return {Wide(p.x), Wide(p.y), Wide(p.z)};
}

// Sign of dot(d, cross(p, q)); 0 if it is within rounding.
inline int signOfVolume(const Wide3& d, const Wide3& p, const Wide3& q) {
  const Wide volume = dot(d, cross(p, q));
  const Wide bound = Wide(kWideError) * 6 * maxNorm(d) * maxNorm(p) * maxNorm(q);
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

inline double volumeDouble(const Vec3d& d, const Vec3d& p, const Vec3d& q, double& bound) {
  bound = kDoubleError * 6.0 * maxComponent(abs(d)) * maxComponent(abs(p)) * maxComponent(abs(q));
  return dot(d, cross(p, q));
}

}  // namespace wide

inline WideRay::WideRay(const Vec3d& origin, const Vec3d& direction)
    : origin_double_(origin), direction_double_(direction) {
  for (int axis = 0; axis < 3; ++axis) {
    origin_[axis] = Wide(origin[axis]);
    direction_[axis] = Wide(direction[axis]);
  }
}

inline WideRay WideRay::towards(const Vec3d& origin, const Vec3d& to) {
  WideRay ray(origin, to - origin);
  for (int axis = 0; axis < 3; ++axis) {
    ray.direction_[axis] = Wide(to[axis]) - Wide(origin[axis]);
  }
  return ray;
}

inline Wide WideRay::along(const Vec3d& axis) const {
  return direction_[0] * Wide(axis.x) + direction_[1] * Wide(axis.y) + direction_[2] * Wide(axis.z);
}

// True if two edges have opposite signs, both beyond the rounding of double precision. The differences are
// correctly rounded because their operands are exact, so all errors are relative to the terms.
inline bool WideRay::surelyMisses(const Vec3f& a, const Vec3f& b, const Vec3f& c) const {
  const Vec3d p[3] = {Vec3d(a) - origin_double_, Vec3d(b) - origin_double_, Vec3d(c) - origin_double_};
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    double bound = 0.0;
    const double volume = wide::volumeDouble(direction_double_, p[i], p[(i + 1) % 3], bound);
    above = above || volume > bound;
    below = below || volume < -bound;
  }
  return above && below;
}

inline std::optional<Wide> WideRay::intersect(const Vec3f& a, const Vec3f& b, const Vec3f& c,
                                              bool both_sides) const {
  if (surelyMisses(a, b, c)) {
    return std::nullopt;
  }
  const wide::Wide3 o{origin_[0], origin_[1], origin_[2]}, d{direction_[0], direction_[1], direction_[2]};
  const wide::Wide3 p[3] = {wide::wide(a) - o, wide::wide(b) - o, wide::wide(c) - o};
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    const int sign = wide::signOfVolume(d, p[i], p[(i + 1) % 3]);
    above = above || sign > 0;
    below = below || sign < 0;
  }
  if (above && below) {
    return std::nullopt;
  }
  const wide::Wide3 normal = wide::cross(wide::wide(b) - wide::wide(a), wide::wide(c) - wide::wide(a));
  const Wide slope = wide::dot(normal, d);  // negative: the ray hits the front
  if (wide::l1Norm(slope) <= Wide(wide::kWideError) * 3 * wide::maxNorm(normal) * wide::maxNorm(d) ||
      (slope > 0 && !both_sides)) {
    return std::nullopt;
  }
  return wide::dot(normal, p[0]) / slope;
}

}  // namespace sightline
