#pragma once

// The strongly connected components of a graph of a few hundred nodes at most: the reference for sorts. By
// Warshall's transitive closure, which shares no idea with them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace sightline::test {

// Returns for each of `nodes` nodes the first node of its component. arcs: pairs of nodes.
inline std::vector<std::uint32_t> strongComponents(
    std::uint32_t nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> arcs) {
  const std::size_t words = (nodes + 63) / 64;
  std::vector<std::uint64_t> reached(nodes * words);  // one row per node: a bit for each node that it reaches
  const auto reach = [&](std::uint32_t from, std::uint32_t to) {
    reached[from * words + to / 64] |= std::uint64_t{1} << (to % 64);
  };
  const auto reaches = [&](std::uint32_t from, std::uint32_t to) {
    return (reached[from * words + to / 64] >> (to % 64) & 1) != 0;
  };
  for (std::uint32_t node = 0; node < nodes; ++node) {
    reach(node, node);
  }
  for (const auto& [from, to] : arcs) {
    reach(from, to);
  }
  for (std::uint32_t via = 0; via < nodes; ++via) {
    for (std::uint32_t from = 0; from < nodes; ++from) {
      for (std::size_t word = 0; reaches(from, via) && word < words; ++word) {
        reached[from * words + word] |= reached[via * words + word];
      }
    }
  }
  std::vector<std::uint32_t> component(nodes);
  for (std::uint32_t node = 0; node < nodes; ++node) {
    while (!reaches(node, component[node]) || !reaches(component[node], node)) {
      ++component[node];
    }
  }
  return component;
}

}  // namespace sightline::test
