#pragma once

// Writes found polygons into an occluder set and links those that share edges of the mesh.

#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "src/occluders/assemble_set.h"

namespace sightline::occluders {

// Fills occluders, vertices, edges, lines, neighbours and the area of a set from its polygons. polygons: see
// assembleSet().
void linkPolygons(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                  const ParallelFor& parallel_for, OccluderSet& set);

}  // namespace sightline::occluders
