#include "oracle/wide_ray.h"

namespace sightline {
namespace {

// Rounding of a triple product, relative to the sum of its terms' magnitudes: about ten operations each.
constexpr double kDoubleError = 1e-14;
constexpr double kWideError = 7.9e-31;  // 2^-100

struct Wide3 {
  Wide x, y, z;
};
Wide3 operator-(const Wide3& a, const Wide3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Wide dot(const Wide3& a, const Wide3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Wide l1Norm(Wide a) {
  return a < 0 ? -a : a;
}
Wide maxNorm(const Wide3& a) {
  const Wide x = l1Norm(a.x), y = l1Norm(a.y), z = l1Norm(a.z);
  return x > y ? (x > z ? x : z) : (y > z ? y : z);
}
Wide3 wide(const Vec3f& p) {
  return {Wide(p.x), Wide(p.y), Wide(p.z)};
}

// Sign of dot(d, cross(p, q)); 0 if it is within rounding.
int signOfVolume(const Wide3& d, const Wide3& p, const Wide3& q) {
  const Wide volume = dot(d, cross(p, q));
  const Wide bound = Wide(kWideError) * 6 * maxNorm(d) * maxNorm(p) * maxNorm(q);
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

double volumeDouble(const Vec3d& d, const Vec3d& p, const Vec3d& q, double& bound) {
  bound = kDoubleError * 6.0 * maxComponent(abs(d)) * maxComponent(abs(p)) * maxComponent(abs(q));
  return dot(d, cross(p, q));
}

}  // namespace

WideRay::WideRay(const Vec3d& origin, const Vec3d& direction)
    : origin_double_(origin), direction_double_(direction) {
  for (int axis = 0; axis < 3; ++axis) {
    origin_[axis] = Wide(origin[axis]);
    direction_[axis] = Wide(direction[axis]);
  }
}

WideRay WideRay::towards(const Vec3d& origin, const Vec3d& to) {
  WideRay ray(origin, to - origin);
  for (int axis = 0; axis < 3; ++axis) {
    ray.direction_[axis] = Wide(to[axis]) - Wide(origin[axis]);
  }
  return ray;
}

Wide WideRay::along(const Vec3d& axis) const {
  return direction_[0] * Wide(axis.x) + direction_[1] * Wide(axis.y) + direction_[2] * Wide(axis.z);
}

// True if two edges have opposite signs, both beyond the rounding of double precision. The differences are
// correctly rounded because their operands are exact, so all errors are relative to the terms.
bool WideRay::surelyMisses(const Vec3f& a, const Vec3f& b, const Vec3f& c) const {
  const Vec3d p[3] = {Vec3d(a) - origin_double_, Vec3d(b) - origin_double_, Vec3d(c) - origin_double_};
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    double bound = 0.0;
    const double volume = volumeDouble(direction_double_, p[i], p[(i + 1) % 3], bound);
    above = above || volume > bound;
    below = below || volume < -bound;
  }
  return above && below;
}

std::optional<Wide> WideRay::intersect(const Vec3f& a, const Vec3f& b, const Vec3f& c,
                                       bool both_sides) const {
  if (surelyMisses(a, b, c)) {
    return std::nullopt;
  }
  const Wide3 o{origin_[0], origin_[1], origin_[2]}, d{direction_[0], direction_[1], direction_[2]};
  const Wide3 p[3] = {wide(a) - o, wide(b) - o, wide(c) - o};
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    const int sign = signOfVolume(d, p[i], p[(i + 1) % 3]);
    above = above || sign > 0;
    below = below || sign < 0;
  }
  if (above && below) {
    return std::nullopt;
  }
  const Wide3 normal = cross(wide(b) - wide(a), wide(c) - wide(a));
  const Wide slope = dot(normal, d);  // negative: the ray hits the front
  if (l1Norm(slope) <= Wide(kWideError) * 3 * maxNorm(normal) * maxNorm(d) || (slope > 0 && !both_sides)) {
    return std::nullopt;
  }
  return dot(normal, p[0]) / slope;
}

}  // namespace sightline
