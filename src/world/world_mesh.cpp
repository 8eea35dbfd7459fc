#include "sightline/world/world_mesh.h"

#include <cmath>

#include "sightline/scene/scene.h"
#include "src/world/read_mesh.h"

namespace sightline {

using namespace world;

namespace {

// The sum of the tetrahedra between the triangles and a point near them.
double volumeOf(const WeldedMesh& mesh) {
  double six_volumes = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3d from(mesh.positions[0]);
    const auto corner = [&](std::size_t k) { return Vec3d(mesh.positions[mesh.indices[i + k]]) - from; };
    six_volumes += dot(corner(0), cross(corner(1), corner(2)));
  }
  return six_volumes / 6.0;
}

// min() and max() pass over a number that is not one, so that a box would not grow by it.
bool hasNaN(const Box& box) {
  bool found = false;
  for (int axis = 0; axis < 3; ++axis) {
    found = found || std::isnan(box.min[axis]) || std::isnan(box.max[axis]);
  }
  return found;
}

}  // namespace

Result<WorldMesh> makeMesh(const MeshView& mesh, const MeshSettings& settings,
                           const ParallelFor& parallel_for) {
  const Result<ReadMesh> drawn = readMesh(mesh);
  if (!drawn) {
    return drawn.error();
  }
  WorldMesh made;
  made.triangles = static_cast<std::uint32_t>(drawn->indices.size() / 3);
  for (const std::uint32_t vertex : drawn->indices) {
    made.bounds.extend(drawn->positions[vertex]);
  }
  made.bounds.extend(settings.drawn_bounds);
  if (!drawn->finite || hasNaN(settings.drawn_bounds)) {
    made.bounds = Box{};
  }
  made.occludes = settings.occludes;
  if (!settings.occludes || settings.opacity != Opacity::kOpaque) {
    return made;
  }
  const Result<ReadMesh> other =
      settings.occluder != nullptr ? readMesh(*settings.occluder) : Result<ReadMesh>(ReadMesh{});
  if (!other) {
    return Error{"the occluder: " + other.error().message};
  }
  made.has_occluder = settings.occluder != nullptr;
  const ReadMesh& hides = settings.occluder != nullptr ? *other : *drawn;
  const WeldedMesh welded = weldMesh(hides);
  made.vertices = welded.vertices;
  made.positions = static_cast<std::uint32_t>(welded.positions.size());
  made.open_edges = welded.open_edges;
  made.volume = volumeOf(welded);
  const Material material{.opacity = Opacity::kOpaque, .double_sided = settings.double_sided};
  const Object object{.index_count = static_cast<std::uint32_t>(hides.indices.size()),
                      .material = MaterialId(0u),
                      .bounds = made.bounds};
  made.surfaces = findSurfaces({hides.positions, hides.indices, {&object, 1}, {&material, 1}},
                               settings.surfaces, parallel_for);
  return made;
}

WorldMesh boxMesh(const Box& box) {
  WorldMesh mesh;
  mesh.bounds = box;
  return mesh;
}

}  // namespace sightline
