#include "occlusion/occlusion_volume.h"

#include <algorithm>

namespace sightline::occlusion_detail {
namespace {

// Seams that may appear to lie farther from their line than this (radians; orthographic: metres) are not
// closed.
constexpr double kWidestSeam = 0.01;

}  // namespace

Plane Eye::shadowPlane(const Vec3d& p, const Vec3d& q, double& sine) const {
  const Vec3d normal = orthographic ? cross(forward, q - p) : cross(p, q);
  const double l = length(normal);
  const double size = orthographic ? length(q - p) : length(p) * length(q);
  sine = size > 0.0 ? l / size : 0.0;
  Plane plane;
  plane.normal = l > 0.0 ? normal / l : Vec3d();
  plane.offset = orthographic ? -dot(plane.normal, p) : 0.0;
  return plane;
}

VolumeBuilder::Outline VolumeBuilder::outline(const OccluderSet& set, const Candidate& candidate,
                                              std::uint32_t side) const {
  const Occluder& occluder = set[candidate.id];
  const std::uint32_t n = occluder.vertex_count;
  // Seen from the back the corners run the other way round.
  const std::uint32_t a = candidate.flipped ? n - 1 - side : side;
  const std::uint32_t b = candidate.flipped ? (a + n - 1) % n : (a + 1) % n;
  const std::uint32_t edge = candidate.flipped ? b : a;
  const auto corner = [&](std::uint32_t i) {
    return Vec3d(set.vertices[occluder.first_vertex + i]) - eye.position;
  };
  return {corner(a), corner(b), occluder.first_vertex + edge};
}

// The shadow plane of an open edge, drawn in by the candidate's inset.
Plane VolumeBuilder::insetPlane(const Candidate& candidate, const Outline& outline, double& sine) const {
  const Vec3d inwards = cross(candidate.support.normal, normalized(outline.to - outline.from));
  const Vec3d shift = inwards * candidate.inset;
  return eye.shadowPlane(outline.from + shift, outline.to + shift, sine);
}

double VolumeBuilder::clipDepth(const Candidate& candidate) const {
  return eye.near + candidate.slack + kDepthMargin * (eye.near + candidate.reach);
}

// Whether the occluder can be used from here, and with which margins.
bool VolumeBuilder::examine(const OccluderSet& set, OccluderId id, Candidate& candidate) {
  const Occluder& occluder = set[id];
  candidate.id = id;
  candidate.centroid = Vec3d(occluder.centroid) - eye.position;
  const double height =
      -dot(occluder.plane.normal, Vec3d(set.vertices[occluder.first_vertex]) - eye.position);
  const double facing = eye.orthographic ? -dot(occluder.plane.normal, eye.forward) : height;
  candidate.flipped = facing < 0.0;
  if (candidate.flipped && !occluder.double_sided) {
    return false;
  }
  candidate.support = {occluder.plane.normal, height};
  if (candidate.flipped) {
    candidate.support = candidate.support.flipped();
  }
  double deepest = -1.0, farthest = 0.0;
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    const Vec3d r = Vec3d(vertex) - eye.position;
    candidate.reach = std::max(candidate.reach, magnitude(r));
    farthest = std::max(farthest, length(r));
    deepest = std::max(deepest, dot(eye.forward, r));
  }
  const double grazing = std::abs(facing) / (eye.orthographic ? 1.0 : farthest);
  if (!(grazing > kGrazingSine) || !std::isfinite(candidate.reach)) {
    return false;
  }
  candidate.slack = candidate.deviation = occluder.slack;
  if (!(deepest > clipDepth(candidate))) {
    return false;
  }
  // How far a point that is off by the slack may appear to move in the polygon's plane; a sharp corner of a
  // neighbour of three degrees costs a factor of twenty.
  double smallest_sine = 1.0;
  for (std::uint32_t side = 0; side < occluder.vertex_count; ++side) {
    double sine = 0.0;
    const Outline o = outline(set, candidate, side);
    eye.shadowPlane(o.from, o.to, sine);
    smallest_sine = std::min(smallest_sine, sine);
  }
  if (!(smallest_sine > kShortestEdgeSine)) {
    return false;
  }
  candidate.inset =
      (32.0 * candidate.slack + kEdgeMargin * candidate.reach * (1.0 + 0x1p-8 / smallest_sine)) / grazing;
  if (!(candidate.inset * candidate.inset < 0.0025 * occluder.area)) {
    return false;
  }
  for (std::uint32_t side = 0; side < occluder.vertex_count; ++side) {
    double sine = 0.0;
    const Plane plane = insetPlane(candidate, outline(set, candidate, side), sine);
    if (!(sine > kShortestEdgeSine) || !(plane.evaluate(candidate.centroid) < 0.0)) {
      return false;
    }
  }
  // What kEdgeMargin allows sideways becomes depth where the plane is seen at a grazing angle.
  candidate.slack = (4.0 * candidate.slack + kDepthMargin * 0x1p-8 * candidate.reach) / grazing;
  return true;
}

