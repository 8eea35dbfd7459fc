#include "src/occlusion/tree/occlusion_volume.h"

#include <algorithm>

namespace sightline::occlusion {

// Returns the shadow plane of an open edge, drawn in by the candidate's inset.
Plane VolumeBuilder::insetPlane(const EyeOccluder& candidate, const Outline& outline, double& sine) const {
  const Vec3d inwards = cross(candidate.support.normal, normalized(outline.to - outline.from));
  const Vec3d shift = inwards * candidate.inset;
  return eye.shadowPlane(outline.from + shift, outline.to + shift, sine);
}

// Whether drawing in the open edges leaves something of the polygon.
bool VolumeBuilder::fitsInset(const OccluderSet& set, const EyeOccluder& candidate) const {
  for (std::uint32_t side = 0; side < set[candidate.id].vertex_count; ++side) {
    double sine = 0.0;
    const Plane plane = insetPlane(candidate, outlineOf(eye, set, candidate, side), sine);
    if (!(sine > kShortestEdgeSine) || !(plane.evaluate(candidate.centroid) < 0.0)) {
      return false;
    }
  }
  return true;
}

PlaneRef VolumeBuilder::addPlane(const Plane& plane, double tolerance) {
  planes.push_back(plane);
  tolerances.push_back(tolerance);
  return PlaneRef::make(planes.size() - 1, false);
}

// Adds an edge of which some parts are shared and some open: a corner for each part, and a cut through each
// change. The change is moved into the shared part by the inset, so that it stays as far from open outlines
// as everything else. A shared part with no room for that counts as open, so it takes nothing from the
// others. False: no part is left that is shared, or there are too many, and nothing was added.
bool VolumeBuilder::addRuns(const OccluderSet& set, const EyeOccluder& candidate, const Outline& outline,
                            std::uint64_t open, PlaneRef on_line) {
  constexpr std::uint32_t kMaxCorners = 96;
  const OccluderEdge& edge = set.edges[outline.edge];
  const std::uint32_t n = edge.mesh_edge_count;
  const Vec3d along = normalized(outline.to - outline.from);
  // k counts in the direction of the outline: the mesh edges' own or, seen from the back, the opposite.
  const auto bit = [&](std::uint32_t k) { return std::uint64_t{1} << (candidate.flipped ? n - 1 - k : k); };
  const auto isOpen = [&](std::uint32_t k) { return (open & bit(k)) != 0; };
  const auto pointBefore = [&](std::uint32_t k) {  // before part k, k > 0
    return Vec3d(set.edge_vertices[edge.first_edge_vertex + (candidate.flipped ? n - 1 - k : k - 1)]) -
           eye.position;
  };
  std::uint32_t first = 0;  // of the run of parts that are alike
  double at = dot(along, outline.from);
  for (std::uint32_t k = 1; k <= n; ++k) {
    if (k < n && isOpen(k) == isOpen(k - 1)) {
      continue;
    }
    const double next = dot(along, k == n ? outline.to : pointBefore(k));
    if (!(next - at > 4.0 * candidate.inset)) {
      for (; first < k; ++first) {
        open |= bit(first);
      }
    }
    first = k;
    at = next;
  }
  if (open == allMeshEdges(edge)) {
    return false;
  }
  if (corners.size() + n > candidate_first_corner_ + kMaxCorners) {
    return false;
  }
  double sine = 0.0;
  const PlaneRef inset = addPlane(insetPlane(candidate, outline, sine));
  corners.push_back({outline.from, isOpen(0) ? inset : on_line, false, isOpen(0)});
  for (std::uint32_t k = 1; k < n; ++k) {
    if (isOpen(k) != isOpen(k - 1)) {
      const Vec3d change = pointBefore(k) + along * (isOpen(k) ? -candidate.inset : candidate.inset);
      corners.push_back({change, isOpen(k) ? inset : on_line, false, isOpen(k)});
      cuts.push_back(
          {static_cast<std::uint32_t>(volumes.size()), {along, -dot(along, change)}, inset, on_line});
    }
  }
  return true;
}

// Adds the corner at the start of an edge, with the edge's shadow plane: through the shared line where other
// volumes adjoin, drawn in where none does.
void VolumeBuilder::addEdge(const OccluderSet& set, const EyeOccluder& candidate, const Outline& outline) {
  if (const std::optional<SharedEdge> shared = sharedEdgeOf(eye, set, candidate, outline)) {
    const OccluderEdge& edge = set.edges[outline.edge];
    const auto centroidOf = [&](OccluderId id) -> const Vec3d* {
      const std::uint32_t other = candidate_of_[id.value];
      return other != kNone ? &candidates_[other].centroid : nullptr;
    };
    const std::uint64_t open = openMeshEdges(set, edge, shared->oriented(), centroidOf);
    if (open != allMeshEdges(edge)) {
      std::uint32_t& plane = plane_of_line_[edge.line];
      if (plane == kNone) {
        plane = addPlane(shared->plane).plane();
        used_lines_.push_back(edge.line);
      }
      tolerances[plane] = std::max(tolerances[plane], shared->tolerance);
      const PlaneRef ref = PlaneRef::make(plane, shared->flipped);
      if (open == 0) {
        corners.push_back({outline.from, ref, false});
        return;
      }
      if (addRuns(set, candidate, outline, open, ref)) {
        return;
      }
    }
  }
  double sine = 0.0;
  corners.push_back({outline.from, addPlane(insetPlane(candidate, outline, sine)), false, true});
}

// Clips away what lies before the depth (metres). Each new edge gets a plane of its own; there are two or
// more where an occluder that is flat up to its slack is nearly parallel to the near plane. Returns the new
// number of corners, 0 if the occluder cannot be used.
std::uint32_t VolumeBuilder::clipNear(std::uint32_t first, std::uint32_t count, double depth) {
  constexpr PlaneRef kCut{};  // until the edge has its plane
  clipped_.clear();
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
      clipped_.push_back(a_in ? Corner{crossing, kCut} : Corner{crossing, a.edge, false, a.open});
    }
  }
  for (std::size_t i = 0; i < clipped_.size(); ++i) {
    if (clipped_[i].edge.bits == kCut.bits) {
      double sine = 0.0;
      const Plane plane =
          eye.shadowPlane(clipped_[i].position, clipped_[(i + 1) % clipped_.size()].position, sine);
      if (!(sine > kShortestEdgeSine)) {
        return 0;
      }
      clipped_[i].edge = addPlane(plane);
    }
  }
  corners.resize(first);
  corners.insert(corners.end(), clipped_.begin(), clipped_.end());
  return static_cast<std::uint32_t>(clipped_.size());
}

