#include "scenes/round_solids.h"

#include <array>
#include <cmath>

namespace sightline::scenes {
namespace {

// Points of a circle about `middle`, counter-clockwise as seen against `direction`.
std::vector<Vec3d> circleAcross(const Vec3d& middle, const Vec3d& direction, double radius,
                                std::uint32_t segments) {
  const bool steep = std::abs(direction.z) > 0.9;
  const Vec3d u = normalized(cross(direction, steep ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1)));
  const Vec3d v = cross(direction, u);
  std::vector<Vec3d> circle;
  for (std::uint32_t s = 0; s < segments; ++s) {
    const Point2 d = unitVector(static_cast<double>(s) / segments) * radius;
    circle.push_back(middle + u * d.x + v * d.y);
  }
  return circle;
}

// Adds a fan over a tube's end.
void addCap(MeshBuilder& mesh, std::span<const Vec3d> circle, bool reversed) {
  for (std::size_t i = 1; i + 1 < circle.size(); ++i) {
    mesh.triangle(circle[0], circle[reversed ? i + 1 : i], circle[reversed ? i : i + 1]);
  }
}

}  // namespace

void addTube(MeshBuilder& mesh, std::span<const Vec3d> corners, double radius, std::uint32_t segments) {
  Vec3d direction = normalized(corners[1] - corners[0]);
  std::vector<Vec3d> before = circleAcross(corners[0], direction, radius, segments);
  addCap(mesh, before, true);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const bool last = i + 1 == corners.size();
    const Vec3d next = last ? direction : normalized(corners[i + 1] - corners[i]);
    const Vec3d mitre = direction + next;  // normal of the plane in which both legs end
    std::vector<Vec3d> circle;
    for (const Vec3d& p : before) {
      circle.push_back(p + direction * (dot(mitre, corners[i] - p) / dot(mitre, direction)));
    }
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t t = (s + 1) % segments;
      mesh.quad(before[s], before[t], circle[t], circle[s]);
    }
    before = circle;
    direction = next;
  }
  addCap(mesh, before, false);
}

Placement standingAlong(const Placement& at, const Vec3d& foot, std::uint32_t axis) {
  const Placement moved = at.moved(foot);
  if (axis == 0) {
    return {moved.origin, moved.y, moved.z, moved.x};
  }
  return axis == 1 ? Placement{moved.origin, moved.z, moved.x, moved.y} : moved;
}

void addCylinder(MeshBuilder& mesh, const Placement& at, const Vec3d& foot, std::uint32_t axis, double radius,
                 double length, std::uint32_t segments) {
  mesh.place(standingAlong(at, foot, axis));
  mesh.lathe(std::array<Point2, 4>{{{0, 0}, {radius, 0}, {radius, length}, {0, length}}}, segments);
}

std::vector<Point2> halfCircle(double radius, double z, std::uint32_t legs) {
  std::vector<Point2> profile;
  for (std::uint32_t i = 0; i <= legs; ++i) {
    const Point2 d = unitVector(0.5 * i / legs - 0.25) * radius;
    profile.push_back({i == 0 || i == legs ? 0.0 : d.x, z + d.y});
  }
  return profile;
}

}  // namespace sightline::scenes
