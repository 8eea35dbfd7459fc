#pragma once

// Exact visibility of one view, as `bench` compares methods with it.

#include <cstdint>
#include <vector>

#include "oracle/exact_visibility.h"

namespace sightline::tool {

// Raise this number whenever a change of oracle/ or of exactFrame() may change an answer: answers that were
// kept under another number are not used.
inline constexpr std::uint32_t kExactFrameVersion = 1;

// How thoroughly objects are looked for.
struct ExactSettings {
  std::uint32_t width = 1280, height = 720;  // one ray for each pixel of such a picture
  std::uint32_t rays = 16;                   // rays aimed at each object, and beside each one's edges
};

// The objects of a scene that are visible in a view, as far as it was decided. Both lists ascend, and no
// object is in both; objects in neither are hidden.
struct ExactFrame {
  std::vector<ObjectId> witnessed{};  // a ray reached it
  std::vector<ObjectId> undecided{};  // neither reached nor shown to be hidden

  friend bool operator==(const ExactFrame&, const ExactFrame&) = default;
};

// Answers do not depend on the ParallelFor. object_count: of the scene.
ExactFrame exactFrame(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
                      const ExactSettings& settings, const ParallelFor& parallel_for);

}  // namespace sightline::tool