void VolumeBuilder::addVolume(const OccluderSet& set, const EyeOccluder& candidate) {
  OcclusionVolume volume;
  volume.occluder = candidate.id;
  volume.support = candidate.support;
  volume.depth_slack = candidate.depth_slack;
  volume.centroid = candidate.centroid;
  volume.reach = candidate.reach;
  volume.first_corner = candidate_first_corner_ = static_cast<std::uint32_t>(corners.size());
  const std::size_t cuts_before = cuts.size();
  for (std::uint32_t side = 0; side < set[candidate.id].vertex_count; ++side) {
    addEdge(set, candidate, outlineOf(eye, set, candidate, side));
  }
  const auto count = static_cast<std::uint32_t>(corners.size()) - volume.first_corner;
  volume.corner_count = clipNear(volume.first_corner, count, candidate.clip_depth);
  if (volume.corner_count < 3) {
    corners.resize(volume.first_corner);
    cuts.resize(cuts_before);
    return;
  }
  reach = std::max(reach, volume.reach);
  volumes.push_back(volume);
}

void VolumeBuilder::build(const View& view, std::span<const ChosenOccluders> sets) {
  eye = Eye(view);
  volumes.clear();
  corners.clear();
  planes.clear();
  tolerances.clear();
  cuts.clear();
  volumes_of_set.clear();
  reach = 0.0;
  for (const ChosenOccluders& part : sets) {
    const std::size_t before = volumes.size();
    addSet(*part.set, part.chosen);
    volumes_of_set.push_back(volumes.size() - before);
  }
}

void VolumeBuilder::addSet(const OccluderSet& set, std::span<const OccluderId> chosen) {
  candidates_.clear();
  used_lines_.clear();
  candidate_of_.resize(std::max(candidate_of_.size(), set.occluders.size()), kNone);
  plane_of_line_.resize(std::max(plane_of_line_.size(), set.lines.size()), kNone);
  for (const OccluderId id : chosen) {
    if (id.value >= set.occluders.size() || candidate_of_[id.value] != kNone) {
      continue;
    }
    const std::optional<EyeOccluder> candidate = seeOccluder(eye, set, id);
    if (candidate && fitsInset(set, *candidate)) {
      candidate_of_[id.value] = static_cast<std::uint32_t>(candidates_.size());
      candidates_.push_back(*candidate);
    }
  }
  for (const EyeOccluder& candidate : candidates_) {
    addVolume(set, candidate);
  }
  for (const EyeOccluder& candidate : candidates_) {
    candidate_of_[candidate.id.value] = kNone;
  }
  for (const std::uint32_t line : used_lines_) {
    plane_of_line_[line] = kNone;
  }
}

}  // namespace sightline::occlusion
