#pragma once

// The scenes' own random numbers: the same on every platform, unlike the standard library's distributions.
// Based on: Steele, Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014 (SplitMix64).

#include <cstdint>

namespace sightline::scenes {

// If two calls are arguments of one function, the compiler chooses their order, so store one of the values
// first.
class Random {
 public:
  constexpr explicit Random(std::uint64_t seed) : state_(seed) {}
  // A separate stream for part number `part` of the object that `seed` stands for.
  constexpr Random(std::uint64_t seed, std::uint64_t part) : state_(seed) {
    state_ = next() ^ (part * 0xd1342543de82ef95ull);
    state_ = next();
  }

  constexpr std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  // Uniform in [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  constexpr double range(double low, double high) { return low + (high - low) * uniform(); }
  // Uniform in [0, count).
  constexpr std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32);
  }
  // Uniform in [low, high].
  constexpr std::uint32_t between(std::uint32_t low, std::uint32_t high) {
    return low + below(high - low + 1);
  }
  constexpr bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t state_;
};

}  // namespace sightline::scenes
