#pragma once

// Divides the outlines of found polygons where others end on them: at T-junctions.

#include <deque>
#include <span>

#include "sightline/base/parallel_for.h"
#include "src/occluders/assemble_set.h"

namespace sightline::occluders {

// Polygons with divided outlines.
struct DividedOutlines {
  std::deque<FoundPolygon> polygons;
  IdStore ids;  // theirs
};

// Mesh edges of outlines that run one way more often than the other are divided at the vertices of such edges
// that lie on them exactly, as if the mesh had been divided there. What the polygons cover and their corners
// stay as they are. Those whose outlines change are replaced by ones in `divided`.
void divideOutlines(std::span<const Vec3f> positions, const ParallelFor& parallel_for,
                    std::span<RankedPolygon> polygons, DividedOutlines& divided);

}  // namespace sightline::occluders
