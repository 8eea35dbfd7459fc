#pragma once

// Whether a see-through mesh can be drawn as it is, or its own surface must be put in order first.

#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::render {

// Whether every ray from outside meets at most one triangle that is drawn: of single-sided meshes those whose
// front it meets. So it is of pieces of convex surfaces, fronts outwards, and of flat meshes; where no two
// triangles lie in each other's place. For an eye within a convex body too: it sees no fronts at all.
// Conservative: false also where it takes too long to tell (more than 8192 triangles) and for numbers that
// are not finite. Up to rounding: positions count as known to 2^-22 of the largest coordinate, and what would
// not lie over itself if they were elsewhere within that counts as not doing so; it does then by next to
// nothing. indices: three a triangle, into positions. Time: triangles squared.
bool coversOnce(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices, bool double_sided);

}  // namespace sightline::render
