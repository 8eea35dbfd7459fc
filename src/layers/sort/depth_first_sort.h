#pragma once

// Groups of parts that occlude each other in a circle, front to back, by one search from the last order.
//
// Based on: Tarjan. Depth-first search and linear graph algorithms. SIAM J. Computing 1972.

#include <cstdint>
#include <span>
#include <vector>

#include "src/layers/sort/layer_sort_algorithm.h"

namespace sightline::layers {

class DepthFirstSort final : public LayerSortAlgorithm {
 public:
  // previous: every part that is to be sorted, each once; the result stays near this order. The source
  // answers with these parts alone; each is asked about once, while all that are not in the output are
  // active; afterwards none is. Parts of a group are in the previous order. No allocation after calls as
  // large.
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order) override;

 private:
  struct Visit {
    std::uint32_t part;
    std::size_t next_edge;  // into occluders_
  };

  void prepare(std::span<const std::uint32_t> previous);
  void search(std::uint32_t root, OccluderSource& source, GroupedOrder& order);
  void enter(std::uint32_t part, OccluderSource& source);
  void leave(std::uint32_t part, OccluderSource& source, GroupedOrder& order);
  void emit(std::uint32_t root, OccluderSource& source, GroupedOrder& order);

  // One a part.
  std::vector<std::uint32_t> rank_;        // in the previous order
  std::vector<std::uint32_t> found_;       // when it was entered, from 1; 0: not yet
  std::vector<std::uint32_t> low_;         // the earliest part that it is known to reach, by found_
  std::vector<std::uint32_t> group_;       // where it is in the output
  std::vector<std::size_t> first_, last_;  // its occluders, in occluders_

  // Of the parts that were entered and are not in the output, in the order in which they were entered.
  std::vector<std::uint32_t> occluders_;
  std::vector<std::uint32_t> open_;
  std::vector<Visit> path_;
  std::uint32_t entered_ = 0;
};

}  // namespace sightline::layers
