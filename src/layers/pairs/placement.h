#pragma once

// An affine map from a hull's space to the world.

#include <algorithm>
#include <cmath>

#include "sightline/math/mat4.h"
#include "sightline/math/vec3.h"

namespace sightline::layers {

struct Placement {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  // the hull's axes in the world
  Vec3d origin;

  friend bool operator==(const Placement&, const Placement&) = default;
  Vec3d point(const Vec3d& p) const { return x * p.x + y * p.y + z * p.z + origin; }
  // Returns the direction in the hull's space whose heights are those along a direction of the world.
  Vec3d toHull(const Vec3d& direction_world) const {
    return {dot(direction_world, x), dot(direction_world, y), dot(direction_world, z)};
  }
};

// Returns an upper bound of the factor by which the placement lengthens a vector. The greatest row sum of the
// axes' dot products bounds the square of the greatest singular value.
inline double stretchOf(const Placement& p) {
  const double xy = std::abs(dot(p.x, p.y)), yz = std::abs(dot(p.y, p.z)), zx = std::abs(dot(p.z, p.x));
  const double x = dot(p.x, p.x) + xy + zx, y = dot(p.y, p.y) + xy + yz, z = dot(p.z, p.z) + yz + zx;
  return 1.00001 * std::sqrt(std::max(x, std::max(y, z)));
}

inline Placement placementOf(const Mat4& world_from_hull) {
  const Mat4& m = world_from_hull;
  return {{m(0, 0), m(1, 0), m(2, 0)},
          {m(0, 1), m(1, 1), m(2, 1)},
          {m(0, 2), m(1, 2), m(2, 2)},
          {m(0, 3), m(1, 3), m(2, 3)}};
}

inline Mat4 matrixOf(const Placement& p) {
  Mat4 m;
  for (int row = 0; row < 3; ++row) {
    m(row, 0) = p.x[row];
    m(row, 1) = p.y[row];
    m(row, 2) = p.z[row];
    m(row, 3) = p.origin[row];
  }
  return m;
}

inline bool isFinite(const Placement& p) {
  return sightline::isFinite(p.x) && sightline::isFinite(p.y) && sightline::isFinite(p.z) &&
         sightline::isFinite(p.origin);
}

}  // namespace sightline::layers
