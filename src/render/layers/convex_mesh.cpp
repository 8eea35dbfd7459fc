// Tests every pair of triangles a and b. Where b faces the same way as a and lies nowhere in front of a's
// plane, one ray can intersect both only where they touch. So it is enough that, seen along a's normal,
// triangles that touch a do not overlap it.

#include "src/render/layers/convex_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sightline::render {
namespace {

constexpr std::size_t kMaxTriangles = 8192;
constexpr double kRounding = 0x1p-22;  // of the largest coordinate

struct Triangle {
  std::array<Vec3d, 3> corners;
  Vec3d normal;           // unit length
  double rounding = 0.0;  // metres by which its plane may lie elsewhere, all over the mesh
};

double longestSide(const std::array<Vec3d, 3>& corners) {
  return std::max(
      {length(corners[1] - corners[0]), length(corners[2] - corners[1]), length(corners[0] - corners[2])});
}

// Reads the triangles that have an area. False if some number is not finite.
bool readTriangles(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                   std::vector<Triangle>& triangles) {
  for (std::size_t i = 0; i + 3 <= indices.size(); i += 3) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t.corners[k] = Vec3d(positions[indices[i + k]]);
    }
    const Vec3d normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    const double doubled_area = length(normal);
    if (!std::isfinite(doubled_area)) {
      return false;
    }
    if (doubled_area > 0.0) {
      t.normal = normal / doubled_area;
      triangles.push_back(t);
    }
  }
  return true;
}

// A corner that is off by the rounding tilts the triangle's plane, the more the lower the triangle is.
void setRoundings(std::vector<Triangle>& triangles) {
  double largest = 0.0, size = 0.0;
  for (const Triangle& t : triangles) {
    for (const Vec3d& corner : t.corners) {
      largest = std::max({largest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
      size = std::max(size, length(corner - triangles.front().corners[0]));
    }
  }
  for (Triangle& t : triangles) {
    const double side = longestSide(t.corners);
    const double height = length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / side;
    t.rounding = kRounding * largest * (1.0 + size / height);
  }
}

// Whether an edge of `a`, seen along `direction`, separates the two: all of `a` lies on one side of it, all
// of `b` on the other side or on the edge.
bool anEdgeSeparates(const Triangle& a, const Triangle& b, const Vec3d& direction, double rounding) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d start = a.corners[k], edge = a.corners[(k + 1) % 3] - start;
    Vec3d aside = cross(edge, direction);
    const double squared = dot(aside, aside);
    if (!(squared > 0.0)) {
      continue;
    }
    aside = aside / std::sqrt(squared);
    if (dot(a.corners[(k + 2) % 3] - start, aside) > 0.0) {
      aside = -aside;
    }
    const auto is_beyond = [&](const Vec3d& corner) { return dot(corner - start, aside) >= -rounding; };
    if (std::all_of(b.corners.begin(), b.corners.end(), is_beyond)) {
      return true;
    }
  }
  return false;
}

// Whether no ray that intersects the front of `a` also intersects `b` (if single-sided: the front of `b`), as
// far as a's plane tells.
bool neverBothIntersected(const Triangle& a, const Triangle& b, bool double_sided) {
  double lowest = INFINITY, highest = -INFINITY;
  for (const Vec3d& corner : b.corners) {
    const double height = dot(corner - a.corners[0], a.normal);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  const double rounding = a.rounding;
  // The back of a double-sided triangle shows through a front, unless both lie in one plane.
  if (highest > rounding || (double_sided && lowest < -rounding)) {
    return false;
  }
  const bool faces_away = dot(a.normal, b.normal) <= 0.0 && !double_sided;
  const double either = std::max(a.rounding, b.rounding);
  return highest < -rounding || faces_away || anEdgeSeparates(a, b, a.normal, either) ||
         anEdgeSeparates(b, a, a.normal, either);
}

}  // namespace

bool coversOnce(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices, bool double_sided) {
  std::vector<Triangle> triangles;
  if (indices.size() / 3 > kMaxTriangles || !readTriangles(positions, indices, triangles)) {
    return false;
  }
  if (triangles.empty()) {
    return true;
  }
  setRoundings(triangles);
  for (const Triangle& a : triangles) {
    for (const Triangle& b : triangles) {
      if (&a != &b && !neverBothIntersected(a, b, double_sided)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace sightline::render
