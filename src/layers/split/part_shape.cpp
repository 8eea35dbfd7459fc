#include "src/layers/split/part_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "src/geometry/clip_convex.h"

namespace sightline::layers {
namespace {

constexpr std::size_t kManyPoints = 512;         // beyond, a cloud has the outermost corners alone
constexpr std::uint32_t kCloudDirections = 128;  // along which they are the outermost

std::vector<Vec3d> cornersOf(const std::vector<ShapePolygon>& polygons) {
  std::vector<Vec3d> points;
  for (const ShapePolygon& polygon : polygons) {
    points.insert(points.end(), polygon.begin(), polygon.end());
  }
  std::sort(points.begin(), points.end(), [](const Vec3d& a, const Vec3d& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// The farthest point along each of some directions, spread evenly over the sphere by the golden angle.
std::vector<Vec3d> outermost(const std::vector<Vec3d>& points) {
  std::vector<Vec3d> found;
  for (std::uint32_t i = 0; i < kCloudDirections; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCloudDirections, around = std::sqrt(1.0 - z * z);
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
    const Vec3d direction(around * std::cos(angle), around * std::sin(angle), z);
    std::size_t farthest = 0;
    double height = dot(direction, points[0]);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double other = dot(direction, points[k]);
      if (other > height) {
        height = other;
        farthest = k;
      }
    }
    found.push_back(points[farthest]);
  }
  return found;
}

// A hull without edges or faces, of which all vertices are compared. box: receives the box around the points
// along its axes.
ConvexHull cloudOf(std::vector<Vec3d> points, double slack, HullBox& box) {
  Vec3d low, high;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d at(dot(box.axes[0], points[i]), dot(box.axes[1], points[i]), dot(box.axes[2], points[i]));
    low = i == 0 ? at : min(low, at);
    high = i == 0 ? at : max(high, at);
  }
  box.centre = {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int k = static_cast<int>(axis);
    box.half[axis] = 0.5 * (high[k] - low[k]) * (1.0 + 1e-12);
    box.centre += box.axes[axis] * (0.5 * (low[k] + high[k]));
  }
  ConvexHull cloud;
  cloud.vertices = points.size() > kManyPoints ? outermost(points) : std::move(points);
  for (const Vec3d& vertex : cloud.vertices) {
    cloud.centre += vertex / static_cast<double>(cloud.vertices.size());
  }
  for (const Vec3d& vertex : cloud.vertices) {
    cloud.radius = std::max(cloud.radius, length(vertex - cloud.centre) * (1.0 + 1e-12));
  }
  cloud.slack = slack;
  return cloud;
}

void addCloud(std::vector<ShapePolygon> polygons, HullBox box, double slack, PartShape& shape) {
  ConvexHull cloud = cloudOf(cornersOf(polygons), slack, box);
  HullEnvelope envelope(cloud, box);
  shape.surface += surfaceOf(box);
  shape.bodies.push_back({std::move(polygons), std::move(cloud), box, envelope, slack});
}

// A polygon that lies in the plane is on both sides.
void divide(const ShapePolygon& polygon, const Plane& plane, std::vector<ShapePolygon>& in_front,
            std::vector<ShapePolygon>& behind) {
  const auto height = [&](const Vec3d& p) { return plane.evaluate(p); };
  const auto crossing = [](const Vec3d& p, const Vec3d& q, double height_p, double height_q) {
    return p + (q - p) * (height_p / (height_p - height_q));
  };
  geometry::DividedPolygon divided = geometry::divideConvex(polygon, height, crossing);
  if (divided.reaches_front || !divided.reaches_behind) {
    in_front.push_back(std::move(divided.front));
  }
  if (divided.reaches_behind || !divided.reaches_front) {
    behind.push_back(std::move(divided.behind));
  }
}

// A crossing is off by a few roundings of the coordinates.
double slackOfCut(const ConvexHull& hull) {
  return 0x1p-46 * (maxComponent(abs(hull.centre)) + hull.radius);
}

// The outline of a flat hull, whose vertices' neighbours go round it.
ShapePolygon outlineOf(const ConvexHull& hull) {
  ShapePolygon outline{hull.vertices[0]};
  std::uint32_t before = 0, at = hull.neighbours[hull.first_neighbour[0]];
  while (at != 0) {
    outline.push_back(hull.vertices[at]);
    const std::uint32_t one = hull.neighbours[hull.first_neighbour[at]];
    const std::uint32_t next = one != before ? one : hull.neighbours[hull.first_neighbour[at] + 1];
    before = std::exchange(at, next);
  }
  return outline;
}

}  // namespace

double surfaceOf(const HullBox& box) {
  return 8.0 * (box.half[0] * box.half[1] + box.half[1] * box.half[2] + box.half[2] * box.half[0]);
}

std::size_t PartShape::polygons() const {
  std::size_t count = 0;
  for (const ShapeBody& body : bodies) {
    count += body.polygons.size();
  }
  return count;
}

std::vector<ConvexSet> PartShape::placed(const Placement& placement, double erosion) const {
  std::vector<ConvexSet> sets;
  for (const ShapeBody& body : bodies) {
    ConvexSet& set = sets.emplace_back();
    set.hull = &body.hull;
    set.around = &body.envelope;
    set.placement = erosion > 0.0 ? eroded(placement, body.box, 0.5 * erosion) : placement;
  }
  return sets;
}

void addBody(const ConvexHull& hull, PartShape& shape) {
  std::vector<ShapePolygon> polygons;
  for (const auto& [a, b, c] : hull.triangles) {
    polygons.push_back({hull.vertices[a], hull.vertices[b], hull.vertices[c]});
  }
  if (hull.dimension == 2) {
    polygons.push_back(outlineOf(hull));
  } else if (hull.dimension < 2) {
    polygons.push_back(hull.vertices);
  }
  addCloud(std::move(polygons), boxOf(hull), hull.slack, shape);
}

void addBody(std::vector<ShapePolygon> polygons, PartShape& shape) {
  // The box of the hull is turned as the part is, which the axes of space are not.
  const Result<ConvexHull> hull = buildHull(cornersOf(polygons));
  addCloud(std::move(polygons), hull ? boxOf(*hull) : HullBox{}, 0.0, shape);
}

std::optional<ShapeHalves> halvesOf(const PartShape& shape, const Plane& plane) {
  ShapeHalves halves;
  for (const ShapeBody& body : shape.bodies) {
    std::vector<ShapePolygon> in_front, behind;
    for (const ShapePolygon& polygon : body.polygons) {
      divide(polygon, plane, in_front, behind);
    }
    const double slack = body.slack + slackOfCut(body.hull);
    if (!in_front.empty()) {
      addCloud(std::move(in_front), body.box, slack, halves.front);
    }
    if (!behind.empty()) {
      addCloud(std::move(behind), body.box, slack, halves.behind);
    }
  }
  return halves.front.bodies.empty() || halves.behind.bodies.empty() ? std::nullopt
                                                                     : std::optional(std::move(halves));
}

bool buildHulls(PartShape& shape) {
  for (ShapeBody& body : shape.bodies) {
    Result<ConvexHull> hull = buildHull(cornersOf(body.polygons));
    if (!hull) {
      return false;
    }
    body.hull = std::move(*hull);
    body.hull.slack += body.slack;
    body.box = boxOf(body.hull);
    body.envelope = HullEnvelope(body.hull, body.box);
  }
  return true;
}

}  // namespace sightline::layers
