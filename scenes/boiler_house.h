#pragma once

// A boiler house: steel, glass, pipes and gratings, where nearly everything is thin or full of holes.

#include <cstdint>

#include "sightline/scene/scene.h"

namespace sightline {

struct BoilerHouseOptions {
  std::uint32_t boilers = 5;  // in a row, 16 m apart; the hall is as long as they need
  std::uint32_t pipes = 900;  // of all sizes, beside those that every boiler has
  std::uint32_t seed = 1;
};
// A hall of steel columns and trusses with walls and a roof of panes in frames; boilers of panels between
// bands of steel, with their drums, ducts and burners; galleries of gratings with handrails at four heights;
// tanks, pumps and pipes. Panes are see-through, gratings have holes. All other objects are closed solids.
// Camera path: "round" (400 frames along the boilers, up the stairs and back along a gallery).
Scene makeBoilerHouse(const BoilerHouseOptions& options);

}  // namespace sightline
