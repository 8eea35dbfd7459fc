#pragma once

// Gathers the triangles of a mesh: connected ones to parts, those of a part of similar direction to patches,
// and those of a patch to clusters.

#include <cstdint>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/occluders/surface_set.h"
#include "src/occluders/surfaces/surface_mesh.h"

namespace sightline::occluders {

struct Gathered {
  // By triangle of the mesh: numbers in SurfaceSet::parts and SurfaceSet::clusters.
  LargeVector<std::uint32_t> part_of, cluster_of;
  LargeVector<std::uint32_t> by_patch;  // triangles of the mesh, sorted by patch
};

// Fills the parts, patches, clusters and triangles of a set, but for chains and edge counts. Frees what the
// mesh has for it alone.
Gathered gatherTriangles(const SceneView& scene, SurfaceMesh& mesh, const SurfaceSettings& settings,
                         const ParallelFor& parallel_for, SurfaceSet& set);

}  // namespace sightline::occluders
