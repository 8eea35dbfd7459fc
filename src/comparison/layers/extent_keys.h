#pragma once

// The bounds by which a tree of extents divides, as integers with the order of the numbers.

#include <cstdint>
#include <vector>

#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::ExtentTable;
using layers::Interval;

struct KeyInterval {
  std::uint32_t low = 0, high = 0xffffffffu;  // low <= high
};

// Returns a key that grows with the number; -0 and 0 have the same key. No number has the key 0 or
// 0xffffffff.
std::uint32_t sortKey(float number);

// Returns the interval of keys that a tree uses. An angular interval across the cut at +-2 becomes the
// interval of all keys, so that a plain comparison never rules out what overlapsAngular() finds; only leaves
// handle full turns. So does an interval with low > high or with NaN.
KeyInterval keyInterval(const Interval& interval, bool angular);

// The keys of all parts along all axes.
struct ExtentKeys {
  std::vector<std::vector<std::uint32_t>> lows, highs;  // one column per axis, with one key per part

  void set(const ExtentTable& table);
};

}  // namespace sightline::comparison
