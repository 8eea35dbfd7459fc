#include "src/pvs/bake/convex/convex_occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sightline/geometry/tolerance.h"

namespace sightline::pvs {
namespace {

// In units of the coordinates' magnitude: the part of a margin that covers all rounding of inset corners
// (2^-49).
constexpr double kMarginRounding = 0x1p-44;
// In units of the coordinates' magnitude: the rounding of a height above a plane, and of an inset corner.
constexpr double kHeightRounding = 0x1p-47;
// An occluder that shrinks by more than this fraction is not used.
constexpr double kMaxShrinking = 0.25;
constexpr double kRoundUp = 1.0 + 0x1p-30, kRoundDown = 1.0 - 0x1p-30;

// The smaller of two numbers; NaN if either is NaN.
double smaller(double a, double b) {
  return b < a || std::isnan(b) ? b : a;
}

// Returns a number that |x| + |y| + |z| of none of these points exceeds.
double sizeOf(std::span<const Vec3f> points) {
  Vec3d largest;
  for (const Vec3f& point : points) {
    largest = max(largest, abs(Vec3d(point)));
  }
  return l1Norm(largest) * kRoundUp;
}

Vec3d meanOf(std::span<const Vec3f> points) {
  Vec3d sum;
  for (const Vec3f& point : points) {
    sum += Vec3d(point);
  }
  return sum / static_cast<double>(points.size());
}

// The fraction by which a shape must shrink to lose `margin` if its centre is `depth` deep.
double shrinking(double margin, double depth) {
  return margin / depth * kRoundUp;
}

// Minimum distance from the centre, which lies in the plane, to the lines of a convex polygon's edges.
double depthIn(std::span<const Vec3d> corners, const Vec3d& normal, const Vec3d& centre) {
  double minimum = INFINITY;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d along = corners[(i + 1) % corners.size()] - corners[i];
    minimum = smaller(minimum, dot(cross(normal, along), centre - corners[i]) / length(along));
  }
  return minimum;
}

// Depths of a body, metres.
struct BodyDepth {
  double centre = INFINITY;  // minimum depth of the centre behind the planes of the faces
  double outside = 0.0;      // maximum height of a corner above one of them
};

BodyDepth depthIn(std::span<const BodyFace> faces, std::span<const Vec3f> vertices, const Vec3d& centre) {
  BodyDepth depth;
  for (const BodyFace& face : faces) {
    depth.centre = smaller(depth.centre, -face.plane.evaluate(centre));
    for (const Vec3f& vertex : vertices) {
      depth.outside = std::max(depth.outside, face.plane.evaluate(Vec3d(vertex)));
    }
  }
  return depth;
}

Box boundsOf(std::span<const Vec3f> points) {
  Box bounds;
  for (const Vec3f& point : points) {
    bounds.extend(point);
  }
  return bounds;
}

}  // namespace

bool ConvexOccluders::addPolygon(const OccluderSet& set, OccluderId id) {
  const Occluder& polygon = set[id];
  const std::span<const Vec3f> vertices = set.verticesOf(polygon);
  const Vec3d normal = polygon.plane.normal, mean = meanOf(vertices);
  const Vec3d centre = mean - normal * polygon.plane.evaluate(mean);
  const double size = sizeOf(vertices);
  std::array<Vec3d, 64> flat;  // the corners, projected onto the plane
  if (vertices.size() < 3 || vertices.size() > flat.size()) {
    return false;
  }
  double off_plane = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double height = dot(normal, Vec3d(vertices[i]) - centre);
    off_plane = std::max(off_plane, std::abs(height));
    flat[i] = Vec3d(vertices[i]) - normal * height;
  }
  const std::span<const Vec3d> corners(flat.data(), vertices.size());
  ConvexOccluder occluder;
  occluder.margin = 2.0 * static_cast<double>(polygon.slack) + off_plane + kMarginRounding * size;
  const double shrink = shrinking(occluder.margin, depthIn(corners, normal, centre));
  if (!(shrink > 0.0 && shrink <= kMaxShrinking)) {
    return false;
  }
  occluder.first_edge = static_cast<std::uint32_t>(edges_.size());
  occluder.first_face = static_cast<std::uint32_t>(faces_.size());
  occluder.edge_count = static_cast<std::uint16_t>(vertices.size());
  occluder.face_count = 1;
  occluder.double_sided = polygon.double_sided;
  occluder.id = id;
  occluder.object = polygon.object;
  occluder.bounds = boundsOf(vertices);
  occluder.area = static_cast<double>(polygon.area);
  occluder.size = size + occluder.margin;
  const auto drawn = [&](std::size_t i) {
    return centre + (corners[i % corners.size()] - centre) * (1.0 - shrink);
  };
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    edges_.push_back({drawn(i), drawn(i + 1) - drawn(i)});
  }
  const double rounding = kHeightRounding * size;
  faces_.push_back({polygon.plane, centre, -rounding, rounding});
  occluders_.push_back(occluder);
  return true;
}

