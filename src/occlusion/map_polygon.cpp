#include "src/occlusion/map_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/clip_convex.h"

namespace sightline::occlusion {
namespace {

// The half-spaces of what is drawn, affine in camera space; positive inside.
struct MapVolume {
  // Polygons are cut so many widths and heights of the map beyond its borders, so that map coordinates stay
  // small.
  static constexpr double kBeyond = 1.0;
  static constexpr int kPlanes = 5;
  static constexpr int kNear = 0;

  MapVolume(const PixelView& view, double clip_depth, double beyond)
      : half_width((1.0 + 2.0 * beyond) * view.middle_x),
        half_height((1.0 + 2.0 * beyond) * view.middle_y),
        scale_x(view.scale_x),
        scale_y(view.scale_y),
        depth(clip_depth),
        orthographic(view.orthographic) {}

  double distance(int plane, const Vec3d& c) const {
    const double w = orthographic ? 1.0 : c.z;
    switch (plane) {
      case kNear:
        return c.z - depth;
      case 1:
        return half_width * w + scale_x * c.x;
      case 2:
        return half_width * w - scale_x * c.x;
      case 3:
        return half_height * w + scale_y * c.y;
      default:
        return half_height * w - scale_y * c.y;
    }
  }
  // A bit for each plane that the point is beyond.
  unsigned outside(const Vec3d& c) const {
    const double w = orthographic ? 1.0 : c.z;
    const double x = scale_x * c.x, y = scale_y * c.y, right = half_width * w, top = half_height * w;
    return (c.z < depth ? 1u : 0u) | (x < -right ? 2u : 0u) | (x > right ? 4u : 0u) | (y < -top ? 8u : 0u) |
           (y > top ? 16u : 0u);
  }

