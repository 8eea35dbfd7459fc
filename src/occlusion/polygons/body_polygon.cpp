#include "src/occlusion/polygons/body_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "src/occluders/occluder_limits.h"

namespace sightline::occlusion {
namespace {

using occluders::kMaxBodyVertices;

struct BodyVertices {
  Vec3d relative[kMaxBodyVertices];  // to the eye
  Vec3d camera[kMaxBodyVertices];
  double reach = 0.0;     // largest l1Norm(), metres
  double farthest = 0.0;  // largest distance from the eye, metres; orthographic: 1
  double nearest = std::numeric_limits<double>::infinity();  // least depth, metres
};

BodyVertices verticesFrom(const scene::PixelView& view, const Eye& eye, std::span<const Vec3f> vertices) {
  BodyVertices seen;
  double farthest_squared = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    seen.relative[i] = Vec3d(vertices[i]) - eye.position;
    seen.camera[i] = view.toCamera(seen.relative[i]);
    seen.reach = std::max(seen.reach, l1Norm(seen.relative[i]));
    farthest_squared = std::max(farthest_squared, dot(seen.relative[i], seen.relative[i]));
    seen.nearest = std::min(seen.nearest, seen.camera[i].z);
  }
  seen.farthest = eye.orthographic ? 1.0 : std::sqrt(farthest_squared);
  return seen;
}

// The faces that the eye sees.
struct SeenFaces {
  struct Face {
    Plane support;             // relative to the eye
    double depth_slack = 0.0;  // see EyeOccluder
  };
  Face faces[BufferPolygon::kMaxPlanes];
  std::uint32_t count = 0;
  std::uint64_t bits = 0;  // by number of a face in the body
  // The largest of the faces' own.
  double inset = 0.0, depth_slack = 0.0;
};

// Nothing where a face is neither clearly seen nor clearly turned away, or where too many are seen.
std::optional<SeenFaces> facesFrom(const Eye& eye, const OccluderSet& set, const OccluderBody& body,
                                   const BodyVertices& vertices) {
  SeenFaces seen;
  std::uint32_t number = 0;
  for (const BodyFace& face : set.facesOf(body)) {
    const double height = -dot(face.plane.normal, vertices.relative[face.vertex]);
    const double grazing =
        (eye.orthographic ? -dot(face.plane.normal, eye.sight) : height) / vertices.farthest;
    if (!(std::abs(grazing) > kGrazingSine)) {
      return std::nullopt;
    }
    if (grazing > 0.0) {
      const double inset = outlineInset(body.slack, vertices.reach, grazing);
      if (seen.count == BufferPolygon::kMaxPlanes || !keepsShape(set[face.occluder], inset)) {
        return std::nullopt;
      }
      const double slack = depthSlack(body.slack, vertices.reach, grazing);
      seen.faces[seen.count++] = {{face.plane.normal, height}, slack};
      seen.bits |= std::uint64_t{1} << number;
      seen.inset = std::max(seen.inset, inset);
      seen.depth_slack = std::max(seen.depth_slack, slack);
    }
    ++number;
  }
  return seen;
}

// Makes one loop of the edges between faces that are seen and faces that are not. False: they are no such
// loop.
bool findSilhouette(const OccluderSet& set, const OccluderBody& body, std::uint64_t seen_faces,
                    const BodyVertices& vertices, std::vector<OutlineCorner>& outline) {
  std::uint8_t next[kMaxBodyVertices];
  std::uint32_t count = 0, used = 0, first = 0;  // used: vertices, a bit each
  for (const BodyEdge& edge : set.edgesOf(body)) {
    const bool left = (seen_faces >> edge.left & 1) != 0, right = (seen_faces >> edge.right & 1) != 0;
    if (left == right) {
      continue;
    }
    first = left ? edge.from : edge.to;
    next[first] = left ? edge.to : edge.from;
    used |= 1u << first;
    ++count;
  }
  outline.clear();
  std::uint32_t vertex = first;
  for (; (used >> vertex & 1) != 0; vertex = next[vertex]) {
    used &= ~(1u << vertex);
    outline.push_back({vertices.camera[vertex], EdgeKind::kOpen});
  }
  return vertex == first && outline.size() == count && count >= 3;
}

}  // namespace

bool appendBody(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set, OccluderId id,
                const OccluderBody& body, CameraOutline& outline, BufferPolygons& polygons) {
  const BodyVertices vertices = verticesFrom(projection.view(), eye, set.verticesOf(body));
  const std::optional<SeenFaces> seen = facesFrom(eye, set, body, vertices);
  if (!seen || seen->count == 0) {
    return false;
  }
  const double clip_depth = clipDepth(eye.near, seen->depth_slack, vertices.reach);
  if (!std::isfinite(vertices.reach) || !(vertices.nearest > clip_depth) ||
      !findSilhouette(set, body, seen->bits, vertices, outline.corners)) {
    return false;
  }
  if (!projection.clip(clip_depth, outline)) {
    return true;
  }
  BufferPolygon polygon = projection.appendOutline(id, outline.corners, seen->inset, polygons);
  for (std::uint32_t i = 0; i < seen->count; ++i) {
    const SeenFaces::Face& face = seen->faces[i];
    const double slack = face.depth_slack + 4.0 * kDepthMargin * vertices.reach;
    polygon.add(projection.depthOf(face.support, slack, polygon, polygons.corners(polygon)));
  }
  polygons.polygons.push_back(polygon);
  return true;
}

}  // namespace sightline::occlusion
