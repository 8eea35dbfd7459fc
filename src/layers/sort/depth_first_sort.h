#pragma once

// Strongly connected components of the occlusion graph, front to back, by one depth-first search that starts
// from the last order. Arcs are asked for only as far as they matter: not those to parts that are in the
// output or known to be in the same group.
//
// Based on: Tarjan. Depth-first search and linear graph algorithms. SIAM J. Computing 1972.

#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/sort/layer_sort_algorithm.h"

namespace sightline::layers {

class DepthFirstSort final : public LayerSortAlgorithm {
 public:
  // Asks the source for the candidates of each part exactly once, while all parts that are not in the output
  // are active, and about each of them at most once. The result stays near the previous order. Does not
  // allocate after a call of the same size.
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order) override;

 private:
  struct Visit {
    std::uint32_t part;
    std::size_t next;  // into candidates_
  };

  void prepare(std::span<const std::uint32_t> previous);
  void search(std::uint32_t root, OccluderSource& source, GroupedOrder& order);
  void enter(std::uint32_t part, OccluderSource& source);
  void lower(std::uint32_t part, OccluderSource& source);
  void leave(std::uint32_t part, OccluderSource& source, GroupedOrder& order);
  void emit(std::uint32_t root, OccluderSource& source, GroupedOrder& order);

  // One element per part:
  std::vector<std::uint32_t> rank_;        // place in the previous order
  std::vector<std::uint32_t> found_;       // number of the visit, from 1; 0: not visited
  std::vector<std::uint32_t> low_;         // lowest found_ of the parts that it is known to reach
  std::vector<std::uint32_t> group_;       // its group in the output, or kNoGroup
  std::vector<std::size_t> first_, last_;  // range of its candidates in candidates_

  // Stacks of the parts that were visited and are not in the output yet:
  std::vector<std::uint32_t> candidates_;  // that had not been visited, part after part
  std::vector<std::uint32_t> open_;
  std::vector<Visit> path_;
  std::vector<std::uint32_t> visited_;  // scratch: candidates of a part that are open
  std::uint32_t entered_ = 0;
};

}  // namespace sightline::layers
