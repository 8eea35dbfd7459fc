#pragma once

#include <cstdint>

namespace sightline::pvs {

// How much was asked in a bake.
struct BakeCounts {
  std::uint64_t questions = 0, asked = 0;  // as in BakeStats
  // An estimate of the time for all that was asked, in units of some 0.2 microseconds: a number that is the
  // same on each machine, whatever is kept in memory or known from an earlier bake.
  std::uint64_t work = 0;
};

}  // namespace sightline::pvs
