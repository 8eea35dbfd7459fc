#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sightline::base {

// Disjoint sets of the numbers 0 to n - 1 that are united step by step. Each set is named by its smallest
// number.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n = 0) { reset(n); }

  // Puts each of n numbers into a set of its own. Keeps its storage.
  void reset(std::size_t n) {
    parent_.resize(n);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  // The smallest number of the set that holds `i`.
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) {
      i = parent_[i] = parent_[parent_[i]];
    }
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace sightline::base
