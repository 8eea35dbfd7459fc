#pragma once

// The boundaries of clusters of triangles, as chains of mesh edges.

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/surface_set.h"
#include "src/occluders/surfaces/surface_gather.h"
#include "src/occluders/surfaces/surface_mesh.h"

namespace sightline::occluders {

// Fills the chains of a set with vertices, patches and clusters. Leaves nothing of the mesh but its vertices,
// and nothing of what was gathered.
void findChains(SurfaceMesh& mesh, Gathered& gathered, const ParallelFor& parallel_for, SurfaceSet& set);

}  // namespace sightline::occluders
