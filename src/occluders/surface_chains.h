#pragma once

// The boundaries of clusters of triangles, as chains of mesh edges.

#include <cstdint>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/surface_set.h"
#include "src/occluders/surface_mesh.h"

namespace sightline::occluders {

// Fills the chains of a set with vertices and clusters. cluster_of: by triangle of the mesh. Leaves nothing
// of the mesh but its vertices.
void findChains(SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of, const ParallelFor& parallel_for,
                SurfaceSet& set);

}  // namespace sightline::occluders