  double half_width, half_height, scale_x, scale_y, depth;
  bool orthographic;
};

constexpr float kWholeMap = 1e9f;  // pixels

MapEdge edgeBetween(const MapPoint& a, const MapPoint& b, EdgeKind kind, float margin) {
  const bool rises = b.y > a.y;
  const MapPoint &low = rises ? a : b, &high = rises ? b : a;
  MapEdge edge;
  edge.low = static_cast<float>(low.y);
  edge.high = static_cast<float>(high.y);
  edge.left = static_cast<float>(std::min(a.x, b.x));
  edge.right = static_cast<float>(std::max(a.x, b.x));
  edge.x_at_low = static_cast<float>(low.x);
  edge.margin = margin;
  edge.kind = kind;
  if (!edge.flat()) {
    edge.slope = static_cast<float>((high.x - low.x) / (high.y - low.y));
    edge.side = rises ? 1 : -1;
  }
  return edge;
}

}  // namespace

std::uint32_t MapPolygons::rootOf(std::uint32_t member) {
  while (members_[member].group != member) {
    member = members_[member].group = members_[members_[member].group].group;
  }
  return member;
}

// Bodies are drawn at once, all others become members.
void MapPolygons::takeMembers(const OccluderSet& set, std::span<const OccluderId> chosen,
                              const RasterSettings& settings) {
  members_.clear();
  member_of_.resize(std::max(member_of_.size(), set.occluders.size()), kNone);
  body_met_.resize(std::max(body_met_.size(), set.bodies.size()), false);
  for (const OccluderId id : chosen) {
    if (id.value >= set.occluders.size() || member_of_[id.value] != kNone) {
      continue;
    }
    const OccluderBody* body = settings.coverage == Coverage::kInner ? set.bodyOf(id) : nullptr;
    if (body == nullptr) {
      ++considered;
      addMember(set, id, id);
      continue;
    }
    const auto number = static_cast<std::uint32_t>(body - set.bodies.data());
    if (!body_met_[number]) {
      ++considered;
      body_met_[number] = true;
      bodies_met_.push_back(number);
      if (!addBody(set, id, *body, settings)) {
        for (const BodyFace& face : set.facesOf(*body)) {
          addMember(set, face.occluder, id);
        }
      }
    }
  }
  for (const std::uint32_t body : bodies_met_) {
    body_met_[body] = false;
  }
  bodies_met_.clear();
}

void MapPolygons::addMember(const OccluderSet& set, OccluderId id, OccluderId chosen) {
  const std::optional<EyeOccluder> seen = faceOccluder(eye_, set, id);
  const double inset = seen ? outlineInset(seen->deviation, seen->reach, seen->grazing) : 0.0;
  // What it may be off must be less than what is drawn beyond the map.
  if (!seen || !keepsShape(set[id], inset) ||
      !(marginAt(inset, 1.0 / std::max(seen->nearest, view_.near)) <
        std::min(view_.middle_x, view_.middle_y))) {
    return;
  }
  const auto index = static_cast<std::uint32_t>(members_.size());
  member_of_[id.value] = index;
  members_.push_back({*seen, chosen, inset, index});
}

// The edges between faces that are seen and faces that are not, as one loop in clipped_.
bool MapPolygons::findSilhouette(const OccluderSet& set, const OccluderBody& body, std::uint64_t seen) {
  std::uint8_t next[kMaxBodyVertices];
  std::uint32_t count = 0, used = 0, first = 0;  // used: vertices, a bit each
  for (const BodyEdge& edge : set.edgesOf(body)) {
    const bool left = (seen >> edge.left & 1) != 0, right = (seen >> edge.right & 1) != 0;
    if (left == right) {
      continue;
    }
    first = left ? edge.from : edge.to;
    next[first] = left ? edge.to : edge.from;
    used |= 1u << first;
    ++count;
  }
  clipped_.clear();
  std::uint32_t vertex = first;
  for (; (used >> vertex & 1) != 0; vertex = next[vertex]) {
    used &= ~(1u << vertex);
    clipped_.push_back({body_corners_[vertex], EdgeKind::kOpen});
  }
  return vertex == first && clipped_.size() == count && count >= 3;
}

// A body wholly beyond the near plane, each of whose faces is clearly seen or clearly turned away.
bool MapPolygons::addBody(const OccluderSet& set, OccluderId id, const OccluderBody& body,
                          const RasterSettings& settings) {
  const std::span<const Vec3f> vertices = set.verticesOf(body);
  Vec3d relative[kMaxBodyVertices];
  double reach = 0.0, farthest = 0.0, nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    relative[i] = Vec3d(vertices[i]) - eye_.position;
    body_corners_[i] = view_.toCamera(relative[i]);
    reach = std::max(reach, l1Norm(relative[i]));
    farthest = std::max(farthest, dot(relative[i], relative[i]));
    nearest = std::min(nearest, body_corners_[i].z);
  }
  farthest = eye_.orthographic ? 1.0 : std::sqrt(farthest);
  std::uint64_t seen = 0;
  struct Face {
    Plane support;
    double depth_slack = 0.0;  // see EyeOccluder
  };
  Face faces[MapPolygon::kMaxPlanes];
  std::uint32_t face_count = 0, number = 0;
  double inset = 0.0, depth_slack = 0.0;
  for (const BodyFace& face : set.facesOf(body)) {
    const double height = -dot(face.plane.normal, relative[face.vertex]);
    const double grazing = (eye_.orthographic ? -dot(face.plane.normal, eye_.forward) : height) / farthest;
    if (!(std::abs(grazing) > kGrazingSine)) {
      return false;
    }
    if (grazing > 0.0) {
      if (face_count == MapPolygon::kMaxPlanes) {
        return false;
      }
      const double face_inset = outlineInset(body.slack, reach, grazing);
      if (!keepsShape(set[face.occluder], face_inset)) {
        return false;
      }
      const double face_slack = depthSlack(body.slack, reach, grazing);
      faces[face_count++] = {{face.plane.normal, height}, face_slack};
      seen |= std::uint64_t{1} << number;
      inset = std::max(inset, face_inset);
      depth_slack = std::max(depth_slack, face_slack);
    }
    ++number;
  }
  const double clip_depth = clipDepth(eye_.near, depth_slack, reach);
  if (face_count == 0 || !std::isfinite(reach) || !(nearest > clip_depth) ||
      !findSilhouette(set, body, seen)) {
    return false;
  }
  if (!clip(clip_depth)) {
    return true;
  }
  MapPolygon polygon;
  startPolygon(id, inset, polygon);
  for (std::uint32_t i = 0; i < face_count; ++i) {
    addReciprocalDepth(faces[i].support, faces[i].depth_slack + 4.0 * kDepthMargin * reach, settings,
                       polygon);
  }
  polygons.push_back(polygon);
  return true;
}

