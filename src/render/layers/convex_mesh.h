#pragma once

// Tells whether a blended mesh can be drawn in any order of its triangles.

#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::render {

// Whether every ray from outside intersects at most one triangle that is drawn. Of a single-sided mesh only
// triangles count whose front the ray intersects. True for pieces of convex surfaces with their fronts
// outwards and for flat meshes, unless triangles coincide; an eye within a convex body sees no fronts at all.
// Conservative: false also for more than 8192 triangles and for coordinates that are not finite. Positions
// count as known to 2^-22 of the largest coordinate: a mesh that would not overlap itself with positions
// changed by less counts as not overlapping. indices: three for each triangle, into positions. Takes time
// proportional to the square of the number of triangles.
bool coversOnce(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices, bool double_sided);

}  // namespace sightline::render
