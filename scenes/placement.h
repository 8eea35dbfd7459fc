#pragma once

// Where a piece of a procedural scene stands.
//
// The builders think in plan space: x east, y north, z up, metres, right-handed. Only MeshBuilder and the
// walks turn plan space into the world's Y-up space, by worldFromPlan.

#include "sightline/math/vec3.h"

namespace sightline::scenes {

// A point of a plan, or of any other flat figure.
struct Point2 {
  double x = 0.0, y = 0.0;
  friend constexpr Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Point2 operator*(Point2 a, double s) { return {a.x * s, a.y * s}; }
  friend constexpr Point2 operator/(Point2 a, double s) { return {a.x / s, a.y / s}; }
  friend constexpr bool operator==(Point2, Point2) = default;
};
constexpr double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}
constexpr double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}
inline double length(Point2 a) {
  return std::sqrt(dot(a, a));
}

constexpr Vec3d worldFromPlan(const Vec3d& p) {
  return {p.x, p.z, -p.y};
}

// Unit vector at this part of a full turn, anticlockwise from (1, 0). Only sums and products: the same bits
// everywhere.
Point2 unitVector(double turns);

// Orthonormal, right-handed.
struct Placement {
  Vec3d origin;
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  constexpr Vec3d direction(const Vec3d& d) const { return x * d.x + y * d.y + z * d.z; }
  constexpr Vec3d point(const Vec3d& p) const { return origin + direction(p); }
  constexpr Placement moved(const Vec3d& by) const { return {point(by), x, y, z}; }
  // Turned anticlockwise about its z axis.
  Placement turned(double turns) const {
    const Point2 c = unitVector(turns);
    return {origin, x * c.x + y * c.y, y * c.x - x * c.y, z};
  }
  // Standing on a wall whose foot runs from a to b with the outside on the right: x along the wall, y up, z
  // outwards.
  Placement onWall(Point2 a, Point2 b, double height) const {
    const Point2 d = (b - a) / length(b - a);
    return {point({a.x, a.y, height}), direction({d.x, d.y, 0.0}), z, direction({d.y, -d.x, 0.0})};
  }
};

}  // namespace sightline::scenes