// Polygons that share a seam must be cut at the same depth, else one of them would have an end there that the
// other does not know of.
double MapPolygons::commonClipDepth() const {
  double depth = view_.near * (1.0 + kDepthMargin);
  for (bool raised = true; raised;) {
    raised = false;
    for (const Member& member : members_) {
      if (member.seen.nearest < member.seen.clip_depth && member.seen.clip_depth > depth) {
        depth = member.seen.clip_depth;
        raised = true;
      }
    }
  }
  return depth;
}

// Joins the groups of the member and of those that go on beyond the edge. Returns where none does.
std::uint64_t MapPolygons::openElementsOf(const OccluderSet& set, std::uint32_t member,
                                          const Outline& outline) {
  const OccluderEdge& edge = set.edges[outline.edge];
  const std::uint64_t all = allElements(edge);
  if (edge.cover_count == 0 || edge.chain == 0 || !set[members_[member].seen.id].seals) {
    return all;
  }
  Plane plane;  // through the eye and the edge, the polygon behind it; its length does not matter
  plane.normal =
      eye_.orthographic ? cross(eye_.forward, outline.to - outline.from) : cross(outline.from, outline.to);
  plane.offset = eye_.orthographic ? -dot(plane.normal, outline.from) : 0.0;
  if (!(plane.evaluate(members_[member].seen.centroid) < 0.0)) {
    return all;
  }
  return openElements(set, edge, plane, [&](OccluderId id) -> const Vec3d* {
    const std::uint32_t other = member_of_[id.value];
    if (other == kNone || !set[id].seals) {
      return nullptr;
    }
    const Vec3d& centroid = members_[other].seen.centroid;
    if (plane.evaluate(centroid) > 0.0) {
      members_[rootOf(other)].group = rootOf(member);
    }
    return &centroid;
  });
}

// False: nothing of the polygon is on the map.
bool MapPolygons::clip(double clip_depth) {
  // The mesh may go on a little beyond a seam: then it is on the map although the polygon is not.
  const bool sealed = std::any_of(clipped_.begin(), clipped_.end(),
                                  [](const Corner& corner) { return corner.kind == EdgeKind::kSealed; });
  const MapVolume volume(view_, clip_depth, MapVolume::kBeyond);
  const MapVolume map = sealed ? volume : MapVolume(view_, clip_depth, 0.0);
  unsigned outside_all = ~0u, outside_some = 0;
  for (const Corner& corner : clipped_) {
    outside_all &= map.outside(corner.position);
    outside_some |= volume.outside(corner.position);
  }
  if (outside_all != 0) {
    return false;
  }
  for (int plane = 0; plane < MapVolume::kPlanes; ++plane) {
    const Corner cut{{}, plane == MapVolume::kNear ? EdgeKind::kOpen : EdgeKind::kBorder};
    if ((outside_some >> plane & 1) != 0 &&
        !clipConvex(clipped_, scratch_, cut, [&](const Vec3d& p) { return volume.distance(plane, p); })) {
      return false;
    }
  }
  return true;
}

// The open parts of an edge that others adjoin elsewhere, as segments in camera space.
void MapPolygons::addGaps(const OccluderSet& set, const Member& member, std::uint32_t edge_index,
                          std::uint64_t open) {
  const OccluderEdge& edge = set.edges[edge_index];
  const Occluder& occluder = set[member.seen.id];
  const std::uint32_t next =
      edge_index + 1 < occluder.first_vertex + occluder.vertex_count ? edge_index + 1 : occluder.first_vertex;
  const auto point = [&](std::uint32_t k) {
    const Vec3f& p = k == 0           ? set.vertices[edge_index]
                     : k < edge.chain ? set.joints[edge.first_joint + k - 1]
                                      : set.vertices[next];
    return view_.toCamera(Vec3d(p) - eye_.position);
  };
  for (std::uint32_t k = 0; k < edge.chain; ++k) {
    if ((open >> k & 1) != 0) {
      const std::uint32_t first = k;
      while (k + 1 < edge.chain && (open >> (k + 1) & 1) != 0) {
        ++k;
      }
      gaps_.emplace_back(point(first), point(k + 1));
    }
  }
}

