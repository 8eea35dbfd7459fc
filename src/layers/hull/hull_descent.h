#pragma once

#include <span>

#include "sightline/layers/hull.h"

namespace sightline::layers {

// Returns ConvexHull::descent_factor of a solid with vertices and edges.
// outwards: one per vertex, a direction along which all its edges fall.
double descentFactor(const ConvexHull& hull, std::span<const Vec3d> outwards);

}  // namespace sightline::layers
