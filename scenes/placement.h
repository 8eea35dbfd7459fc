#pragma once

// The position and orientation of a piece of a procedural scene.
//
// The builders use plan space: x east, y north, z up, metres, right-handed. Only MeshBuilder and the camera
// paths convert plan space to the world's Y-up space, by worldFromPlan.

#include "sightline/math/vec3.h"

namespace sightline::scenes {

// A point of a plan, or of any other 2D figure.
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

// The unit vector at this fraction of a full turn, counter-clockwise from (1, 0). Uses only sums and
// products, so it has the same bits everywhere.
Point2 unitVector(double turns);

// Orthonormal, right-handed.
struct Placement {
  Vec3d origin;
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  constexpr Vec3d direction(const Vec3d& d) const { return x * d.x + y * d.y + z * d.z; }
  constexpr Vec3d point(const Vec3d& p) const { return origin + direction(p); }
  constexpr Placement moved(const Vec3d& by) const { return {point(by), x, y, z}; }
  // Turned counter-clockwise about its z axis.
  Placement turned(double turns) const {
    const Point2 c = unitVector(turns);
    return {origin, x * c.x + y * c.y, y * c.x - x * c.y, z};
  }
  // A placement on a wall whose foot runs from a to b with the outside on the right: x along the wall, y up,
  // z outwards.
  Placement onWall(Point2 a, Point2 b, double height) const {
    const Point2 d = (b - a) / length(b - a);
    return {point({a.x, a.y, height}), direction({d.x, d.y, 0.0}), z, direction({d.y, -d.x, 0.0})};
  }
};

}  // namespace sightline::scenes
