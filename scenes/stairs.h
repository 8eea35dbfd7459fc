#pragma once

// The shape of a flight of stairs, shared by all scenes.

#include <cstdint>
#include <vector>

#include "scenes/mesh_builder.h"

namespace sightline::scenes {

// Side view of a flight that rises along x from its origin: steps above, a sloped soffit below, 0.2 m thick.
// rise, tread: of one step, metres; the last riser ends at the landing and has no tread.
std::vector<Point2> flightProfile(std::uint32_t risers, double rise, double tread);

}  // namespace sightline::scenes
