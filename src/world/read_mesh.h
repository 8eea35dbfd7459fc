#pragma once

// Copies the caller's meshes, and joins their vertices that have the same place.

#include <cstdint>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/vec3.h"
#include "sightline/world/world_mesh.h"

namespace sightline::world {

// A mesh as it was read from the caller's memory.
struct ReadMesh {
  std::vector<Vec3f> positions;        // no more of them than of indices; some may be named by no triangle
  std::vector<std::uint32_t> indices;  // counter-clockwise in a right-handed space
  bool finite = true;                  // all positions that are used
};

// Error: as makeMesh() says.
Result<ReadMesh> readMesh(const MeshView& mesh);

// Triangles whose equal positions have equal numbers.
struct WeldedMesh {
  std::vector<Vec3f> positions;        // those that are used, no two equal
  std::vector<std::uint32_t> indices;  // triangles that name a position twice are left out
  std::uint32_t vertices = 0;          // that triangles named
  std::uint32_t open_edges = 0;        // at which triangles do not cancel
};
WeldedMesh weldMesh(const ReadMesh& mesh);

}  // namespace sightline::world
