#include "sightline/occluders/closed_scene.h"

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "src/occluders/conform/close_cracks.h"
#include "src/occluders/surfaces/surface_mesh.h"

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
  const OpaqueTriangles opaque = occluders::opaqueTriangles(scene, parallel_for);
  const std::vector<Vec3d> vertices = exact(opaque.vertices);
  const occluders::ClosedCracks cracks =
      occluders::closeCracks({vertices, opaque.corners}, width, parallel_for);
  // Indices have 32 bits; a scene that would need more stays as it is.
  if (scene.indices.size() + cracks.triangles.size() + cracks.collapsed.size() >
      std::numeric_limits<std::uint32_t>::max()) {
    return closeCracks(scene, 0.0);
  }
  closed.slack = cracks.slack;
  closed.merged = cracks.merged;
  closed.bent = cracks.bent;
  // An object has what was made of its triangles, what of them has collapsed, and those that were passed on.
  std::size_t triangle = 0, collapsed = 0;
  const auto append = [&](std::span<const std::uint32_t> corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      closed.indices.push_back(opaque.position_of[corners[k]]);
    }
  };
  for (std::uint32_t number = 0; number < closed.objects.size(); ++number) {
    const Object& given = scene.objects[number];
    const std::span<const std::uint32_t> indices = scene.indicesOf(given);
    Object& object = closed.objects[number];
    object.first_index = static_cast<std::uint32_t>(closed.indices.size());
    const auto isOf = [&](std::uint32_t source) { return opaque.objects[source] == number; };
    for (; triangle < cracks.source.size() && isOf(cracks.source[triangle]); ++triangle) {
      append(std::span(cracks.triangles).subspan(3 * triangle, 3));
    }
    for (; collapsed < cracks.collapsed_source.size() && isOf(cracks.collapsed_source[collapsed]);
         ++collapsed) {
      append(std::span(cracks.collapsed).subspan(3 * collapsed, 3));
    }
    Box before, after;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      const std::span<const std::uint32_t> corners = indices.subspan(i, 3);
      if (!occluders::mayOcclude(scene, given) || !occluders::isFiniteTriangle(scene, corners)) {
        closed.indices.insert(closed.indices.end(), corners.begin(), corners.end());
      }
      for (const std::uint32_t corner : corners) {
        before.extend(scene.positions[corner]);
      }
    }
    object.index_count = static_cast<std::uint32_t>(closed.indices.size()) - object.first_index;
    for (const std::uint32_t index : std::span(closed.indices).subspan(object.first_index)) {
      after.extend(scene.positions[index]);
    }
    // Bounds that are wider than the triangles, or not finite, stay so.
    if (!(given.bounds == before)) {
      after.extend(given.bounds);
    }
    object.bounds = given.bounds.wellFormed() ? widened(after, closed.margin()) : given.bounds;
  }
  return closed;
}

std::vector<Crack> findCracks(const SceneView& scene, double width, const ParallelFor& parallel_for) {
  const OpaqueTriangles opaque = occluders::opaqueTriangles(scene, parallel_for);
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
