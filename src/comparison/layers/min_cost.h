#pragma once

// Where a list of intervals is best divided in two.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.1, MinCost.
// Differs from the paper in: the sorted list of bounds is kept as two, lower and upper bounds apart (the
// paper's order is that of merging them, lower ones first where values are equal); the value and the place
// are returned too; upper bounds that cannot be the best are passed over.

#include <cstdint>
#include <span>

namespace sightline::comparison {

// A bound of an interval: bits 63..32 a key that orders as the bound's value does (see extent_keys.h), bits
// 31..1 the part, bit 0 a mark of the list's owner. Lists are ascending.
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

// An interval is in the left list iff low <= value, in the right one iff high > value.
struct Division {
  std::uint32_t cost = 0;   // length of the longer list and number of intervals in both
  std::uint32_t value = 0;  // key of the upper bound after which the lists are divided
  std::uint32_t left = 0, right = 0, shared = 0;
  std::uint32_t place = 0;  // how many bounds of the merged list come before the division

  std::uint32_t longer() const { return left > right ? left : right; }
  std::uint32_t lopsided() const { return left > right ? left - right : right - left; }
  // Of equal cost: fewest shared, then most balanced.
  bool betterThan(const Division& other) const {
    if (cost != other.cost) {
      return cost < other.cost;
    }
    return shared != other.shared ? shared < other.shared : lopsided() < other.lopsided();
  }
};

// The division of least cost; of equal ones the first. lows, highs: the bounds of the same intervals, each
// ascending; low <= high for each interval. No interval: all zero.
Division minCost(std::span<const Bound> lows, std::span<const Bound> highs);

}  // namespace sightline::comparison
