#include "src/layers/split/cycle_graph.h"

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
  for (const std::uint32_t node : among) {
    counts_[node] = nodes_[node].alive ? 1 : 0;
  }
  cycles_.clear();
  components_.setNodeCount(size());
  components_.find(
      among, [this](std::uint32_t node) { return counts_[node] != 0; },
      [this](std::uint32_t node) { return std::span<const std::uint32_t>(nodes_[node].behind); },
      [this](std::span<const std::uint32_t> component) {
        if (component.size() > 1) {
          cycles_.emplace_back(component.begin(), component.end());
        }
      });
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

}  // namespace sightline::layers
