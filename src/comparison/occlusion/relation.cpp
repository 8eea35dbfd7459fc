#include "src/comparison/occlusion/relation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/box_tangents.h"

namespace sightline::comparison {

using namespace occlusion;
namespace {

using geometry::BoxTangents;

// A value at the eye below this times the occluder's reach may be rounding, of which this is 16 times the
// bound.
constexpr double kPlaneValue = 0x1p-45;
// A box is compared with an occluder only while its rounding, this times its farthest corner, is below the
// inset.
constexpr double kFarBox = 0x1p-46;
// A plane that every eye satisfies.
constexpr double kAlways = 1e300;

// Returns the plane through the edge's line and a vertex, with a normal of the length sin(beta), relative to
// the occluder's first vertex.
Plane planeThrough(const InsetEdge& edge, const Vec3d& vertex_from_edge) {
  const double l = length(vertex_from_edge);
  Plane plane;
  plane.normal = cross(edge.direction, vertex_from_edge) / (l > 0.0 ? l : 1.0);
  plane.offset = -dot(plane.normal, edge.point);
  return plane;
}

void store(PlaneQuad& quad, std::uint32_t which, std::uint32_t lane, const Plane& plane) {
  quad.x[which][lane] = plane.normal.x;
  quad.y[which][lane] = plane.normal.y;
  quad.z[which][lane] = plane.normal.z;
  quad.offset[which][lane] = plane.offset;
}

}  // namespace

PlaneSide sideOf(const ActiveOccluder& occluder, const Box& box) {
  const Vec3d low = Vec3d(box.min) - occluder.origin, high = Vec3d(box.max) - occluder.origin;
  const Vec3d& n = occluder.seen.support.normal;
  const Vec3d at_low{n.x * low.x, n.y * low.y, n.z * low.z},
      at_high{n.x * high.x, n.y * high.y, n.z * high.z};
  const Vec3d nearest = max(at_low, at_high), farthest = min(at_low, at_high);
  const double span = l1Norm(max(abs(low), abs(high)));
  const double margin = occluder.inset + kDepthMargin * span;
  if (farthest.x + farthest.y + farthest.z >= -margin) {
    return PlaneSide::kFront;
  }
  const bool behind = nearest.x + nearest.y + nearest.z < -margin && occluder.inset > kFarBox * span;
  return behind ? PlaneSide::kBehind : PlaneSide::kCrossing;
}

void makeRelation(const ActiveOccluder& occluder, std::span<const InsetEdge> edges, const Box& box,
                  PlaneSide side, TangentSearch search, Relation& relation, std::span<PlaneQuad> planes) {
  relation.occluder = occluder.seen.id;
  relation.inset_exponent = occluder.inset_exponent;
  relation.flipped = occluder.seen.flipped;
  relation.edge_count = static_cast<std::uint8_t>(edges.size());
  relation.behind = side == PlaneSide::kBehind;
  const Vec3d low = Vec3d(box.min) - occluder.origin, high = Vec3d(box.max) - occluder.origin;
  // Seen from the front the normal towards the eye is the polygon's own.
  const Vec3d front = occluder.seen.flipped ? -occluder.seen.support.normal : occluder.seen.support.normal;
  const Plane none{{}, relation.behind ? 0.0 : kAlways};
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Vec3d from = low - edges[e].point, to = high - edges[e].point;
    const BoxTangents touched = search == TangentSearch::kTables
                                    ? geometry::tangentsByTables(from, to, edges[e].direction)
                                    : geometry::tangentsOfAllVertices(from, to, edges[e].direction);
    // The box lies in front of `a` and behind `b`.
    const Vec3d at_a = geometry::cornerOf(from, to, touched.low),
                at_b = geometry::cornerOf(from, to, touched.high);
    const Plane a = planeThrough(edges[e], at_a), b = planeThrough(edges[e], at_b);
    Plane first = none, second = none;
    if (touched.exist && relation.behind) {
      // The occluder lies in front of both where the box is behind its front, else behind both.
      first = occluder.seen.flipped ? b.flipped() : a;
      second = occluder.seen.flipped ? a.flipped() : b;
    } else if (touched.exist) {
      // A plane separates only if it has the occluder on the other side than the box.
      first = dot(front, at_a) > 0.0 ? a.flipped() : none;
      second = dot(front, at_b) < 0.0 ? b : none;
    }
    store(planes[e / 4], 0, e % 4, first);
    store(planes[e / 4], 1, e % 4, second);
  }
}

void evaluate(const Eye& eye, const ActiveOccluder& occluder, std::span<const PlaneQuad> planes, double path,
              Relation& relation) {
  // The eye relative to the occluder's first vertex; orthographic: the direction to it, with weight 0.
  const Vec3d at = eye.orthographic ? -eye.sight : eye.position - occluder.origin;
  const double weight = eye.orthographic ? 0.0 : 1.0;
  const double threshold = kPlaneValue * (eye.orthographic ? 1.0 : occluder.seen.reach);
  const double sign = relation.behind ? 1.0 : -1.0;  // what "surely" means for the first plane of an edge
  double escaped = 0.0;  // how far the eye is outside the farthest separating plane
  double nearest = std::numeric_limits<double>::infinity();  // how near to any plane
  std::uint64_t satisfied = 0;
  for (std::uint32_t e = 0; e < relation.edge_count; e += 4) {
    const PlaneQuad& quad = planes[e / 4];
    double value[2][4];
    for (int which = 0; which < 2; ++which) {
      for (int lane = 0; lane < 4; ++lane) {
        value[which][lane] = quad.x[which][lane] * at.x + quad.y[which][lane] * at.y +
                             quad.z[which][lane] * at.z + quad.offset[which][lane] * weight;
      }
    }
    const std::uint32_t lanes = std::min<std::uint32_t>(4, relation.edge_count - e);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const double first = value[0][lane] - sign * threshold, second = value[1][lane] + threshold;
      nearest = std::min(nearest, std::min(std::abs(first), std::abs(second)));
      escaped = std::max(escaped, std::max(-second, relation.behind ? 0.0 : -first));
      satisfied |= (first > 0.0 ? std::uint64_t{1} : 0) << (e + lane);
    }
  }
  relation.touches = !(escaped > 0.0);
  relation.satisfied = relation.behind && relation.touches ? satisfied : 0;
  // The values change by no more than the eye moves, their rounding and thresholds by far less than this.
  const double clearance = relation.touches ? nearest : escaped;
  relation.until =
      path + clearance * (1.0 - 0x1p-20) - 0x1p-40 * (eye.orthographic ? 1.0 : occluder.seen.reach);
}

}  // namespace sightline::comparison
