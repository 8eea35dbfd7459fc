#pragma once

// Puts found polygons into an occluder set.

#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {

// A found polygon with what the set says of it.
struct RankedPolygon {
  const FoundPolygon* polygon = nullptr;  // vertex ids into positions shared by all
  ObjectId object;                        // polygons without one come last
  OccluderId id;                          // from 0 on, without gaps
};

// Fills a set from its polygons, but for the report. polygons: by object; of one object in any order. In that
// order memory is read, and most of it is written in the order of ids. set.objects is there already, and has
// all valid objects of the polygons.
void assembleSet(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                 const ParallelFor& parallel_for, OccluderSet& set);

}  // namespace sightline::occluders
