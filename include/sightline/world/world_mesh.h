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
// Many meshes may share one buffer: `indices` points to the first index of this one, and `positions` to the
// vertex that index 0 means (the base vertex). Vertices that no triangle names are not read.
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
  // Whether triangles that are seen from their front run clockwise in the picture.
  bool clockwise = false;
  // The mesh's space is left-handed, as those of Unity, Unreal and Direct3D samples are. This only tells what
  // `clockwise` means: front faces of Unity and Unreal are clockwise, in left-handed spaces.
  bool left_handed = false;
};

struct MeshSettings {
  Opacity opacity = Opacity::kOpaque;  // others never hide anything
  bool double_sided = false;           // back faces are drawn, and hide too
  // False: instances never hide anything, as where a vertex shader moves vertices about.
  bool occludes = true;
  // Not null: this mesh hides in place of the drawn one. It must lie inside all that is ever drawn of the
  // other: each level of detail, each pose (checkInside()). It hides nothing where the near plane may cut the
  // drawn mesh open, and is in no join. Read during the call only.
  const MeshView* occluder = nullptr;
  // Not empty: all that is ever drawn lies in this box, in the mesh's space, or in that of the mesh (levels
  // of detail, poses). If one of its numbers is not finite, instances have no place, and are always kept.
  Box drawn_bounds{};
  SurfaceSettings surfaces{};
};

// Made by makeMesh() and not to be changed by hand.
struct WorldMesh {
  Box bounds{};                 // of all that is drawn, in the mesh's space; not well formed if not finite
  SurfaceSet surfaces{};        // empty if the mesh never hides anything
  std::uint32_t triangles = 0;  // of the drawn mesh
  bool has_occluder = false;    // MeshSettings::occluder was given
  bool occludes = true;         // MeshSettings::occludes
  // How many vertices the triangles of the mesh that hides name, and how many different positions these have.
  // Where both are equal and open_edges are many, positions that should be equal are not: it hides little.
  std::uint32_t vertices = 0, positions = 0;
  // The number of edges of the mesh that hides at which its triangles do not cancel. A closed mesh has none
  // if all of its triangles run the same way around.
  std::uint32_t open_edges = 0;
  // Cubic metres in the mesh that hides, if it is closed; positive where its triangles run counter-clockwise
  // as seen from outside. Negative: it is inside out. If it is not drawn so, MeshView::clockwise or
  // MeshView::left_handed is wrong, and it would hide what can be seen.
  double volume = 0.0;
};

// A mesh for what has a place and hides nothing: lights, particles, sounds, triggers. Its instances are moved
// and culled like all others.
WorldMesh boxMesh(const Box& box);

// Whether one mesh may stand for another as MeshSettings::occluder. Success: no point of the occluder lies
// outside of the drawn mesh, or on it. Exact. Error, with the reason: the drawn mesh is not closed, the
// occluder touches it, or part of it lies outside. Takes time as the product of their triangles, for pairs
// whose boxes overlap; so call it when assets are built.
Result<void> checkInside(const MeshView& occluder, const MeshView& drawn);

// Reads a mesh and finds its surfaces, once, on any thread. Equal positions are one vertex, whatever their
// normals and texture coordinates are, so meshes need not be welded. Takes about two microseconds a triangle
// on one core, however many vertices the buffer has.
// Error: an index is out of range, the counts are no triangles, or a size is not one of those above.
Result<WorldMesh> makeMesh(const MeshView& mesh, const MeshSettings& settings = {},
                           const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
