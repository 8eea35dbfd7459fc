#include "sightline/world/world_mesh.h"

#include <cstring>
#include <string>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline {
namespace {

Vec3f positionOf(const MeshView& mesh, std::uint32_t vertex) {
  float at[3];
  std::memcpy(at, static_cast<const std::byte*>(mesh.positions) + vertex * mesh.position_stride, sizeof(at));
  return {at[0], at[1], at[2]};
}

std::uint32_t indexAt(const MeshView& mesh, std::size_t i) {
  if (mesh.indices == nullptr) {
    return static_cast<std::uint32_t>(i);
  }
  const std::byte* const at = static_cast<const std::byte*>(mesh.indices) + i * mesh.index_bytes;
  if (mesh.index_bytes == 2) {
    std::uint16_t index;
    std::memcpy(&index, at, sizeof(index));
    return index;
  }
  std::uint32_t index;
  std::memcpy(&index, at, sizeof(index));
  return index;
}

std::string faultOf(const MeshView& mesh, std::size_t corners) {
  if (mesh.vertex_count > 0 && mesh.positions == nullptr) {
    return "the mesh has vertices and no positions; set MeshView::positions";
  }
  if (mesh.position_stride < 3 * sizeof(float)) {
    return "position_stride is " + std::to_string(mesh.position_stride) + "; it must be at least 12 bytes";
  }
  if (mesh.indices != nullptr && mesh.index_bytes != 2 && mesh.index_bytes != 4) {
    return "index_bytes is " + std::to_string(mesh.index_bytes) + "; it must be 2 or 4";
  }
  if (mesh.indices == nullptr && mesh.index_count > 0) {
    return "the mesh has an index_count and no indices; set MeshView::indices";
  }
  if (corners % 3 != 0 || corners / 3 > 0xffffffffu / 3) {
    return "the mesh has " + std::to_string(corners) +
           (mesh.indices != nullptr ? " indices" : " vertices without indices") +
           "; it must be three a triangle, fewer than 2^32";
  }
  return {};
}

}  // namespace

Result<WorldMesh> makeMesh(const MeshView& mesh, const MeshSettings& settings,
                           const ParallelFor& parallel_for) {
  const std::size_t corners = mesh.indices != nullptr ? mesh.index_count : mesh.vertex_count;
  if (std::string fault = faultOf(mesh, corners); !fault.empty()) {
    return Error{std::move(fault)};
  }
  WorldMesh made;
  made.triangles = static_cast<std::uint32_t>(corners / 3);
  std::vector<Vec3f> positions(mesh.vertex_count);
  for (std::uint32_t vertex = 0; vertex < mesh.vertex_count; ++vertex) {
    positions[vertex] = positionOf(mesh, vertex);
  }
  std::vector<std::uint32_t> indices(corners);
  bool finite = true;
  for (std::size_t i = 0; i < corners; ++i) {
    // The second and third corners of a triangle change places if it is clockwise.
    const std::size_t from = !mesh.clockwise || i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1;
    indices[i] = indexAt(mesh, from);
    if (indices[i] >= mesh.vertex_count) {
      return Error{"index " + std::to_string(from) + " is " + std::to_string(indices[i]) +
                   ", but the mesh has " + std::to_string(mesh.vertex_count) + " vertices"};
    }
    finite = finite && isFinite(positions[indices[i]]);
    made.bounds.extend(positions[indices[i]]);
  }
  if (!finite) {
    made.bounds = Box{};
  }
  if (settings.occludes && settings.opacity == Opacity::kOpaque) {
    const Material material{.opacity = Opacity::kOpaque, .double_sided = settings.double_sided};
    const Object object{.index_count = static_cast<std::uint32_t>(corners),
                        .material = MaterialId(0u),
                        .bounds = made.bounds};
    made.surfaces =
        findSurfaces({positions, indices, {&object, 1}, {&material, 1}}, settings.surfaces, parallel_for);
  }
  return made;
}

}  // namespace sightline
