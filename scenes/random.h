#pragma once

// The scenes' own random numbers: the same on every platform, unlike the standard library's distributions.
// Based on: Steele, Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014 (SplitMix64).

#include <cstdint>

namespace sightline::scenes {

// Of two calls in one function's arguments the order is the compiler's choice: name one of the values first.
class Random {
 public:
  constexpr explicit Random(std::uint64_t seed) : state_(seed) {}
  // A stream of its own for part number `part` of whatever `seed` stands for.
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
  // In [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  constexpr double range(double low, double high) { return low + (high - low) * uniform(); }
  // In [0, count).
  constexpr std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32);
  }
  // In [low, high].
  constexpr std::uint32_t between(std::uint32_t low, std::uint32_t high) {
    return low + below(high - low + 1);
  }
  constexpr bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t state_;
};

}  // namespace sightline::scenes
