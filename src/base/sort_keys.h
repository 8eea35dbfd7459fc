#pragma once

// Sorts pairs of numbers in a time that grows hardly faster than their count.

#include <bit>
#include <compare>
#include <cstdint>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"

namespace sightline::base {

struct SortKey {
  std::uint64_t first = 0, second = 0;
  friend auto operator<=>(const SortKey&, const SortKey&) = default;
};

// A number that is the less, the greater the value. value: not below 0 and not NaN.
inline std::uint64_t descending(double value) {
  return ~std::bit_cast<std::uint64_t>(value);
}
// The value of that number.
inline double valueOf(std::uint64_t descending) {
  return std::bit_cast<double>(~descending);
}

// Sorts by the first number, where that is equal by the second one. Keeps its storage.
class KeySorter {
 public:
  void sort(LargeVector<SortKey>& keys, const ParallelFor& parallel_for = serialFor);

 private:
  LargeVector<SortKey> sorted_;
  std::vector<std::uint32_t> bucket_ends_;
};

}  // namespace sightline::base
