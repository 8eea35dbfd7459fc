#pragma once

// The occlusions within a group, and the cycles that remain while its parts are divided.

#include <cstdint>
#include <span>
#include <vector>

#include "src/base/strong_components.h"

namespace sightline::layers {

class CycleGraph {
 public:
  struct Node {
    double weight = 1.0;                          // share of a whole part
    double surface = 0.0;                         // of its hulls
    bool alive = true;                            // false: divided, or not in use
    std::vector<std::uint32_t> behind, in_front;  // the nodes that it occludes, and those that occlude it
  };
  // How much is stuck in cycles; less is better. All are sums over the cycles (strongly connected components
  // of several nodes).
  struct Score {
    double nodes = 0.0;    // of the square of its nodes
    double weight = 0.0;   // of the square of its nodes' weights
    double surface = 0.0;  // of its nodes' surfaces
  };

  std::uint32_t add(double weight, double surface);
  void addArc(std::uint32_t front, std::uint32_t back);
  // Takes back the last node and its arcs, which must be the last arcs of their nodes.
  void removeLast();

  Node& operator[](std::uint32_t node) { return nodes_[node]; }
  const Node& operator[](std::uint32_t node) const { return nodes_[node]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }

  // Finds the cycles among the living nodes, or among those of `among` only.
  Score score();
  Score score(std::span<const std::uint32_t> among);
  // The cycles of the last score().
  const std::vector<std::vector<std::uint32_t>>& cycles() const { return cycles_; }

 private:
  std::vector<Node> nodes_;
  std::vector<std::vector<std::uint32_t>> cycles_;
  // Scratch of score(): whether a node counts, one per node, and all that do.
  std::vector<std::uint8_t> counts_;
  std::vector<std::uint32_t> all_;
  base::StrongComponents components_;
};

}  // namespace sightline::layers
