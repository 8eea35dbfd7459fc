#pragma once

// What `sightline info` says of a scene's cracks: how many there are by width, where most of them are, and
// what closing them would hide.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/closed_scene.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {

struct CrackCount {
  double below = 0.0;  // metres; not below that of the count before
  std::size_t count = 0;
};

// The cracks between two objects, or within one.
struct CrackPlace {
  std::size_t count = 0;
  Crack widest{};
};

// What a walk shows with the depth pyramid, with all cracks open and with those of several widths closed.
struct CrackEffect {
  struct Closed {
    CrackNote note{};
    double kept = 0.0;  // objects a frame
  };
  std::size_t frames = 0;
  double kept_open = 0.0;  // objects a frame
  std::vector<Closed> closed{};
};

struct CrackFacts {
  std::vector<CrackCount> counts{};   // by width, in powers of ten
  std::vector<CrackPlace> places{};   // those with most cracks first; at most kMostPlaces
  std::optional<CrackEffect> effect;  // if it was asked for

  static constexpr std::size_t kMostPlaces = 5;
};

CrackFacts crackFactsOf(const Scene& scene, const ParallelFor& parallel_for);

// Walks with cracks open, and for each width with those closed that are narrower.
CrackEffect effectOfClosing(const SceneAndWalk& input, std::span<const double> widths,
                            const ParallelFor& parallel_for);

Json cracksJson(const CrackFacts& facts, const Scene& scene);
void printCracks(const CrackFacts& facts, const Scene& scene);

}  // namespace sightline::tool
