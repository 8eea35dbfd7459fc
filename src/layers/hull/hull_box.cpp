#include "src/layers/hull/hull_box.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "sightline/geometry/tolerance.h"
#include "src/layers/hull/hull_frame.h"

namespace sightline::layers {
namespace {

// Zero for a vector that is too short to have a direction, of points at most 1 apart.
Vec3d unitOf(const Vec3d& v) {
  constexpr double kShortest = 1e-6;
  return dot(v, v) > kShortest * kShortest ? normalized(v) : Vec3d();
}

// A unit vector across another one.
Vec3d acrossOf(const Vec3d& unit) {
  const Vec3d size = abs(unit);
  const Vec3d other = size.x <= size.y && size.x <= size.z ? Vec3d{1, 0, 0}
                      : size.y <= size.z                   ? Vec3d{0, 1, 0}
                                                           : Vec3d{0, 0, 1};
  return normalized(cross(unit, other));
}

// The box along these axes, of points around the hull's centre.
HullBox boxAlong(std::span<const Vec3d> points, const std::array<Vec3d, 3>& axes) {
  HullBox box;
  box.axes = axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = 0.0, high = 0.0;
    for (const Vec3d& point : points) {
      low = std::min(low, dot(point, axes[axis]));
      high = std::max(high, dot(point, axes[axis]));
    }
    box.centre += axes[axis] * (0.5 * (low + high));
    box.half[axis] = 0.5 * (high - low);
  }
  return box;
}

// Of flat hulls the area counts, and of segments the length.
double sizeOf(const HullBox& box) {
  constexpr double kThin = 1e-9;
  return (box.half[0] + kThin) * (box.half[1] + kThin) * (box.half[2] + kThin);
}

// The normal of the largest triangle of a solid's surface.
Vec3d largestNormal(const ConvexHull& hull, std::span<const Vec3d> points) {
  Vec3d largest;
  for (const std::array<std::uint32_t, 3>& triangle : hull.triangles) {
    const Vec3d& a = points[triangle[0]];
    const Vec3d normal = cross(points[triangle[1]] - a, points[triangle[2]] - a);
    largest = dot(normal, normal) > dot(largest, largest) ? normal : largest;
  }
  return unitOf(largest);
}

}  // namespace

// One face of the smallest box lies on a face of the hull, or nearly so; of boxes with a face on the largest
// triangle and a side along some edge, and that along the axes of the hull's space, the smallest is taken.
HullBox boxOf(const ConvexHull& hull) {
  HullBox box;
  box.centre = hull.centre;
  if (hull.vertices.empty() || !(hull.radius > 0.0) || !std::isfinite(hull.radius)) {
    return box;
  }
  std::vector<Vec3d> points;
  for (const Vec3d& vertex : hull.vertices) {
    points.push_back((vertex - hull.centre) / hull.radius);
  }
  box = boxAlong(points, box.axes);
  const auto consider = [&](const Vec3d& normal, const Vec3d& side) {
    const Vec3d along = unitOf(side - normal * dot(side, normal));
    if (normal == Vec3d() || along == Vec3d()) {
      return;
    }
    const HullBox other = boxAlong(points, {along, cross(normal, along), normal});
    box = sizeOf(other) < sizeOf(box) ? other : box;
  };
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  const HullFrame frame = hullFrame(points, all);
  const Vec3d normal = hull.dimension == 3    ? largestNormal(hull, points)
                       : frame.dimension >= 2 ? frame.normal
                       : frame.dimension == 1 ? acrossOf(frame.along)
                                              : Vec3d();
  consider(normal, frame.along);
  // Enough edges for any box, and for round hulls no more work than their vertices are worth.
  std::size_t tries = 16 + 4096 / points.size();
  for (std::uint32_t from = 0; from + 1 < hull.first_neighbour.size(); ++from) {
    for (std::uint32_t i = hull.first_neighbour[from]; i < hull.first_neighbour[from + 1] && tries > 0; ++i) {
      if (hull.neighbours[i] > from) {
        consider(normal, points[hull.neighbours[i]] - points[from]);
        --tries;
      }
    }
  }
  for (double& half : box.half) {
    half = half * hull.radius * (1.0 + 1e-12) + hull.slack;
  }
  box.centre = hull.centre + box.centre * hull.radius;
  return box;
}

Placement eroded(const Placement& placement, const HullBox& box, double by) {
  // Along each axis a point moves by at most this, so by at most the square root of 3 times this in all.
  const double step = by / (1.7320508 * stretchOf(placement));
  // The linear part of the squeeze, column by column.
  Vec3d x, y, z;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3d& a = box.axes[axis];
    const double scale = box.half[axis] > step ? 1.0 - step / box.half[axis] : 0.0;
    x += a * (a.x * scale);
    y += a * (a.y * scale);
    z += a * (a.z * scale);
  }
  const auto turned = [&](const Vec3d& v) {
    return placement.x * v.x + placement.y * v.y + placement.z * v.z;
  };
  const Vec3d& c = box.centre;
  return {turned(x), turned(y), turned(z), placement.point(c - (x * c.x + y * c.y + z * c.z))};
}

}  // namespace sightline::layers
