#pragma once

// What is exactly visible in one view: `verify` and `bench` compare methods with it. And the least that any
// test of one bounding box an object must keep, with which `bench` compares them too.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"

namespace sightline::tool {

// Raise this number whenever a change of oracle/ or of exactFrame() may change an answer: answers that
// ExactCache kept under another number are not used.
inline constexpr std::uint32_t kExactFrameVersion = 4;

// How thoroughly objects are looked for.
struct ExactSettings {
  std::uint32_t width = 1280, height = 720;  // one ray for each pixel of such a picture
  std::uint32_t aimed_rays = 16,
                edge_rays = 16;  // at each object that is not seen; beside edges of each other
  std::uint32_t steps = 16;  // of ExactVisibility::decide and decideBoxes, for each object that is not seen
};

// How an object was found to be visible.
enum class SeenBy : std::uint8_t { kPixel, kAimedRay, kGap };
std::string nameOf(SeenBy by);

struct Sighting {
  SeenPoint witness{};  // exact arithmetic confirms it
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

// The objects alone. All lists ascend. No object is in two of `witnessed`, `boxes` and `undecided_boxes`, nor
// in both `witnessed` and `undecided`.
struct ExactObjects {
  std::vector<ObjectId> witnessed{};
  std::vector<ObjectId> undecided{};
  std::vector<ObjectId> boxes{};  // not witnessed, but their bounding boxes are visible
  std::vector<ObjectId> undecided_boxes{};

  friend bool operator==(const ExactObjects&, const ExactObjects&) = default;
};
// What the frame says of objects; boxes are left empty.
ExactObjects objectsOf(const ExactFrame& frame);

// Fills in the boxes, of which ExactVisibility::decideBoxes() says what is visible. object_count: of the
// scene.
void addBoxes(const ExactVisibility& oracle, const View& view, std::uint32_t object_count,
              const ExactSettings& settings, const ParallelFor& parallel_for, ExactObjects& objects);

}  // namespace sightline::tool
