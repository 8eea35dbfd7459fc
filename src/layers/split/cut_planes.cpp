#include "src/layers/split/cut_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sightline::layers {
namespace {

constexpr std::size_t kManyTriangles = 20000;
// A plane along a neighbour's side leaves this share of its thickness free, so that what is beyond does not
// touch it.
constexpr double kClearance = 1e-3;

// The box around all bodies of a shape along the axes of its first body's box.
struct ShapeBox {
  std::array<Vec3d, 3> axes;
  Vec3d low, high;  // heights along the axes
};

ShapeBox shapeBoxOf(const PartShape& shape) {
  ShapeBox box{.axes = shape.bodies.front().box.axes, .low = {}, .high = {}};
  bool is_first = true;
  for (const ShapeBody& body : shape.bodies) {
    for (const Vec3d& vertex : body.hull.vertices) {
      const Vec3d at(dot(box.axes[0], vertex), dot(box.axes[1], vertex), dot(box.axes[2], vertex));
      box.low = is_first ? at : min(box.low, at);
      box.high = is_first ? at : max(box.high, at);
      is_first = false;
    }
  }
  return box;
}

void addOwnPlanes(const PartShape& shape, std::vector<Plane>& planes) {
  const ShapeBox box = shapeBoxOf(shape);
  const bool has_many = shape.polygons() > kManyTriangles;
  const double longest = maxComponent(box.high - box.low);
  for (int axis = 0; axis < 3; ++axis) {
    const double size = box.high[axis] - box.low[axis];
    const bool is_longest = size == longest;
    for (int eighth = 1; eighth < 8; ++eighth) {
      const bool is_middle = eighth == 4, is_quarter = eighth % 2 == 0;
      if (is_middle || (!has_many && (is_quarter || is_longest))) {
        const Vec3d& normal = box.axes[static_cast<std::size_t>(axis)];
        const double height = box.low[axis] + size * eighth / 8.0;
        planes.push_back({normal, -height});
      }
    }
  }
}

// A neighbour's planes across the thinnest axis of its box, taken to the part's space.
void addPlanesOf(const ConvexSet& neighbour, const Placement& placement, std::vector<Plane>& planes) {
  const HullBox box = boxOf(*neighbour.hull);
  const auto thinnest =
      static_cast<std::size_t>(std::min_element(box.half.begin(), box.half.end()) - box.half.begin());
  const auto direction = [&](std::size_t axis) {
    return neighbour.placement.point(box.axes[axis]) - neighbour.placement.origin;
  };
  const Vec3d normal = cross(direction((thinnest + 1) % 3), direction((thinnest + 2) % 3));
  for (const double side : {0.0, 1.0 + kClearance, -1.0 - kClearance}) {
    const Vec3d point =
        neighbour.placement.point(box.centre + box.axes[thinnest] * (box.half[thinnest] * side));
    // The heights above the plane, n . (x - p) with x = M q + o, as a function of the part's own q.
    const Vec3d in_part = placement.toHull(normal);
    const double size = length(in_part);
    if (std::isfinite(size) && size > 0.0) {
      planes.push_back({in_part / size, dot(normal, placement.origin - point) / size});
    }
  }
}

}  // namespace

std::vector<Plane> cutPlanes(const PartShape& shape, const Placement& placement,
                             std::span<const ConvexSet> neighbours) {
  std::vector<Plane> planes;
  if (shape.bodies.empty()) {
    return planes;
  }
  addOwnPlanes(shape, planes);
  if (shape.polygons() <= kManyTriangles) {
    for (const ConvexSet& neighbour : neighbours) {
      addPlanesOf(neighbour, placement, planes);
    }
  }
  return planes;
}

}  // namespace sightline::layers
