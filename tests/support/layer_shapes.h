#pragma once

// Point sets whose convex hulls serve as parts in the tests of visibility sorting. All are seeded.

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::shapes {

// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  // Uniform in [0, count).
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>((engine_() >> 11) % count); }
  // Uniform in [from, to].
  int whole(int from, int to) {
    return from + static_cast<int>(below(static_cast<std::uint32_t>(to - from) + 1));
  }
  double number(double from, double to) {
    return from + (to - from) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  Vec3d point(const Vec3d& from, const Vec3d& to) {
    const double x = number(from.x, to.x);
    const double y = number(from.y, to.y);
    const double z = number(from.z, to.z);
    return {x, y, z};
  }
  // Uniform on the unit sphere.
  Vec3d direction() {
    while (true) {
      const Vec3d p = point({-1, -1, -1}, {1, 1, 1});
      const double l = length(p);
      if (l <= 1.0 && l > 0x1p-10) {
        return p / l;
      }
    }
  }

 private:
  std::mt19937_64 engine_;
};

using Points = std::vector<Vec3d>;

inline Points box(const Vec3d& from, const Vec3d& to) {
  Points points;
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back((corner & 1) != 0 ? to.x : from.x, (corner & 2) != 0 ? to.y : from.y,
                        (corner & 4) != 0 ? to.z : from.z);
  }
  return points;
}

inline Points cube(const Vec3d& centre = {}, double half = 1.0) {
  return box(centre - Vec3d{half, half, half}, centre + Vec3d{half, half, half});
}

// A tetrahedron whose corners are every second one of a cube.
inline Points tetrahedron(const Vec3d& centre = {}, double half = 1.0) {
  return {centre + Vec3d{half, half, half}, centre + Vec3d{half, -half, -half},
          centre + Vec3d{-half, half, -half}, centre + Vec3d{-half, -half, half}};
}

inline Points segment(const Vec3d& from, const Vec3d& to) {
  return {from, to};
}

inline Points point(const Vec3d& at) {
  return {at};
}

// A regular polygon of `sides` corners around the y axis, at height y.
inline Points flatPolygon(std::uint32_t sides, double radius = 1.0, double y = 0.0) {
  constexpr double kTurn = 6.283185307179586;
  Points points;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = kTurn * i / sides;
    points.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
  }
  return points;
}

// A prism between -half_height and half_height.
inline Points prism(std::uint32_t sides, double radius = 1.0, double half_height = 1.0) {
  Points points = flatPolygon(sides, radius, -half_height);
  const Points top = flatPolygon(sides, radius, half_height);
  points.insert(points.end(), top.begin(), top.end());
  return points;
}

// Two poles on the y axis and `rings` rings of `around` points each.
inline Points ellipsoid(std::uint32_t around, std::uint32_t rings, const Vec3d& semi_axes) {
  constexpr double kHalfTurn = 3.141592653589793;
  Points points{{0, semi_axes.y, 0}};
  for (std::uint32_t ring = 1; ring <= rings; ++ring) {
    const double polar = kHalfTurn * ring / (rings + 1);
    for (const Vec3d& p : flatPolygon(around)) {
      points.emplace_back(semi_axes.x * std::sin(polar) * p.x, semi_axes.y * std::cos(polar),
                          semi_axes.z * std::sin(polar) * p.z);
    }
  }
  points.emplace_back(0, -semi_axes.y, 0);
  return points;
}

// The paper's toothpick: 322 points, seven times as long as thick, along y.
inline Points toothpick(double half_length = 0.07) {
  return ellipsoid(40, 8, {half_length / 7, half_length, half_length / 7});
}

inline Points randomBall(Random& random, std::size_t count, const Vec3d& centre = {}, double radius = 1.0) {
  Points points;
  while (points.size() < count) {
    const Vec3d p = random.point({-1, -1, -1}, {1, 1, 1});
    if (length(p) <= 1.0) {
      points.push_back(centre + p * radius);
    }
  }
  return points;
}

// Random integers from -half to half. Coplanar, collinear and coincident points are common.
inline Points randomGrid(Random& random, std::size_t count, int half) {
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const int x = random.whole(-half, half);
    const int y = random.whole(-half, half);
    const int z = random.whole(-half, half);
    points.emplace_back(x, y, z);
  }
  return points;
}

// Random integers on a plane, on a line or at one point, for dimension 2, 1 or 0.
inline Points randomFlatGrid(Random& random, std::size_t count, int half, int dimension) {
  const Points base = randomGrid(random, 3, half);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const int s = dimension > 0 ? random.whole(-half, half) : 0;
    const int t = dimension > 1 ? random.whole(-half, half) : 0;
    points.push_back(base[0] + base[1] * s + base[2] * t);
  }
  return points;
}

inline Points moved(Points points, const Vec3d& by) {
  for (Vec3d& p : points) {
    p += by;
  }
  return points;
}

inline Points scaled(Points points, double by) {
  for (Vec3d& p : points) {
    p = p * by;
  }
  return points;
}

// A right-handed frame of unit vectors, rounded.
struct Axes {
  Vec3d x, y, z;

  Vec3d turn(const Vec3d& p) const { return x * p.x + y * p.y + z * p.z; }
};

inline Axes randomAxes(Random& random) {
  const Vec3d x = random.direction();
  while (true) {
    const Vec3d z = cross(x, random.direction());
    if (length(z) > 0.1) {
      return {x, normalized(cross(normalized(z), x)), normalized(z)};
    }
  }
}

inline Points turned(Points points, const Axes& axes) {
  for (Vec3d& p : points) {
    p = axes.turn(p);
  }
  return points;
}

}  // namespace sightline::shapes
