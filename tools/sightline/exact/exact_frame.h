#pragma once

// What is exactly visible in one view: `verify` and `bench` compare methods with it.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"

namespace sightline::tool {

// Raise this number whenever a change of oracle/ or of exactFrame() may change an answer: answers that
// ExactCache kept under another number are not used.
inline constexpr std::uint32_t kExactFrameVersion = 1;

// How thoroughly objects are looked for.
struct ExactSettings {
  std::uint32_t width = 1280, height = 720;  // one ray for each pixel of such a picture
  std::uint32_t aimed_rays = 16,
                edge_rays = 16;  // at each object that is not seen; beside edges of each other
  std::uint32_t steps = 16;      // of ExactVisibility::decide, for each object that is not seen
};

// How an object was found to be visible.
enum class SeenBy : std::uint8_t { kPixel, kAimedRay, kGap };
std::string nameOf(SeenBy by);

struct Sighting {
  Witness witness{};  // exact arithmetic confirms it
  SeenBy by = SeenBy::kPixel;
};

// Objects in neither list are proved hidden.
struct ExactFrame {
  std::map<ObjectId, Sighting> visible{};
  std::vector<ObjectId> undecided{};  // ascending
};

// object_count: of the scene. Answers do not depend on the ParallelFor.
ExactFrame exactFrame(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
                      const ExactSettings& settings, const ParallelFor& parallel_for);

// The objects alone. Both lists ascend, and no object is in both.
struct ExactObjects {
  std::vector<ObjectId> witnessed{};
  std::vector<ObjectId> undecided{};

  friend bool operator==(const ExactObjects&, const ExactObjects&) = default;
};
ExactObjects objectsOf(const ExactFrame& frame);

}  // namespace sightline::tool
