#pragma once

// Links the occluders of a set that share edges of the mesh.

#include <cstdint>
#include <span>

#include "src/occluders/assemble_set.h"

namespace sightline::occluders {

// Fills edges, lines and neighbours of a set with occluders and vertices, and adds to the slack of occluders.
// first_vertex: in the set, by place among the given polygons.
void linkEdges(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
               LargeVector<std::uint32_t> first_vertex, const ParallelFor& parallel_for, OccluderSet& set);

}  // namespace sightline::occluders
