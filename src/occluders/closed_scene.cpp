#include "sightline/occluders/closed_scene.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "src/occluders/close_cracks.h"
#include "src/occluders/surface_mesh.h"

namespace sightline {
namespace {

using occluders::OpaqueTriangles;

std::vector<Vec3d> exact(std::span<const Vec3f> positions) {
  return {positions.begin(), positions.end()};
}

}  // namespace

ClosedScene closeCracks(const SceneView& scene, double width, const ParallelFor& parallel_for) {
  ClosedScene closed;
  closed.objects.assign(scene.objects.begin(), scene.objects.end());
  if (!(width > 0.0) || !std::isfinite(width)) {
    closed.indices.assign(scene.indices.begin(), scene.indices.end());
    return closed;
  }
  const OpaqueTriangles opaque = occluders::opaqueTriangles(scene);
  const std::vector<Vec3d> vertices = exact(opaque.vertices);
  const occluders::ClosedCracks cracks =
      occluders::closeCracks({vertices, opaque.corners}, width, parallel_for);
  closed.slack = cracks.slack;
  closed.merged = cracks.merged;
  closed.bent = cracks.bent;
  // An object keeps its triangles, or has those that were made of them.
  std::size_t triangle = 0;
  for (std::uint32_t number = 0; number < closed.objects.size(); ++number) {
    Object& object = closed.objects[number];
    const std::span<const std::uint32_t> given = scene.indicesOf(scene.objects[number]);
    object.first_index = static_cast<std::uint32_t>(closed.indices.size());
    if (!occluders::mayOcclude(scene, scene.objects[number])) {
      closed.indices.insert(closed.indices.end(), given.begin(), given.end());
    }
    for (; triangle < cracks.source.size() && opaque.objects[cracks.source[triangle]] == number; ++triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        closed.indices.push_back(opaque.position_of[cracks.triangles[3 * triangle + k]]);
      }
    }
    object.index_count = static_cast<std::uint32_t>(closed.indices.size()) - object.first_index;
    Box bounds = object.index_count > 0 ? Box{} : object.bounds;
    for (const std::uint32_t index : closed.view(scene).indicesOf(object)) {
      bounds.extend(scene.positions[index]);
    }
    object.bounds = widened(bounds, closed.margin());
  }
  return closed;
}

std::vector<Crack> findCracks(const SceneView& scene, double width, const ParallelFor& parallel_for) {
  const OpaqueTriangles opaque = occluders::opaqueTriangles(scene);
  const std::vector<Vec3d> vertices = exact(opaque.vertices);
  std::vector<Crack> cracks;
  for (const occluders::NearMiss& miss :
       occluders::findNearMisses({vertices, opaque.corners}, width, parallel_for)) {
    cracks.push_back({opaque.vertices[miss.vertex], miss.distance,
                      ObjectId(opaque.objects[miss.vertex_triangle]),
                      ObjectId(opaque.objects[miss.edge_triangle])});
  }
  return cracks;
}

}  // namespace sightline
