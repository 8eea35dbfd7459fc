#pragma once

// A bake that tells how long each of its parts takes.

#include <vector>

#include "sightline/pvs/bake/bake.h"

namespace sightline::tool {

struct TimedBake {
  BakedParts parts{};
  std::vector<double> part_ms{};  // one for each part, in any order
  BakeStats stats{};              // summed over all workers
};

// Bakes all parts in the threads of parallel_for; parts are those of Bake::bakeAll.
TimedBake bakeTimed(const Bake& bake, const ParallelFor& parallel_for, const Progress& progress = {});

}  // namespace sightline::tool
