#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_frame.h"

namespace sightline::layers {

// Returns the hull, without centre and radius, of points that lie in one place, on a line or in a plane, up
// to rounding.
// points: coordinates of at most 1. numbers: receives the point of each vertex.
ConvexHull flatHull(std::span<const Vec3d> points, const HullFrame& frame,
                    std::vector<std::uint32_t>& numbers);

}  // namespace sightline::layers