bool ConvexOccluders::addBody(const OccluderSet& set, const OccluderBody& body) {
  const std::span<const Vec3f> vertices = set.verticesOf(body);
  const std::span<const BodyFace> faces = set.facesOf(body);
  const Vec3d centre = meanOf(vertices);
  const double size = sizeOf(vertices);
  const BodyDepth depth = depthIn(faces, vertices, centre);
  ConvexOccluder occluder;
  occluder.margin = 2.0 * static_cast<double>(body.slack) + kMarginRounding * size;
  const double shrink = shrinking(occluder.margin + depth.outside, depth.centre);
  if (!(shrink > 0.0 && shrink <= kMaxShrinking)) {
    return false;
  }
  occluder.first_edge = static_cast<std::uint32_t>(edges_.size());
  occluder.first_face = static_cast<std::uint32_t>(faces_.size());
  occluder.edge_count = body.edge_count;
  occluder.face_count = body.face_count;
  occluder.body = true;
  occluder.id = faces.front().occluder;
  occluder.object = set[occluder.id].object;
  occluder.bounds = body.bounds;
  occluder.size = size + occluder.margin;
  const auto drawn = [&](std::uint8_t vertex) {
    return centre + (Vec3d(vertices[vertex]) - centre) * (1.0 - shrink);
  };
  for (const BodyFace& face : faces) {
    const auto area = static_cast<double>(set[face.occluder].area);
    occluder.area = std::max(occluder.area, area);
    occluder.volume -= area * face.plane.evaluate(centre) / 3.0;
    faces_.push_back({face.plane, drawn(face.vertex)});
  }
  // Every corner of a face is an end point of one of its edges.
  const std::span<DrawnFace> drawn_faces = std::span(faces_).subspan(occluder.first_face);
  for (const BodyEdge& edge : set.edgesOf(body)) {
    edges_.push_back({drawn(edge.from), drawn(edge.to) - drawn(edge.from), edge.left, edge.right});
    for (const std::uint8_t side : {edge.left, edge.right}) {
      DrawnFace& face = drawn_faces[side];
      for (const std::uint8_t vertex : {edge.from, edge.to}) {
        const double height = dot(face.plane.normal, drawn(vertex) - face.base);
        face.min_height = std::min(face.min_height, height);
        face.max_height = std::max(face.max_height, height);
      }
    }
  }
  for (DrawnFace& face : drawn_faces) {
    face.min_height -= kHeightRounding * size;
    face.max_height += kHeightRounding * size;
  }
  occluders_.push_back(occluder);
  return true;
}

ConvexOccluders::ConvexOccluders(const OccluderSet& set) {
  std::vector<bool> in_body(set.occluders.size(), false);
  for (const OccluderBody& body : set.bodies) {
    if (addBody(set, body)) {
      for (const BodyFace& face : set.facesOf(body)) {
        in_body[face.occluder.value] = true;
      }
    }
  }
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    if (!in_body[i]) {
      addPolygon(set, OccluderId(i));
    }
  }
  std::sort(occluders_.begin(), occluders_.end(), [](const ConvexOccluder& a, const ConvexOccluder& b) {
    return std::tuple(-a.area, a.id.value) < std::tuple(-b.area, b.id.value);
  });
  // Keep their order, so that neighbours are close in memory.
  std::vector<DrawnEdge> edges;
  std::vector<DrawnFace> faces;
  edges.reserve(edges_.size());
  faces.reserve(faces_.size());
  for (ConvexOccluder& occluder : occluders_) {
    const std::span<const DrawnEdge> its_edges = edgesOf(occluder);
    const std::span<const DrawnFace> its_faces = facesOf(occluder);
    occluder.first_edge = static_cast<std::uint32_t>(edges.size());
    occluder.first_face = static_cast<std::uint32_t>(faces.size());
    edges.insert(edges.end(), its_edges.begin(), its_edges.end());
    faces.insert(faces.end(), its_faces.begin(), its_faces.end());
  }
  edges_ = std::move(edges);
  faces_ = std::move(faces);
}

namespace {

// Minimum height of the points above a plane, less its rounding.
double minHeight(const Plane& plane, double size, std::span<const Vec3d> points) {
  double minimum = INFINITY;
  for (const Vec3d& point : points) {
    minimum = smaller(minimum, plane.evaluate(point) - kHeightRounding * (l1Norm(point) + size));
  }
  return minimum;
}

// Distance of the points from a box along each axis, here negative where they overlap.
Vec3d gapsBetween(const Box& box, std::span<const Vec3d> points) {
  Vec3d low(INFINITY, INFINITY, INFINITY), high = -low;
  for (const Vec3d& point : points) {
    low = min(low, point);
    high = max(high, point);
  }
  return max(low - Vec3d(box.max), Vec3d(box.min) - high);
}

}  // namespace

bool separated(const ConvexOccluders& all, const ConvexOccluder& occluder, std::span<const Vec3d> corners,
               double near_distance) {
  if (corners.empty() || !std::ranges::all_of(corners, [](const Vec3d& p) { return isFinite(p); })) {
    return false;
  }
  const Vec3d gaps = gapsBetween(occluder.bounds, corners);
  double gap = occluder.body ? maxComponent(gaps) * kRoundDown : -INFINITY;  // of the best separating plane
  // A wide gap along an axis decides without the faces.
  if (gap - occluder.margin > std::max(near_distance, 0.0)) {
    return true;
  }
  for (const DrawnFace& face : all.facesOf(occluder)) {
    gap = std::max(gap, minHeight(face.plane, occluder.size, corners));
    if (occluder.double_sided) {
      gap = std::max(gap, minHeight(face.plane.flipped(), occluder.size, corners));
    }
  }
  // The margin exceeds the distance of the triangles from the planes and from the bounds.
  const double distance = std::max(gap, length(max(gaps, Vec3d())) * kRoundDown);
  return gap > occluder.margin && distance - occluder.margin > near_distance;
}

}  // namespace sightline::pvs
