#pragma once

// Seeded random numbers between two bounds, for tests.

#include <random>

namespace sightline::test {

// Returns a function (low, high) of uniformly distributed numbers; `random` must outlive it.
template <typename Real>
auto numbersFrom(std::mt19937& random) {
  return [&random](Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(random); };
}

}  // namespace sightline::test
