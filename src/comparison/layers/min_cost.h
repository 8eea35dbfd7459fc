#pragma once

// Finds the best division of a list of intervals in two.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.1, MinCost.
// Differs from the paper in: lower and upper bounds are in two sorted lists (the paper's list is their merge,
// with lower bounds first among equal values); the value and the place are returned, too; upper bounds that
// cannot be the best are skipped.

#include <cstdint>
#include <span>

namespace sightline::comparison {

// A bound of an interval. Bits 63..32 are a key with the order of the value (extent_keys.h), bits 31..1 the
// part, and bit 0 a mark for the list's owner. Lists are ascending.
using Bound = std::uint64_t;

inline Bound makeBound(std::uint32_t key, std::uint32_t part) {
  return (Bound{key} << 32) | (Bound{part} << 1);
}
inline std::uint32_t keyOf(Bound bound) {
  return static_cast<std::uint32_t>(bound >> 32);
}
inline std::uint32_t partOf(Bound bound) {
  return static_cast<std::uint32_t>(bound) >> 1;
}

// A division by value: an interval is in the left list if low <= value, and in the right list if high >
// value.
struct Division {
  std::uint32_t cost = 0;   // length of the longer list plus the number of intervals in both
  std::uint32_t value = 0;  // key of the upper bound after which the lists are divided
  std::uint32_t left = 0, right = 0, shared = 0;
  std::uint32_t place = 0;  // number of bounds of the merged list before the division

  std::uint32_t longer() const { return left > right ? left : right; }
  std::uint32_t lopsided() const { return left > right ? left - right : right - left; }
  // At equal cost, fewer shared intervals are better, then lists of more similar lengths.
  bool betterThan(const Division& other) const {
    if (cost != other.cost) {
      return cost < other.cost;
    }
    return shared != other.shared ? shared < other.shared : lopsided() < other.lopsided();
  }
};

// Returns the division of minimum cost, and of equal ones the first; all zero if there is no interval.
// lows, highs: the bounds of the same intervals, each list ascending, with low <= high for each interval.
Division minCost(std::span<const Bound> lows, std::span<const Bound> highs);

}  // namespace sightline::comparison
