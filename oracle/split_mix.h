#pragma once

// Random numbers for the oracle's samples: the same seed gives the same numbers on every machine.
// Source: Steele, Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014.

#include <cstdint>

namespace sightline {

struct SplitMix {
  std::uint64_t state;

  std::uint64_t next() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  // Returns a number in [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double in(double low, double high) { return low + (high - low) * unit(); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(next() % count); }
};

}  // namespace sightline
