#pragma once

// What `sightline info` says of a scene's cracks: how many there are by width, where most of them are, and
// what closing them would hide.

#include <cstddef>
#include <cstdint>
#include <optional>
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

// What a walk shows with the depth pyramid.
struct CrackEffect {
  std::size_t frames = 0;
  double kept_open = 0.0, kept_closed = 0.0;  // objects a frame
  double width = 0.0, slack = 0.0;            // metres
};

struct CrackFacts {
  std::vector<CrackCount> counts{};   // by width, in powers of ten
  std::vector<CrackPlace> places{};   // those with most cracks first; at most kMostPlaces
  std::optional<CrackEffect> effect;  // if it was asked for

  static constexpr std::size_t kMostPlaces = 5;
};

CrackFacts crackFactsOf(const Scene& scene, const ParallelFor& parallel_for);

// Walks with cracks open, and with those closed that are narrower than the width.
CrackEffect effectOfClosing(const SceneAndWalk& input, double width, const ParallelFor& parallel_for);

Json cracksJson(const CrackFacts& facts, const Scene& scene);
void printCracks(const CrackFacts& facts, const Scene& scene);

}  // namespace sightline::tool
