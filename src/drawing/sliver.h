#pragma once

// Rings that are so narrow that they come from rounding.

#include "src/drawing/outline_chain.h"

namespace sightline::drawing {

// Whether a ring, of any orientation, has a mean width (twice the area divided by the perimeter) below
// `width` grid lines, and no wide piece hangs on it: nothing is left of it if all its borders move inwards by
// `width`, so no circle of that radius, up to a line, fits in. False if this is not certain.
bool isSliver(const GridPath& ring, double width);

}  // namespace sightline::drawing
