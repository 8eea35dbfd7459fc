#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "oracle/exact_visibility.h"

namespace sightline::kept_objects {

// How many rays look for what was culled wrongly.
struct Rays {
  std::uint32_t width = 96, height = 54;  // pixels, with a ray through each
  std::uint32_t samples = 0;              // rays aimed at each culled object
};

struct Sightings {
  std::size_t through_pixels = 0;        // objects that the rays through pixels hit
  std::vector<SeenPoint> though_culled;  // proofs that objects are visible of which is_kept(object) is false
};

template <typename IsKept>
Sightings lookForCulled(const ExactVisibility& exact, const View& view, const Rays& rays,
                        std::span<const ObjectId> culled, IsKept&& is_kept) {
  std::vector<SeenPoint> witnesses = exact.visibleThroughPixels(view, rays.width, rays.height);
  Sightings sightings;
  sightings.through_pixels = witnesses.size();
  const std::vector<SeenPoint> aimed = exact.visibleByAimedRays(view, culled, rays.samples);
  witnesses.insert(witnesses.end(), aimed.begin(), aimed.end());
  for (const SeenPoint& witness : witnesses) {
    if (!is_kept(witness.object) && exact.confirm(view, witness)) {
      sightings.though_culled.push_back(witness);
    }
  }
  return sightings;
}

}  // namespace sightline::kept_objects
