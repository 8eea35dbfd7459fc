// Queries, and counts of active parts.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.4.

#include <algorithm>
#include <bit>

#include "src/comparison/layers/extent_nodes.h"

namespace sightline::comparison {
std::span<const std::uint32_t> ExtentNodes::partsOfLeaf(std::uint32_t node) const {
  return {leaf_parts_.data() + node_lists_[node].first, node_lists_[node].count};
}

std::span<const Bound> ExtentNodes::lowsOf(std::uint32_t node) const {
  return {bounds_.data() + 2 * std::size_t{node_lists_[node].first}, node_lists_[node].count};
}

std::span<const Bound> ExtentNodes::highsOf(std::uint32_t node) const {
  const List& list = node_lists_[node];
  return {bounds_.data() + 2 * std::size_t{list.first} + RowBlocks::rowsOf(list.size_class), list.count};
}

void ExtentNodes::countActive(const ExtentKeys& keys, std::uint32_t part, std::uint32_t by) {
  std::array<std::uint32_t, kMaxDepth + 2> stack;  // at most one other child per level
  std::size_t size = 1;
  stack[0] = 0;
  while (size > 0) {
    Node& node = nodes_[stack[--size]];
    node.active += by;
    if (node.axis == kNone) {
      continue;
    }
    stack[size] = node.left;
    size += keys.lows[node.axis][part] <= node.value ? 1u : 0u;
    stack[size] = node.left + 1;
    size += keys.highs[node.axis][part] > node.value ? 1u : 0u;
  }
}

// A part and a query whose intervals overlap along a node's axis have a child in common. If both have low <=
// value, it is the left one. Otherwise one low is > value, and so are both highs, since each high is >= the
// other's low; then it is the right one.
std::uint64_t ExtentNodes::query(const Query& query, std::span<std::uint32_t> seen,
                                 std::vector<std::uint32_t>& parts) const {
  std::array<std::uint32_t, kMaxDepth + 2> stack;
  std::size_t size = 1;
  stack[0] = 0;
  constexpr std::uint32_t kTogether = 32;
  std::uint64_t visited = 0;
  while (size > 0) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (node.axis != kNone) {
      const KeyInterval& keys = query.keys[node.axis];
      const Node* const children = nodes_.data() + node.left;
      stack[size] = node.left;
      size += keys.low <= node.value && children[0].active > 0 ? 1u : 0u;
      stack[size] = node.left + 1;
      size += keys.high > node.value && children[1].active > 0 ? 1u : 0u;
      continue;
    }
    const List& list = node_lists_[index];
    const std::uint32_t rows = RowBlocks::rowsOf(list.size_class);
    const float* const bounds = leaf_bounds_.data() + 2 * axes_ * std::size_t{list.first};
    visited += list.count;
    for (std::uint32_t first = 0; first < list.count; first += kTogether) {
      std::uint32_t bits =
          overlapBits(query.tests, bounds + first, rows, std::min(list.count - first, kTogether));
      for (; bits != 0; bits &= bits - 1) {
        const std::uint32_t part =
            leaf_parts_[list.first + first + static_cast<std::uint32_t>(std::countr_zero(bits))];
        if (seen[part] < query.epoch) {
          seen[part] = query.epoch;
          parts.push_back(part);
        }
      }
    }
  }
  return visited;
}

}  // namespace sightline::comparison
