#pragma once

// Meshes of a World: read from the caller's memory once, shared by all of their instances.

#include <cstddef>
#include <cstdint>

#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/material.h"

namespace sightline {

// A mesh in the caller's memory, as it lies in a vertex buffer. It is read, and neither changed nor kept.
struct MeshView {
  // Three floats a vertex, x, y and z, from this address on every so many bytes; of any alignment.
  const void* positions = nullptr;
  std::size_t position_stride = 3 * sizeof(float);  // at least 12
  std::uint32_t vertex_count = 0;
  // Three a triangle, of 2 or 4 bytes each; of any alignment. Null: vertices 0, 1, 2 are the first triangle,
  // and so on.
  const void* indices = nullptr;
  std::uint32_t index_bytes = 4;
  std::size_t index_count = 0;
  bool clockwise = false;  // as triangles appear that are seen from their front; else counter-clockwise
};

struct MeshSettings {
  Opacity opacity = Opacity::kOpaque;  // others never hide anything
  bool double_sided = false;           // back faces are drawn, and hide too
  // False: instances never hide anything, as where a vertex shader moves vertices about.
  bool occludes = true;
  SurfaceSettings surfaces{};
};

// Made by makeMesh() and not to be changed by hand.
struct WorldMesh {
  Box bounds{};           // of all triangles; not well formed if one of them is not finite
  SurfaceSet surfaces{};  // empty if the mesh never hides anything
  std::uint32_t triangles = 0;
};

// Reads a mesh and finds its surfaces, once, on any thread. Equal positions are one vertex, whatever their
// normals and texture coordinates are, so meshes need not be welded. Takes about two microseconds a triangle
// on one core.
// Error: an index is out of range, the counts are no triangles, or a size is not one of those above.
Result<WorldMesh> makeMesh(const MeshView& mesh, const MeshSettings& settings = {},
                           const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
