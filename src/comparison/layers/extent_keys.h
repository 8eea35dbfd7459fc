#pragma once

// The bounds by which a tree of extents divides: integers that order as the numbers do.

#include <cstdint>
#include <vector>

#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::ExtentTable;
using layers::Interval;

struct KeyInterval {
  std::uint32_t low = 0, high = 0xffffffffu;  // low <= high
};

// Ascending with the number; -0 and 0 are the same. Keys of numbers are neither 0 nor 0xffffffff.
std::uint32_t sortKey(float number);

// What a tree takes for the interval. Of an angular axis, an interval across the cut at +-2 is everything
// here, so that a plain comparison of keys never rules out what overlapsAngular() finds: only leaves know
// about turns. An interval with low > high, or of which a bound is not a number, is everything too.
KeyInterval keyInterval(const Interval& interval, bool angular);

// Keys of all parts along all axes, as columns.
struct ExtentKeys {
  std::vector<std::vector<std::uint32_t>> lows, highs;  // an axis: one a part

  void set(const ExtentTable& table);
};

}  // namespace sightline::comparison