// The part of a segment within the volume.
bool MapPolygons::clipGap(const Vec3d& from, const Vec3d& to, double clip_depth, Vec3d& a, Vec3d& b) const {
  const MapVolume volume(view_, clip_depth, MapVolume::kBeyond);
  double first = 0.0, last = 1.0;
  for (int plane = 0; plane < MapVolume::kPlanes; ++plane) {
    const double at_from = volume.distance(plane, from), at_to = volume.distance(plane, to);
    if (at_from < 0.0 && at_to < 0.0) {
      return false;
    }
    if (at_from < 0.0) {
      first = std::max(first, at_from / (at_from - at_to));
    } else if (at_to < 0.0) {
      last = std::min(last, at_from / (at_from - at_to));
    }
  }
  a = from + (to - from) * first;
  b = from + (to - from) * last;
  return first <= last;
}

// How far, in pixels on the map, something may appear from where it is that is off by twice the inset.
float MapPolygons::marginAt(double inset, double inverse_depth) const {
  if (!view_.orthographic && !(inset * inverse_depth < 0.1)) {
    return kWholeMap;
  }
  const double stretch =
      view_.orthographic
          ? std::max(view_.scale_x, view_.scale_y)
          : std::max(view_.scale_x + view_.middle_x, view_.scale_y + view_.middle_y) * inverse_depth;
  return static_cast<float>(4.0 * rounding_ + 2.25 * inset * stretch);
}

// The plane is moved away by what triangles may lie behind it.
void MapPolygons::addReciprocalDepth(const Plane& support, double slack, const RasterSettings& settings,
                                     MapPolygon& polygon) const {
  const Vec3d n = view_.normalToCamera(support.normal);
  const double offset = support.offset + (settings.coverage == Coverage::kInner ? slack : 0.0);
  const double scale = view_.orthographic ? 1.0 / n.z : -1.0 / offset;
  ReciprocalDepthPlane plane;
  plane.along_x = scale * n.x / view_.scale_x;
  plane.along_y = scale * n.y / view_.scale_y;
  plane.at_origin = scale * (view_.orthographic ? offset : n.z) - plane.along_x * view_.middle_x -
                    plane.along_y * view_.middle_y;
  double least = std::numeric_limits<double>::infinity(), most = -least, sums = 0.0;
  for (std::uint32_t i = 0; i < polygon.edge_count; ++i) {
    const MapPoint& p = points[polygon.first_corner + i];
    const double x = plane.along_x * p.x, y = plane.along_y * p.y;
    least = std::min(least, plane.at_origin + x + y);
    most = std::max(most, plane.at_origin + x + y);
    sums = std::max(sums, std::abs(x) + std::abs(y));
  }
  const double slope = std::abs(plane.along_x) + std::abs(plane.along_y);
  const double width = std::abs(plane.along_x) * (polygon.right - polygon.left);
  const double rounding = 0x1p-22 * (std::max(std::abs(least), std::abs(most)) + width + 4.0 * slope) +
                          0x1p-50 * (std::abs(plane.at_origin) + sums);
  polygon.farthest = std::min(polygon.farthest, static_cast<float>(least - rounding));
  polygon.nearest = std::min(polygon.nearest, static_cast<float>(most + rounding));
  if (settings.coverage == Coverage::kInner) {
    plane.at_origin += std::min(plane.along_x, 0.0) + std::min(plane.along_y, 0.0) - rounding;
  } else {
    plane.at_origin += 0.5 * (plane.along_x + plane.along_y);
  }
  polygon.planes[polygon.plane_count++] = plane;
}

