// Based on: Tarjan. Depth-first search and linear graph algorithms. SIAM J. Computing 1972.

#include "src/layers/split/cycle_graph.h"

#include <algorithm>

namespace sightline::layers {

std::uint32_t CycleGraph::add(double weight, double surface) {
  nodes_.push_back({.weight = weight, .surface = surface});
  return size() - 1;
}

void CycleGraph::addArc(std::uint32_t front, std::uint32_t back) {
  nodes_[front].behind.push_back(back);
  nodes_[back].in_front.push_back(front);
}

void CycleGraph::removeLast() {
  const std::uint32_t last = size() - 1;
  const auto removeFrom = [last](std::vector<std::uint32_t>& list) {
    while (!list.empty() && list.back() == last) {
      list.pop_back();
    }
  };
  for (const std::uint32_t back : nodes_[last].behind) {
    removeFrom(nodes_[back].in_front);
  }
  for (const std::uint32_t front : nodes_[last].in_front) {
    removeFrom(nodes_[front].behind);
  }
  nodes_.pop_back();
}

CycleGraph::Score CycleGraph::score() {
  all_.clear();
  for (std::uint32_t node = 0; node < size(); ++node) {
    if (nodes_[node].alive) {
      all_.push_back(node);
    }
  }
  return score(all_);
}

CycleGraph::Score CycleGraph::score(std::span<const std::uint32_t> among) {
  counts_.assign(size(), 0);
  on_stack_.assign(size(), 0);
  number_.assign(size(), 0);
  low_.assign(size(), 0);
  stack_.clear();
  last_number_ = 0;
  cycles_.clear();
  for (const std::uint32_t node : among) {
    counts_[node] = nodes_[node].alive ? 1 : 0;
  }
  for (const std::uint32_t node : among) {
    if (counts_[node] != 0 && number_[node] == 0) {
      visit(node);
    }
  }
  Score score;
  for (const std::vector<std::uint32_t>& cycle : cycles_) {
    double weight = 0.0;
    for (const std::uint32_t node : cycle) {
      weight += nodes_[node].weight;
      score.surface += nodes_[node].surface;
    }
    score.weight += weight * weight;
    score.nodes += static_cast<double>(cycle.size()) * static_cast<double>(cycle.size());
  }
  return score;
}

void CycleGraph::enter(std::uint32_t node) {
  number_[node] = low_[node] = ++last_number_;
  stack_.push_back(node);
  on_stack_[node] = 1;
  path_.push_back({node, 0});
}

void CycleGraph::visit(std::uint32_t start) {
  enter(start);
  while (!path_.empty()) {
    const std::uint32_t node = path_.back().node;
    const std::vector<std::uint32_t>& behind = nodes_[node].behind;
    if (path_.back().next == behind.size()) {
      leave(node);
      continue;
    }
    const std::uint32_t back = behind[path_.back().next++];
    if (counts_[back] == 0) {
      continue;
    }
    if (number_[back] == 0) {
      enter(back);
    } else if (on_stack_[back] != 0) {
      low_[node] = std::min(low_[node], number_[back]);
    }
  }
}

// Called when all arcs of the last node of the path have been followed. If no arc leads from it, or from
// nodes found after it, to one found before it, it is the first that was found of its component, which is
// then the top of the stack, from this node on.
void CycleGraph::leave(std::uint32_t node) {
  path_.pop_back();
  if (!path_.empty()) {
    const std::uint32_t before = path_.back().node;
    low_[before] = std::min(low_[before], low_[node]);
  }
  if (low_[node] != number_[node]) {
    return;
  }
  const auto first = std::find(stack_.rbegin(), stack_.rend(), node).base() - 1;
  for (auto member = first; member != stack_.end(); ++member) {
    on_stack_[*member] = 0;
  }
  if (stack_.end() - first > 1) {
    cycles_.emplace_back(first, stack_.end());
  }
  stack_.erase(first, stack_.end());
}

}  // namespace sightline::layers
