#include "scenes/moving_parts.h"

#include <utility>

namespace sightline::scenes {

Scene buildPartMesh(const std::function<void(MeshBuilder&)>& build) {
  Scene mesh;
  mesh.materials.resize(1);
  {
    MeshBuilder builder(mesh);
    builder.startObject("part", MaterialId{0u});
    build(builder);
  }
  weldPositions(mesh);
  return mesh;
}

ConvexHull hullOf(const Scene& mesh, double growth) {
  Box bounds;
  for (const Vec3f& position : mesh.positions) {
    bounds.extend(position);
  }
  const Vec3d middle = center(bounds);
  std::vector<Vec3d> points;
  points.reserve(mesh.positions.size());
  for (const Vec3f& position : mesh.positions) {
    points.push_back(Vec3d(position) + (Vec3d(position) - middle) * growth);
  }
  return buildHull(points).value();
}

void addMovingPart(MovingScene& scene, MovingPart part, const Scene& mesh, const Mat4& world_from_part,
                   MaterialId material) {
  Scene& all = scene.scene;
  Object object;
  object.first_index = static_cast<std::uint32_t>(all.indices.size());
  object.index_count = static_cast<std::uint32_t>(mesh.indices.size());
  object.material = material;
  const auto first_position = static_cast<std::uint32_t>(all.positions.size());
  for (const Vec3f& position : mesh.positions) {
    all.positions.emplace_back(transformPoint(world_from_part, Vec3d(position)));
    object.bounds.extend(all.positions.back());
  }
  for (const std::uint32_t index : mesh.indices) {
    all.indices.push_back(first_position + index);
  }
  all.objects.push_back(object);
  all.object_names.push_back(part.name);
  scene.parts.push_back(std::move(part));
}

Mat4 rigid(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin) {
  Mat4 m;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 0) = x[axis];
    m(axis, 1) = y[axis];
    m(axis, 2) = z[axis];
    m(axis, 3) = origin[axis];
  }
  return m;
}

}  // namespace sightline::scenes
