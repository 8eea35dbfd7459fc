#pragma once

// Seeded random numbers for tests.

#include <cstdint>
#include <random>

#include "sightline/math/vec3.h"

namespace sightline::test {

// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::mt19937_64& engine() { return engine_; }
  std::uint64_t bits() { return engine_(); }
  double in(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  // A point with each coordinate from -r to r.
  Vec3d point(double r) { return {in(-r, r), in(-r, r), in(-r, r)}; }

 private:
  std::mt19937_64 engine_;
};

// Returns a function (low, high) of uniformly distributed numbers; `random` must outlive it.
template <typename Real>
auto numbersFrom(std::mt19937& random) {
  return [&random](Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(random); };
}

}  // namespace sightline::test
