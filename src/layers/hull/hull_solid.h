#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_mesh.h"

namespace sightline::layers {

// Returns the hull, without centre and radius, of points that span space, or nothing if they turn out to be
// flat.
// points: coordinates of at most 1. numbers: receives the point of each vertex.
std::optional<ConvexHull> solidHull(std::span<const Vec3d> points, const HullFrame& frame,
                                    std::vector<std::uint32_t>& numbers);

}  // namespace sightline::layers
