#pragma once

// Convex bodies among the polygons of an object. Polygons that enclose a convex solid hide as a whole, so
// that structures in image space need only its outline.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "src/occluders/links.h"
#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {

// Numbers the bodies among the polygons of one object from 0, and fills FoundPolygon::body and body_size.
// Polygons make a body where each edge is, mesh edge by mesh edge, an edge of one other, and no vertex lies
// before any of the planes by more than the tolerance, and some clearly behind it.
void findBodies(std::span<const Vec3f> positions, std::span<FoundPolygon* const> polygons, double tolerance);

// Fills the bodies of a set whose occluders are these polygons. Bodies of which a polygon is missing are left
// out.
void assembleBodies(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                    OccluderSet& set);

}  // namespace sightline::occluders
