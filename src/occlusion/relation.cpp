#include "src/occlusion/relation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/box_tangents.h"

namespace sightline::occlusion {
namespace {

using geometry::BoxTangents;

// The inset of planes that are kept is a power of two, so that it changes seldom, and at least this times the
// occluder's reach. See docs/conservative.md.
constexpr double kKeptInset = 0x1p-28;
// Rounding of a plane's value at the eye, times the occluder's reach: 16 times the bound.
constexpr double kPlaneValue = 0x1p-45;
// A box is compared with an occluder only while its rounding, this times its farthest corner, is below the
// inset.
constexpr double kFarBox = 0x1p-46;
// A plane that every eye satisfies.
constexpr double kAlways = 1e300;

// The line's plane through a vertex, normal of the length sin(beta); relative to the occluder's first vertex.
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

// The part of a polygon beyond the near plane, as a plane through the eye and the line where it is cut.
bool cutAtNear(const Eye& eye, const OccluderSet& set, Member& member) {
  Vec3d leaving, entering;
  bool leaves = false, enters = false;
  const std::uint32_t n = set[member.seen.id].vertex_count;
  for (std::uint32_t side = 0; side < n; ++side) {
    const Outline edge = outlineOf(eye, set, member.seen, side);
    const double a = dot(eye.forward, edge.from) - member.seen.clip_depth;
    const double b = dot(eye.forward, edge.to) - member.seen.clip_depth;
    if ((a >= 0.0) == (b >= 0.0)) {
      continue;
    }
    const Vec3d crossing = edge.from + (edge.to - edge.from) * (a / (a - b));
    (a >= 0.0 ? leaving : entering) = crossing;
    (a >= 0.0 ? leaves : enters) = true;
  }
  double sine = 0.0;
  member.near_cut = eye.shadowPlane(leaving, entering, sine);
  return leaves && enters && sine > kGrazingSine;
}

}  // namespace

std::optional<Member> makeMember(const Eye& eye, const OccluderSet& set, OccluderId id) {
  const std::optional<EyeOccluder> seen = seeOccluder(eye, set, id);
  if (!seen) {
    return std::nullopt;
  }
  const Occluder& occluder = set[id];
  Member member;
  member.seen = *seen;
  int exponent = 0;
  std::frexp(std::max(seen->inset, kKeptInset * seen->reach), &exponent);
  member.inset_exponent = static_cast<std::int16_t>(exponent);
  member.inset = std::ldexp(1.0, exponent);
  if (!(member.inset * member.inset < 0.01 * occluder.area)) {
    return std::nullopt;
  }
  member.origin = Vec3d(set.vertices[occluder.first_vertex]);
  member.eye = eye.orthographic ? -eye.forward : eye.position - member.origin;
  member.eye_w = eye.orthographic ? 0.0 : 1.0;
  member.threshold = kPlaneValue * (eye.orthographic ? 1.0 : seen->reach);
  member.edge_count = occluder.vertex_count;
  member.near_clipped = seen->nearest < seen->clip_depth;
  // A bit is needed for the cut.
  if (member.near_clipped && (member.edge_count > 63 || !cutAtNear(eye, set, member))) {
    return std::nullopt;
  }
  return member;
}

void appendInsetEdges(const OccluderSet& set, const Member& member, std::vector<InsetEdge>& edges) {
  const Occluder& occluder = set[member.seen.id];
  const auto corner = [&](std::uint32_t i) {
    return Vec3d(set.vertices[occluder.first_vertex + i % occluder.vertex_count]) - member.origin;
  };
  for (std::uint32_t e = 0; e < occluder.vertex_count; ++e) {
    const Vec3d direction = normalized(corner(e + 1) - corner(e));
    const Vec3d inwards = cross(occluder.plane.normal, direction);
    edges.push_back({corner(e) + inwards * member.inset, direction});
  }
}

PlaneSide sideOf(const Member& member, const Box& box) {
  const Vec3d low = Vec3d(box.min) - member.origin, high = Vec3d(box.max) - member.origin;
  const Vec3d& n = member.seen.support.normal;
  const Vec3d at_low{n.x * low.x, n.y * low.y, n.z * low.z},
      at_high{n.x * high.x, n.y * high.y, n.z * high.z};
  const Vec3d nearest = max(at_low, at_high), farthest = min(at_low, at_high);
  const double span = l1Norm(max(abs(low), abs(high)));
  const double margin = member.inset + kDepthMargin * span;
  if (farthest.x + farthest.y + farthest.z >= -margin) {
    return PlaneSide::kFront;
  }
  const bool behind = nearest.x + nearest.y + nearest.z < -margin && member.inset > kFarBox * span;
  return behind ? PlaneSide::kBehind : PlaneSide::kCrossing;
}

void makeRelation(const Member& member, std::span<const InsetEdge> edges, const Box& box, PlaneSide side,
                  TangentSearch search, Relation& relation, std::span<PlaneQuad> planes) {
  relation.occluder = member.seen.id;
  relation.inset_exponent = member.inset_exponent;
  relation.flipped = member.seen.flipped;
  relation.edge_count = static_cast<std::uint8_t>(edges.size());
  relation.behind = side == PlaneSide::kBehind;
  const Vec3d low = Vec3d(box.min) - member.origin, high = Vec3d(box.max) - member.origin;
  // Seen from the front the normal towards the eye is the polygon's own.
  const Vec3d front = member.seen.flipped ? -member.seen.support.normal : member.seen.support.normal;
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
      first = member.seen.flipped ? b.flipped() : a;
      second = member.seen.flipped ? a.flipped() : b;
    } else if (touched.exist) {
      // Of the two, those that have the occluder on the other side than the box.
      first = dot(front, at_a) > 0.0 ? a.flipped() : none;
      second = dot(front, at_b) < 0.0 ? b : none;
    }
    store(planes[e / 4], 0, e % 4, first);
    store(planes[e / 4], 1, e % 4, second);
  }
}

