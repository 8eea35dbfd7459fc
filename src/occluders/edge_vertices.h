#pragma once

// Which vertices lie on which edges exactly: where a corner of one triangle touches the edge of another.

#include <cstdint>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/math/vec3.h"
#include "src/base/rows.h"
#include "src/occluders/mesh_edge.h"

namespace sightline::occluders {

// For each edge, the vertices of the others that lie on it exactly, between its ends, from its lower vertex
// on; none where they are more than kMostBends. edges: ascending, none twice. Edges with coordinates of 2^64
// metres and more, or that are not finite, are left alone, and so are those whose ends are equal.
base::Rows<std::uint32_t> verticesOnEdges(std::span<const Vec3f> vertices, std::span<const MeshEdge> edges,
                                          const ParallelFor& parallel_for = serialFor);

}  // namespace sightline::occluders
