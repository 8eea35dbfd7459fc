#include "src/occlusion/eye_occluder.h"

#include <algorithm>
#include <limits>

namespace sightline::occlusion {
namespace {

// Edges of the mesh that may appear to lie farther from the shared line than this (radians; orthographic:
// metres) are not shared.
constexpr double kMaxSharedEdgeWidth = 0.01;

// Returns how far the mesh's own edge may appear to lie from the shared line: both occluders may be off by
// their slack.
double sharedEdgeTolerance(const Eye& eye, const EyeOccluder& occluder, const Outline& outline,
                           double line_sine) {
  const double rounding = 0x1p-49 / line_sine;
  if (eye.orthographic) {
    return 4.0 * occluder.deviation + rounding * occluder.reach;
  }
  const Vec3d along = outline.to - outline.from;
  const double t = std::clamp(-dot(outline.from, along) / dot(along, along), 0.0, 1.0);
  return 4.0 * occluder.deviation / length(outline.from + along * t) + rounding;
}

}  // namespace

Plane Eye::shadowPlane(const Vec3d& p, const Vec3d& q, double& sine) const {
  const Vec3d normal = orthographic ? cross(sight, q - p) : cross(p, q);
  const double l = length(normal);
  const double size = orthographic ? length(q - p) : length(p) * length(q);
  sine = size > 0.0 ? l / size : 0.0;
  Plane plane;
  plane.normal = l > 0.0 ? normal / l : Vec3d();
  plane.offset = orthographic ? -dot(plane.normal, p) : 0.0;
  return plane;
}

Outline outlineOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& seen, std::uint32_t side) {
  const Occluder& occluder = set[seen.id];
  const std::uint32_t n = occluder.vertex_count;
  // Seen from the back the corners run the other way round.
  const std::uint32_t a = seen.flipped ? n - 1 - side : side;
  const std::uint32_t b = seen.flipped ? (a + n - 1) % n : (a + 1) % n;
  const std::uint32_t edge = seen.flipped ? b : a;
  const auto corner = [&](std::uint32_t i) {
    return Vec3d(set.vertices[occluder.first_vertex + i]) - eye.position;
  };
  return {corner(a), corner(b), occluder.first_vertex + edge};
}

std::optional<EyeOccluder> faceOccluder(const Eye& eye, const OccluderSet& set, OccluderId id) {
  const Occluder& occluder = set[id];
  EyeOccluder seen;
  seen.id = id;
  seen.centroid = Vec3d(occluder.centroid) - eye.position;
  const double height =
      -dot(occluder.plane.normal, Vec3d(set.vertices[occluder.first_vertex]) - eye.position);
  const double facing = eye.orthographic ? -dot(occluder.plane.normal, eye.sight) : height;
  seen.flipped = facing < 0.0;
  if (seen.flipped && !occluder.double_sided) {
    return std::nullopt;
  }
  seen.support = {occluder.plane.normal, height};
  if (seen.flipped) {
    seen.support = seen.support.flipped();
  }
  double deepest = -1.0, farthest = 0.0;
  seen.nearest = std::numeric_limits<double>::infinity();
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    const Vec3d r = Vec3d(vertex) - eye.position;
    const double depth = dot(eye.forward, r);
    seen.reach = std::max(seen.reach, l1Norm(r));
    farthest = std::max(farthest, length(r));
    deepest = std::max(deepest, depth);
    seen.nearest = std::min(seen.nearest, depth);
  }
  seen.grazing = std::abs(facing) / (eye.orthographic ? 1.0 : farthest);
  if (!(seen.grazing > kGrazingSine) || !std::isfinite(seen.reach)) {
    return std::nullopt;
  }
  seen.deviation = occluder.slack;
  seen.depth_slack = depthSlack(seen.deviation, seen.reach, seen.grazing);
  seen.clip_depth = clipDepth(eye.near, seen.depth_slack, seen.reach);
  if (!(deepest > seen.clip_depth)) {
    return std::nullopt;
  }
  return seen;
}

bool keepsShape(const Occluder& occluder, double inset) {
  return inset * inset < 0.0025 * occluder.area;
}

std::optional<EyeOccluder> seeOccluder(const Eye& eye, const OccluderSet& set, OccluderId id) {
  std::optional<EyeOccluder> seen = faceOccluder(eye, set, id);
  if (!seen) {
    return std::nullopt;
  }
  double smallest_sine = 1.0;
  for (std::uint32_t side = 0; side < set[id].vertex_count; ++side) {
    double sine = 0.0;
    const Outline outline = outlineOf(eye, set, *seen, side);
    eye.shadowPlane(outline.from, outline.to, sine);
    smallest_sine = std::min(smallest_sine, sine);
  }
  seen->inset = outlineInset(seen->deviation, seen->reach * (1.0 + 0x1p-8 / smallest_sine), seen->grazing);
  if (!(smallest_sine > kShortestEdgeSine) || !keepsShape(set[id], seen->inset)) {
    return std::nullopt;
  }
  return seen;
}

std::optional<SharedEdge> sharedEdgeOf(const Eye& eye, const OccluderSet& set, const EyeOccluder& seen,
                                       const Outline& outline) {
  const OccluderEdge& edge = set.edges[outline.edge];
  if (edge.neighbour_count == 0 || edge.mesh_edge_count == 0 || !set[seen.id].watertight_edges) {
    return std::nullopt;
  }
  const auto& line = set.lines[edge.line];
  const Vec3d p = Vec3d(line[0]) - eye.position, q = Vec3d(line[1]) - eye.position;
  double sine = 0.0;
  SharedEdge shared;
  shared.plane = eye.shadowPlane(p, q, sine);
  shared.flipped = dot(q - p, outline.to - outline.from) < 0.0;
  shared.tolerance = sharedEdgeTolerance(eye, seen, outline, sine);
  if (!(sine > kShortestEdgeSine) || !(shared.tolerance < kMaxSharedEdgeWidth) ||
      !(shared.oriented().evaluate(seen.centroid) < 0.0)) {
    return std::nullopt;
  }
  return shared;
}

}  // namespace sightline::occlusion