void evaluate(const Member& member, std::span<const PlaneQuad> planes, double path, Relation& relation) {
  const double sign = relation.behind ? 1.0 : -1.0;  // what "surely" means for the first plane of an edge
  double escaped = 0.0;  // how far the eye is outside the farthest separating plane
  double nearest = std::numeric_limits<double>::infinity();  // how near to any plane
  std::uint64_t satisfied = 0;
  for (std::uint32_t e = 0; e < relation.edge_count; e += 4) {
    const PlaneQuad& quad = planes[e / 4];
    double value[2][4];
    for (int which = 0; which < 2; ++which) {
      for (int lane = 0; lane < 4; ++lane) {
        value[which][lane] = quad.x[which][lane] * member.eye.x + quad.y[which][lane] * member.eye.y +
                             quad.z[which][lane] * member.eye.z + quad.offset[which][lane] * member.eye_w;
      }
    }
    const std::uint32_t lanes = std::min<std::uint32_t>(4, relation.edge_count - e);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const double first = value[0][lane] - sign * member.threshold,
                   second = value[1][lane] + member.threshold;
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
      path + clearance * (1.0 - 0x1p-20) - 0x1p-40 * (member.eye_w > 0.0 ? member.seen.reach : 1.0);
}

EyeShape eyeShapeOf(const Eye& eye, const Member& member, std::span<const InsetEdge> edges,
                    std::vector<EyeQuad>& quads) {
  const EyeOccluder& seen = member.seen;
  EyeShape shape{seen.support.normal, seen.support.offset, member.inset, seen.reach,
                 static_cast<std::uint32_t>(quads.size())};
  const auto add = [&](const Plane& plane) {
    const std::uint32_t lane = shape.plane_count++ % 4;
    if (lane == 0) {
      quads.emplace_back();
    }
    quads.back().x[lane] = plane.normal.x;
    quads.back().y[lane] = plane.normal.y;
    quads.back().z[lane] = plane.normal.z;
    quads.back().offset[lane] = plane.offset;
  };
  for (const InsetEdge& edge : edges) {
    // The edge runs the other way round for an eye behind the occluder's front.
    const Vec3d along = seen.flipped ? -edge.direction : edge.direction;
    const Vec3d from = edge.point + (member.origin - eye.position);
    double sine = 0.0;
    add(eye.shadowPlane(from, from + along * length(from), sine));
  }
  if (member.near_clipped) {
    add(member.near_cut);
  }
  return shape;
}

}  // namespace sightline::occlusion
