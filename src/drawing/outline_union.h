#pragma once

// From loops with winding numbers to rings that can be filled even-odd.

#include <vector>

#include "src/drawing/outline_chain.h"

namespace sightline::drawing {

// Replaces the loops by outer borders and holes of where their winding number is not zero, without rings that
// are narrower than min_width (twice the area by the perimeter) in the mean. One convex loop, the outline
// of most simple things, is its own union; all else is left to Clipper, which rounds crossings to the grid.
// The loops have no collinear corners.
void uniteLoops(std::vector<GridPath>& loops, double min_width);

// Whether it goes once around a convex polygon, in positive orientation. No collinear corners.
bool isConvexRing(const GridPath& ring);

}  // namespace sightline::drawing
