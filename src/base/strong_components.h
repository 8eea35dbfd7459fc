#pragma once

// The strongly connected components of a graph: the largest sets of nodes of which each reaches each other.
//
// Based on: Tarjan. Depth-first search and linear graph algorithms. SIAM J. Computing 1972.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::base {

// Finds the components among any of a graph's nodes. Does not allocate after a call of the same size.
class StrongComponents {
 public:
  // Makes room for nodes below `count`.
  void setNodeCount(std::size_t count) {
    number_.resize(count);
    low_.resize(count);
  }

  // Calls found(std::span<const std::uint32_t> component) once for each component among `nodes`, after all
  // components that it reaches, with its nodes in the order in which they were visited. contains(node) says
  // whether a node is one of `nodes`, of which it may leave some out; heads_of(node) is the span of the nodes
  // to which its arcs lead.
  template <typename Contains, typename HeadsOf, typename Found>
  void find(std::span<const std::uint32_t> nodes, Contains&& contains, HeadsOf&& heads_of, Found&& found) {
    for (const std::uint32_t node : nodes) {
      number_[node] = kNew;
    }
    last_number_ = kNew;
    open_.clear();
    path_.clear();
    for (const std::uint32_t node : nodes) {
      if (contains(node) && number_[node] == kNew) {
        visit(node, contains, heads_of, found);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNew = 0, kDone = 0xffffffffu;
  struct Visit {
    std::uint32_t node = 0;
    std::size_t next = 0;  // the next of its arcs
  };

  template <typename Contains, typename HeadsOf, typename Found>
  void visit(std::uint32_t root, Contains&& contains, HeadsOf&& heads_of, Found&& found) {
    enter(root);
    while (!path_.empty()) {
      const std::uint32_t node = path_.back().node;
      const std::span<const std::uint32_t> heads = heads_of(node);
      if (path_.back().next == heads.size()) {
        leave(found);
        continue;
      }
      const std::uint32_t head = heads[path_.back().next++];
      if (!contains(head)) {
        continue;
      }
      if (number_[head] == kNew) {
        enter(head);
      } else if (number_[head] != kDone) {
        low_[node] = std::min(low_[node], number_[head]);
      }
    }
  }

  void enter(std::uint32_t node) {
    number_[node] = low_[node] = ++last_number_;
    open_.push_back(node);
    path_.push_back({.node = node});
  }

  // Called when all arcs of the last node of the path have been followed. If no arc leads from it, or from
  // nodes visited after it, to one visited before it, it is the first that was visited of its component,
  // which is then all that is open from this node on.
  template <typename Found>
  void leave(Found&& found) {
    const std::uint32_t node = path_.back().node;
    path_.pop_back();
    if (!path_.empty()) {
      const std::uint32_t before = path_.back().node;
      low_[before] = std::min(low_[before], low_[node]);
    }
    if (low_[node] != number_[node]) {
      return;
    }
    const auto first = std::find(open_.rbegin(), open_.rend(), node).base() - 1;
    for (auto member = first; member != open_.end(); ++member) {
      number_[*member] = kDone;
    }
    found(std::span<const std::uint32_t>(first, open_.end()));
    open_.erase(first, open_.end());
  }

  // One per node: the number of its visit, and the lowest number of an open node that it is known to reach.
  std::vector<std::uint32_t> number_, low_;
  std::vector<std::uint32_t> open_;  // nodes that were visited, of components that were not found yet
  std::vector<Visit> path_;
  std::uint32_t last_number_ = kNew;
};

}  // namespace sightline::base