// The mesh edges of an edge beyond which no other volume begins, a bit each; beyond the others the seam lets
// nothing through.
std::uint64_t VolumeBuilder::openElements(const OccluderSet& set, const Candidate& candidate,
                                          const OccluderEdge& edge, const Plane& plane) const {
  std::uint64_t open = edge.chain >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge.chain) - 1;
  if (edge.chain == 0 || !set[candidate.id].seals) {
    return ~std::uint64_t{0};
  }
  for (const EdgeCover& cover : set.coversOf(edge)) {
    const std::uint32_t other = candidate_of_[cover.occluder.value];
    if (other != kNone && plane.evaluate(candidates_[other].centroid) > 0.0) {
      open &= ~(std::uint64_t{1} << cover.element);
    }
  }
  return open;
}

PlaneRef VolumeBuilder::addPlane(const Plane& plane, double tolerance) {
  planes.push_back(plane);
  tolerances.push_back(tolerance);
  return PlaneRef::make(planes.size() - 1, false);
}

// An edge of which some parts are sealed and some open: a corner for each part, and a cut through each
// change. The change is moved into the sealed part by the inset, so that this stays as far from open outlines
// as everything else. False: the parts are too short or too many, nothing was added.
bool VolumeBuilder::addRuns(const OccluderSet& set, const Candidate& candidate, const Outline& outline,
                            std::uint64_t open, PlaneRef on_line) {
  constexpr std::uint32_t kMaxCorners = 96;
  const OccluderEdge& edge = set.edges[outline.edge];
  const std::uint32_t n = edge.chain;
  const Vec3d along = normalized(outline.to - outline.from);
  // In the direction of the outline, which is the mesh edges' own or, seen from the back, the other.
  const auto isOpen = [&](std::uint32_t k) { return (open >> (candidate.flipped ? n - 1 - k : k) & 1) != 0; };
  const auto joint = [&](std::uint32_t k) {  // before part k, k > 0
    return Vec3d(set.joints[edge.first_joint + (candidate.flipped ? n - 1 - k : k - 1)]) - eye.position;
  };
  double at = dot(along, outline.from);
  const double end = dot(along, outline.to);
  for (std::uint32_t k = 1; k <= n; ++k) {
    const bool change = k == n || isOpen(k) != isOpen(k - 1);
    if (change) {
      const double next = k == n ? end : dot(along, joint(k));
      if (!(next - at > 4.0 * candidate.inset)) {
        return false;
      }
      at = next;
    }
  }
  if (corners.size() + n > candidate_first_corner_ + kMaxCorners) {
    return false;
  }
  double sine = 0.0;
  const PlaneRef inset = addPlane(insetPlane(candidate, outline, sine));
  corners.push_back({outline.from, isOpen(0) ? inset : on_line, false, isOpen(0)});
  for (std::uint32_t k = 1; k < n; ++k) {
    if (isOpen(k) != isOpen(k - 1)) {
      const Vec3d change = joint(k) + along * (isOpen(k) ? -candidate.inset : candidate.inset);
      corners.push_back({change, isOpen(k) ? inset : on_line, false, isOpen(k)});
      cuts.push_back({static_cast<std::uint32_t>(volumes.size()), {along, -dot(along, change)}});
    }
  }
  return true;
}

// How far the mesh's seam may appear to lie from its line: both occluders may be off by their slack. See
// VolumeBuilder::tolerances.
double VolumeBuilder::seamTolerance(const Candidate& candidate, const Outline& outline,
                                    double line_sine) const {
  const double rounding = 0x1p-49 / line_sine;
  if (eye.orthographic) {
    return 4.0 * candidate.deviation + rounding * candidate.reach;
  }
  const Vec3d along = outline.to - outline.from;
  const double t = std::clamp(-dot(outline.from, along) / dot(along, along), 0.0, 1.0);
  return 4.0 * candidate.deviation / length(outline.from + along * t) + rounding;
}

