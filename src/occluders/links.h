#pragma once

#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {

// A found polygon with what the set says of it.
struct RankedPolygon {
  FoundPolygon polygon;  // vertex ids into positions shared by all
  ObjectId object;
};

// Fills vertices, edges, lines, neighbours and the per-object lists of a set from its polygons, in their
// order. set.objects is there already, and has all valid objects of the polygons.
void assembleSet(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons, OccluderSet& set);

}  // namespace sightline::occluders
