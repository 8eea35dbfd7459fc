#include "src/occlusion/polygons/shared_edges.h"

#include <algorithm>

namespace sightline::occlusion {

void ActivePolygons::begin(const OccluderSet& set) {
  polygons_.clear();
  number_of_.resize(std::max(number_of_.size(), set.occluders.size()), kNone);
}

void ActivePolygons::end() {
  for (const ActivePolygon& polygon : polygons_) {
    number_of_[polygon.seen.id.value] = kNone;
  }
}

void ActivePolygons::add(const EyeOccluder& seen, OccluderId chosen, double inset) {
  number_of_[seen.id.value] = size();
  polygons_.push_back({seen, chosen, inset, size()});
}

double ActivePolygons::commonClipDepth(double near) const {
  double depth = near * (1.0 + kDepthMargin);
  for (const ActivePolygon& polygon : polygons_) {
    if (polygon.seen.nearest < polygon.seen.clip_depth) {
      depth = std::max(depth, polygon.seen.clip_depth);
    }
  }
  return depth;
}

std::uint32_t ActivePolygons::groupOf(std::uint32_t number) {
  while (polygons_[number].group != number) {
    number = polygons_[number].group = polygons_[polygons_[number].group].group;
  }
  return number;
}

std::uint64_t ActivePolygons::joinAcross(const OccluderSet& set, const Eye& eye, std::uint32_t number,
                                         const Outline& outline) {
  const OccluderEdge& edge = set.edges[outline.edge];
  const std::uint64_t all = allMeshEdges(edge);
  if (edge.neighbour_count == 0 || edge.mesh_edge_count == 0 ||
      !set[polygons_[number].seen.id].watertight_edges) {
    return all;
  }
  // The plane through the eye and the edge, the polygon behind it. The length of its normal does not matter.
  Plane plane;
  plane.normal =
      eye.orthographic ? cross(eye.sight, outline.to - outline.from) : cross(outline.from, outline.to);
  plane.offset = eye.orthographic ? -dot(plane.normal, outline.from) : 0.0;
  if (!(plane.evaluate(polygons_[number].seen.centroid) < 0.0)) {
    return all;
  }
  return openMeshEdges(set, edge, plane, [&](OccluderId id) -> const Vec3d* {
    const std::uint32_t other = number_of_[id.value];
    if (other == kNone || !set[id].watertight_edges) {
      return nullptr;
    }
    const Vec3d& centroid = polygons_[other].seen.centroid;
    if (plane.evaluate(centroid) > 0.0) {
      polygons_[groupOf(other)].group = groupOf(number);
    }
    return &centroid;
  });
}

void appendOpenParts(const OccluderSet& set, const scene::PixelView& view, const EyeOccluder& seen,
                     std::uint32_t edge_index, std::uint64_t open, std::vector<CameraSegment>& parts) {
  const OccluderEdge& edge = set.edges[edge_index];
  const Occluder& occluder = set[seen.id];
  const std::uint32_t next =
      edge_index + 1 < occluder.first_vertex + occluder.vertex_count ? edge_index + 1 : occluder.first_vertex;
  const auto point = [&](std::uint32_t k) {
    const Vec3f& p = k == 0                     ? set.vertices[edge_index]
                     : k < edge.mesh_edge_count ? set.edge_vertices[edge.first_edge_vertex + k - 1]
                                                : set.vertices[next];
    return view.toCamera(Vec3d(p) - view.eye);
  };
  for (std::uint32_t k = 0; k < edge.mesh_edge_count; ++k) {
    if ((open >> k & 1) != 0) {
      const std::uint32_t first = k;
      while (k + 1 < edge.mesh_edge_count && (open >> (k + 1) & 1) != 0) {
        ++k;
      }
      parts.push_back({point(first), point(k + 1)});
    }
  }
}

}  // namespace sightline::occlusion
