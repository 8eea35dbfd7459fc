#pragma once

// A bake that tells what each of its parts takes.

#include <cstdint>
#include <vector>

#include "sightline/pvs/bake/bake.h"

namespace sightline::tool {

struct TimedBake {
  BakedParts parts{};
  // One for each part, in any order. The memory is that of the part's samples, and only known of parts apart.
  std::vector<double> part_ms{}, part_bytes{};
  BakeStats stats{};  // summed over all workers; of parts apart, max_sample_bytes is that of the largest
};

enum class BakedAs : std::uint8_t {
  kWhole,  // each thread keeps samples from part to part
  kApart,  // each part by itself, as in a process of its own: samples are computed anew
};

// Bakes all parts in the threads of parallel_for; parts are those of Bake::bakeAll.
TimedBake bakeTimed(const Bake& bake, BakedAs as, const ParallelFor& parallel_for,
                    const Progress& progress = {});

}  // namespace sightline::tool
