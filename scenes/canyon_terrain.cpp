// The terrain: a height field with a winding valley.

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "scenes/canyon_parts.h"
#include "scenes/moving_parts.h"
#include "scenes/random.h"

namespace sightline::scenes::canyon {
namespace {

constexpr std::uint32_t kQuads = 36;  // along each side
constexpr std::uint32_t kCut = 6;     // quads per side of the triangle cut off at a corner
constexpr double kFloorHalf = 35.0, kRimHalf = 95.0, kDepth = 110.0;  // metres

// 0 on the valley's floor, 1 beyond its rims.
double rise(Point2 p) {
  const ValleyPoint valley = valleyAt(p.x);
  const double across = std::abs(p.y - valley.middle) / std::sqrt(1.0 + valley.slope * valley.slope);
  const double t = std::clamp((across - kFloorHalf) / (kRimHalf - kFloorHalf), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Distance of a grid point from the nearest corner: the number of quads along both sides together.
std::uint32_t fromCorner(std::uint32_t column, std::uint32_t row) {
  return std::min(column, kQuads - column) + std::min(row, kQuads - row);
}

std::vector<Vec3d> gridPoints(std::uint32_t seed) {
  Random random(seed, 1);
  std::vector<Vec3d> points;
  for (std::uint32_t row = 0; row <= kQuads; ++row) {
    for (std::uint32_t column = 0; column <= kQuads; ++column) {
      const Point2 p{(static_cast<double>(column) / kQuads - 0.5) * kSize,
                     (static_cast<double>(row) / kQuads - 0.5) * kSize};
      const double high = rise(p);
      const double rough = random.range(-1.0, 1.0) * (1.0 + 7.0 * high);
      points.emplace_back(p.x, p.y, kDepth * high + rough);
    }
  }
  return points;
}

struct GridPoint {
  std::uint32_t column, row;
};

// Adds the triangle unless it is in a corner of the square that is cut off.
void addTriangle(MeshBuilder& mesh, std::span<const Vec3d> points, GridPoint a, GridPoint b, GridPoint c) {
  const auto isKept = [](GridPoint p) { return fromCorner(p.column, p.row) >= kCut; };
  const auto at = [&](GridPoint p) { return points[p.row * (kQuads + 1) + p.column]; };
  if (isKept(a) && isKept(b) && isKept(c)) {
    mesh.triangle(at(a), at(b), at(c));
  }
}

}  // namespace

ValleyPoint valleyAt(double x) {
  constexpr double kSwing = 85.0, kTurns = 1.25 / kSize;
  constexpr double kRate = 6.283185307179586 * kTurns;
  const Point2 d = unitVector(x * kTurns);
  return {kSwing * d.y, kSwing * kRate * d.x, -kSwing * kRate * kRate * d.y};
}

Scene terrainMesh(std::uint32_t seed) {
  const std::vector<Vec3d> points = gridPoints(seed);
  return buildPartMesh([&](MeshBuilder& mesh) {
    for (std::uint32_t row = 0; row < kQuads; ++row) {
      for (std::uint32_t column = 0; column < kQuads; ++column) {
        const GridPoint a{column, row}, b{column + 1, row}, c{column + 1, row + 1}, d{column, row + 1};
        // The diagonal is parallel to the cut of the nearest corner.
        if ((column < kQuads / 2) == (row < kQuads / 2)) {
          addTriangle(mesh, points, a, b, d);
          addTriangle(mesh, points, b, c, d);
        } else {
          addTriangle(mesh, points, a, b, c);
          addTriangle(mesh, points, a, c, d);
        }
      }
    }
  });
}

}  // namespace sightline::scenes::canyon
