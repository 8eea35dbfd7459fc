#pragma once

// Converts loops with winding numbers to rings that can be filled even-odd.

#include <vector>

#include "src/drawing/outline_chain.h"

namespace sightline::drawing {

// Replaces the loops by the outer borders and holes of the region where their winding number is not zero,
// without rings that are slivers of min_width (see isSliver()). A single convex loop, the outline of most
// simple objects, is its own union; Clipper unites the others and rounds crossings to the grid. Precondition:
// the loops have no collinear corners.
void uniteLoops(std::vector<GridPath>& loops, double min_width);

// Whether the ring goes once around a convex polygon in positive orientation. Precondition: no collinear
// corners.
bool isConvexRing(const GridPath& ring);

}  // namespace sightline::drawing
