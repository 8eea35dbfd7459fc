#pragma once

#include <span>

#include "sightline/layers/hull.h"

namespace sightline::layers {

// The descent factor of a solid with vertices and edges. outwards: at each vertex, a direction in which all
// its edges fall.
double descentFactor(const ConvexHull& hull, std::span<const Vec3d> outwards);

}  // namespace sightline::layers