// The corner at the start of an edge, with the edge's shadow plane: on the seam's line where other volumes
// adjoin, drawn in where nothing does.
void VolumeBuilder::addEdge(const OccluderSet& set, const Candidate& candidate, const Outline& outline) {
  const OccluderEdge& edge = set.edges[outline.edge];
  double sine = 0.0;
  if (edge.cover_count != 0) {
    const auto& line = set.lines[edge.line];
    const Vec3d p = Vec3d(line[0]) - eye.position, q = Vec3d(line[1]) - eye.position;
    const Plane on_line = eye.shadowPlane(p, q, sine);
    const bool flipped = dot(q - p, outline.to - outline.from) < 0.0;
    const Plane oriented = flipped ? on_line.flipped() : on_line;
    const double tolerance = seamTolerance(candidate, outline, sine);
    if (sine > kShortestEdgeSine && tolerance < kWidestSeam && oriented.evaluate(candidate.centroid) < 0.0) {
      const std::uint64_t all = edge.chain >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edge.chain) - 1;
      const std::uint64_t open = openElements(set, candidate, edge, oriented);
      if ((open & all) != all) {
        std::uint32_t& plane = plane_of_line_[edge.line];
        if (plane == kNone) {
          plane = addPlane(on_line).plane();
          used_lines_.push_back(edge.line);
        }
        tolerances[plane] = std::max(tolerances[plane], tolerance);
        const PlaneRef ref = PlaneRef::make(plane, flipped);
        if (open == 0) {
          corners.push_back({outline.from, ref, false});
          return;
        }
        if (addRuns(set, candidate, outline, open, ref)) {
          return;
        }
      }
    }
  }
  corners.push_back({outline.from, addPlane(insetPlane(candidate, outline, sine)), false, true});
}

// Cuts away what lies before the depth. The new edge gets a plane of its own. Returns the new number of
// corners.
std::uint32_t VolumeBuilder::clipNear(std::uint32_t first, std::uint32_t count, double depth) {
  clipped_.clear();
  std::size_t cut = clipped_.size();
  bool has_cut = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Corner& a = corners[first + i];
    const Corner& b = corners[first + (i + 1) % count];
    const double da = dot(eye.forward, a.position) - depth, db = dot(eye.forward, b.position) - depth;
    const bool a_in = da >= 0.0, b_in = db >= 0.0;
    if (a_in) {
      clipped_.push_back(a);
    }
    if (a_in != b_in) {
      const Vec3d crossing = a.position + (b.position - a.position) * (da / (da - db));
      if (a_in) {
        cut = clipped_.size();
        has_cut = true;
      }
      clipped_.push_back({crossing, a.edge, false, a.open});
    }
  }
  if (has_cut) {
    const Vec3d& p = clipped_[cut].position;
    const Vec3d& q = clipped_[(cut + 1) % clipped_.size()].position;
    double sine = 0.0;
    const Plane plane = eye.shadowPlane(p, q, sine);
    if (!(sine > kShortestEdgeSine)) {
      return 0;
    }
    clipped_[cut].edge = addPlane(plane);
    clipped_[cut].open = false;
  }
  corners.resize(first);
  corners.insert(corners.end(), clipped_.begin(), clipped_.end());
  return static_cast<std::uint32_t>(clipped_.size());
}

void VolumeBuilder::addVolume(const OccluderSet& set, const Candidate& candidate) {
  OcclusionVolume volume;
  volume.occluder = candidate.id;
  volume.support = candidate.support;
  volume.depth_slack = candidate.slack;
  volume.centroid = candidate.centroid;
  volume.reach = candidate.reach;
  volume.first_corner = candidate_first_corner_ = static_cast<std::uint32_t>(corners.size());
  const std::size_t cuts_before = cuts.size();
  for (std::uint32_t side = 0; side < set[candidate.id].vertex_count; ++side) {
    addEdge(set, candidate, outline(set, candidate, side));
  }
  const auto count = static_cast<std::uint32_t>(corners.size()) - volume.first_corner;
  volume.corner_count = clipNear(volume.first_corner, count, clipDepth(candidate));
  if (volume.corner_count < 3) {
    corners.resize(volume.first_corner);
    cuts.resize(cuts_before);
    return;
  }
  reach = std::max(reach, volume.reach);
  volumes.push_back(volume);
}

void VolumeBuilder::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen) {
  eye = {view.eye, view.forward, view.near, view.orthographic};
  volumes.clear();
  corners.clear();
  planes.clear();
  tolerances.clear();
  cuts.clear();
  candidates_.clear();
  used_lines_.clear();
  reach = 0.0;
  candidate_of_.resize(std::max(candidate_of_.size(), set.occluders.size()), kNone);
  plane_of_line_.resize(std::max(plane_of_line_.size(), set.lines.size()), kNone);
  for (const OccluderId id : chosen) {
    Candidate candidate;
    if (id.value < set.occluders.size() && candidate_of_[id.value] == kNone && examine(set, id, candidate)) {
      candidate_of_[id.value] = static_cast<std::uint32_t>(candidates_.size());
      candidates_.push_back(candidate);
    }
  }
  for (const Candidate& candidate : candidates_) {
    addVolume(set, candidate);
  }
  for (const Candidate& candidate : candidates_) {
    candidate_of_[candidate.id.value] = kNone;
  }
  for (const std::uint32_t line : used_lines_) {
    plane_of_line_[line] = kNone;
  }
}

}  // namespace sightline::occlusion_detail
