#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_mesh.h"

namespace sightline::layers {

// The hull of points that fill space: all but centre and radius. points: coordinates of at most 1. numbers:
// becomes which point each vertex is. Nothing where the points turn out to be flat.
std::optional<ConvexHull> solidHull(std::span<const Vec3d> points, const HullFrame& frame,
                                    std::vector<std::uint32_t>& numbers);

}  // namespace sightline::layers
