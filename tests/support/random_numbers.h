#pragma once

// Numbers between two bounds, for tests with seeds.

#include <random>

namespace sightline::test {

// A function (low, high) of numbers as likely anywhere between; `random` outlives it.
template <typename Real>
auto numbersFrom(std::mt19937& random) {
  return [&random](Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(random); };
}

}  // namespace sightline::test