// Its outline: the corners in clipped_.
void MapPolygons::startPolygon(OccluderId occluder, double inset, MapPolygon& polygon) {
  polygon.occluder = occluder;
  polygon.first_edge = static_cast<std::uint32_t>(edges.size());
  polygon.first_corner = static_cast<std::uint32_t>(points.size());
  polygon.edge_count = static_cast<std::uint32_t>(clipped_.size());
  polygon.low = polygon.left = polygon.farthest = polygon.nearest = std::numeric_limits<float>::max();
  polygon.high = polygon.right = -std::numeric_limits<float>::max();
  inverse_depths_.clear();
  for (const Corner& corner : clipped_) {
    const Vec3d& c = corner.position;
    const double inverse = view_.inverseDepth(c);
    inverse_depths_.push_back(inverse);
    points.push_back({view_.mapX(c, inverse), view_.mapY(c, inverse)});
  }
  for (std::size_t i = 0; i < clipped_.size(); ++i) {
    const std::size_t next = i + 1 < clipped_.size() ? i + 1 : 0;
    const double inverse_depth = std::max(inverse_depths_[i], inverse_depths_[next]);
    const MapEdge edge = edgeBetween(points[polygon.first_corner + i], points[polygon.first_corner + next],
                                     clipped_[i].kind, marginAt(inset, inverse_depth));
    edges.push_back(edge);
    polygon.low = std::min(polygon.low, edge.low);
    polygon.high = std::max(polygon.high, edge.high);
    polygon.left = std::min(polygon.left, edge.left);
    polygon.right = std::max(polygon.right, edge.right);
    polygon.margin = std::max(polygon.margin, edge.margin);
  }
}

void MapPolygons::addPolygon(const OccluderSet& set, std::uint32_t index, double clip_depth,
                             const RasterSettings& settings) {
  const Member& member = members_[index];
  clipped_.clear();
  gaps_.clear();
  for (std::uint32_t side = 0; side < set[member.seen.id].vertex_count; ++side) {
    const Outline outline = outlineOf(eye_, set, member.seen, side);
    EdgeKind kind = EdgeKind::kOpen;
    if (settings.coverage == Coverage::kInner) {
      const std::uint64_t open = openElementsOf(set, index, outline);
      if (open != allElements(set.edges[outline.edge])) {
        kind = EdgeKind::kSealed;
        addGaps(set, member, outline.edge, open);
      }
    }
    clipped_.push_back({view_.toCamera(outline.from), kind});
  }
  if (!clip(clip_depth)) {
    return;
  }
  MapPolygon polygon;
  startPolygon(member.chosen, member.inset, polygon);
  polygon.group = index;
  for (const auto& [from, to] : gaps_) {
    Vec3d a, b;
    if (clipGap(from, to, clip_depth, a, b)) {
      edges.push_back(edgeBetween({view_.mapX(a), view_.mapY(a)}, {view_.mapX(b), view_.mapY(b)},
                                  EdgeKind::kOpen, marginAt(member.inset, 1.0 / std::min(a.z, b.z))));
      ++polygon.gap_count;
    }
  }
  addReciprocalDepth(member.seen.support, member.seen.depth_slack + 4.0 * kDepthMargin * member.seen.reach,
                     settings, polygon);
  polygons.push_back(polygon);
}

void MapPolygons::build(const PixelView& view, const RasterSettings& settings, const OccluderSet& set,
                        std::span<const OccluderId> chosen) {
  view_ = view;
  eye_.position = view.eye;
  eye_.forward = view.forward;
  eye_.near = view.near;
  eye_.orthographic = view.orthographic;
  rounding_ = mapRounding(settings.width, settings.height);
  polygons.clear();
  edges.clear();
  points.clear();
  considered = 0;
  if (!view.sane()) {
    considered = static_cast<std::uint32_t>(chosen.size());
    return;
  }
  takeMembers(set, chosen, settings);
  const double clip_depth = commonClipDepth();
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    addPolygon(set, i, clip_depth, settings);
  }
  for (MapPolygon& polygon : polygons) {
    polygon.group = polygon.group == MapPolygon::kNoGroup ? polygon.group : rootOf(polygon.group);
  }
  for (const Member& member : members_) {
    member_of_[member.seen.id.value] = kNone;
  }
}

}  // namespace sightline::occlusion
