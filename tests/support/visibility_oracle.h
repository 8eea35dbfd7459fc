#pragma once

// An independent brute-force test of whether some point of a box is visible, for scenes of a few polygons. It
// casts rays from the eye to points on the box against every polygon. A ray near an edge, or a point near a
// polygon, is left undecided; only results that are beyond doubt count against the code under test.

#include <random>
#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/math/frustum.h"
#include "sightline/scene/camera.h"

namespace sightline::test {

struct OraclePolygon {
  std::vector<Vec3f> vertices;  // counter-clockwise as seen from the front
  bool double_sided = false;
};

enum class RayAnswer { kClear, kBlocked, kUndecided };

// A polygon with what does not depend on the ray: its normal, and of each edge the direction inwards.
struct PreparedPolygon {
  struct Edge {
    Vec3d corner, inwards;
  };

  explicit PreparedPolygon(const OraclePolygon& polygon)
      : origin(polygon.vertices[0]), double_sided(polygon.double_sided) {
    const std::size_t n = polygon.vertices.size();
    for (std::size_t i = 1; i + 1 < n; ++i) {
      normal += cross(Vec3d(polygon.vertices[i]) - origin, Vec3d(polygon.vertices[i + 1]) - origin);
    }
    normal = normalized(normal);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d a(polygon.vertices[i]), b(polygon.vertices[(i + 1) % n]);
      edges.push_back({a, normalized(cross(normal, b - a))});
    }
  }

  Vec3d origin, normal;
  bool double_sided = false;
  std::vector<Edge> edges;
};

// Tests the segment from `from` to `to` against one polygon. margin: relative distance within which the
// result is undecided.
inline RayAnswer castAt(const PreparedPolygon& polygon, const Vec3d& from, const Vec3d& to, double near_depth,
                        const Vec3d& forward, double margin = 1e-10) {
  const double size = length(from - polygon.origin) + length(to - polygon.origin);
  const double before = dot(polygon.normal, from - polygon.origin),
               after = dot(polygon.normal, to - polygon.origin);
  if (std::abs(before) < margin * size || std::abs(after) < margin * size) {
    return RayAnswer::kUndecided;
  }
  if ((before > 0.0) == (after > 0.0)) {
    return RayAnswer::kClear;
  }
  const Vec3d direction = to - from;
  const Vec3d hit = from + direction * (before / (before - after));
  bool inside = true, undecided = false;
  for (const PreparedPolygon::Edge& edge : polygon.edges) {
    const double d = dot(edge.inwards, hit - edge.corner);
    undecided |= std::abs(d) < margin * size;
    inside &= d > 0.0;
  }
  if (undecided) {
    return RayAnswer::kUndecided;
  }
  if (!inside || (before < 0.0 && !polygon.double_sided)) {
    return RayAnswer::kClear;
  }
  const double depth = dot(forward, hit - from);
  if (std::abs(depth - near_depth) < 1e-9 * (1.0 + near_depth)) {
    return RayAnswer::kUndecided;
  }
  return depth > near_depth ? RayAnswer::kBlocked : RayAnswer::kClear;
}

inline std::vector<PreparedPolygon> prepared(std::span<const OraclePolygon> polygons) {
  return {polygons.begin(), polygons.end()};
}

inline RayAnswer castAtAll(std::span<const PreparedPolygon> polygons, const View& view, const Vec3d& target) {
  const Vec3d from =
      view.orthographic ? target - view.forward * dot(view.forward, target - view.eye) : view.eye;
  RayAnswer answer = RayAnswer::kClear;
  for (const PreparedPolygon& polygon : polygons) {
    const RayAnswer one = castAt(polygon, from, target, view.z_near, view.forward);
    if (one == RayAnswer::kBlocked) {
      return one;
    }
    if (one == RayAnswer::kUndecided) {
      answer = one;
    }
  }
  return answer;
}

inline RayAnswer castAtAll(std::span<const OraclePolygon> polygons, const View& view, const Vec3d& target) {
  return castAtAll(prepared(polygons), view, target);
}

inline bool insideView(const Frustum& frustum, const Vec3d& point) {
  for (const Plane& plane : frustum.planes) {
    if (plane.evaluate(point) < 1e-9 * (1.0 + length(point))) {
      return false;
    }
  }
  return true;
}

inline bool insideView(const View& view, const Vec3d& point) {
  return insideView(frustumOf(view), point);
}

struct Sight {
  bool seen = false;  // true if a point is visible beyond doubt
  Vec3d point;
  bool blocked = true;  // true if every sampled ray was blocked beyond doubt, or its point is out of view
};

// Tests `samples` random points of the box's surface, including its corners and points on its edges.
inline Sight lookAt(const Box& box, const View& view, std::span<const PreparedPolygon> polygons, int samples,
                    std::mt19937_64& random) {
  const Frustum frustum = frustumOf(view);
  Sight sight;
  for (int s = 0; s < samples; ++s) {
    Vec3d t;
    for (int axis = 0; axis < 3; ++axis) {
      t[axis] = static_cast<double>(random() >> 11) * 0x1p-53;
      if (random() % 3 == 0) {
        t[axis] = static_cast<double>(random() % 2);
      }
    }
    t[static_cast<int>(random() % 3)] = static_cast<double>(random() % 2);
    Vec3d point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = box.min[axis] + t[axis] * (static_cast<double>(box.max[axis]) - box.min[axis]);
    }
    if (!insideView(frustum, point)) {
      continue;
    }
    const RayAnswer answer = castAtAll(polygons, view, point);
    sight.blocked &= answer == RayAnswer::kBlocked;
    if (answer == RayAnswer::kClear) {
      sight.seen = true;
      sight.point = point;
      return sight;
    }
  }
  return sight;
}

inline Sight lookAt(const Box& box, const View& view, std::span<const OraclePolygon> polygons, int samples,
                    std::mt19937_64& random) {
  return lookAt(box, view, prepared(polygons), samples, random);
}

}  // namespace sightline::test
