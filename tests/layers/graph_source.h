#pragma once

// An occlusion graph for tests of sorts, and an independent check of sorted orders.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "src/layers/sort/occluder_source.h"
#include "tests/support/strong_components.h"

namespace sightline::layers {

class GraphSource : public OccluderSource {
 public:
  explicit GraphSource(std::size_t parts) : occluders_(parts), active_(parts, 1), member_(parts, 0) {}

  // Adds an arc; loops are ignored, and an arc that is there is not added again.
  void add(std::uint32_t front, std::uint32_t back) {
    std::vector<std::uint32_t>& list = occluders_[back];
    const auto at = std::lower_bound(list.begin(), list.end(), front);
    if (front != back && (at == list.end() || *at != front)) {
      list.insert(at, front);
    }
  }
  std::size_t parts() const { return occluders_.size(); }
  bool has(std::uint32_t front, std::uint32_t back) const {
    return std::binary_search(occluders_[back].begin(), occluders_[back].end(), front);
  }
  std::span<const std::uint32_t> occludersOf(std::uint32_t back) const { return occluders_[back]; }
  bool active(std::uint32_t part) const { return active_[part] != 0; }

  // Makes all parts active and sets all counts to 0.
  void reset() {
    std::fill(active_.begin(), active_.end(), std::uint8_t{1});
    queries = pair_questions = tests = 0;
  }

  // The neighbours of a part are candidates too.
  void candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) override {
    ++queries;
    const auto begin = static_cast<std::ptrdiff_t>(candidates.size());
    candidates.insert(candidates.end(), occluders_[part].begin(), occluders_[part].end());
    for (const std::uint32_t other : {part - 1, part + 1, part + 2}) {
      if (other < parts()) {
        candidates.push_back(other);
      }
    }
    std::sort(candidates.begin() + begin, candidates.end());
    candidates.erase(std::unique(candidates.begin() + begin, candidates.end()), candidates.end());
    candidates.erase(std::remove_if(candidates.begin() + begin, candidates.end(),
                                    [this](std::uint32_t other) { return active_[other] == 0; }),
                     candidates.end());
  }
  bool candidateOccludes(std::uint32_t candidate, std::uint32_t part) override {
    ++tests;
    return has(candidate, part);
  }
  void occludersOf(std::span<const std::uint32_t> group, std::vector<std::uint32_t>& occluders) override {
    ++queries;
    const auto begin = static_cast<std::ptrdiff_t>(occluders.size());
    for (const std::uint32_t member : group) {
      member_[member] = 1;
    }
    for (const std::uint32_t member : group) {
      for (const std::uint32_t front : occluders_[member]) {
        if (active_[front] != 0 && member_[front] == 0) {
          occluders.push_back(front);
        }
      }
    }
    for (const std::uint32_t member : group) {
      member_[member] = 0;
    }
    std::sort(occluders.begin() + begin, occluders.end());
    occluders.erase(std::unique(occluders.begin() + begin, occluders.end()), occluders.end());
  }
  bool occludes(std::uint32_t front, std::uint32_t back) override {
    ++pair_questions;
    return has(front, back);
  }
  void setActive(std::uint32_t part, bool active) override { active_[part] = active ? 1 : 0; }

  std::uint64_t queries = 0, pair_questions = 0, tests = 0;

 private:
  std::vector<std::vector<std::uint32_t>> occluders_;  // one list per part, ascending
  std::vector<std::uint8_t> active_, member_;
};

// Returns the strongly connected component of each part.
inline std::vector<std::uint32_t> componentsOf(const GraphSource& graph) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;
  for (std::uint32_t back = 0; back < graph.parts(); ++back) {
    for (const std::uint32_t front : graph.occludersOf(back)) {
      arcs.emplace_back(front, back);
    }
  }
  return test::strongComponents(static_cast<std::uint32_t>(graph.parts()), arcs);
}

// Returns what is wrong with an order of all parts of the graph, or an empty text. component:
// componentsOf(graph).
inline std::string faultOf(const GroupedOrder& order, const GraphSource& graph,
                           std::span<const std::uint32_t> component) {
  const std::size_t n = graph.parts();
  if (order.parts.size() != n || order.first_of.empty() || order.first_of.front() != 0 ||
      order.first_of.back() != n) {
    return "the groups do not hold as many parts as there are";
  }
  std::vector<std::uint32_t> group(n, 0xffffffffu);
  for (std::uint32_t i = 0; i < order.groups(); ++i) {
    if (order.group(i).empty()) {
      return "a group is empty";
    }
    for (const std::uint32_t part : order.group(i)) {
      if (part >= n || group[part] != 0xffffffffu) {
        return "a part is in the order twice";
      }
      group[part] = i;
      if (component[part] != component[order.group(i).front()]) {
        return "parts of two components are in one group";
      }
    }
  }
  for (std::uint32_t front = 0; front < n; ++front) {
    for (std::uint32_t back = 0; back < n; ++back) {
      if (component[front] == component[back] && group[front] != group[back]) {
        return "a component is in two groups";
      }
      if (graph.has(front, back) && group[front] > group[back]) {
        return "a part is occluded by one of a later group";
      }
    }
  }
  return "";
}

// Returns an empty text if the parts of every group are in the order of `previous`.
inline std::string faultOfMemberOrder(const GroupedOrder& order, std::span<const std::uint32_t> previous) {
  std::vector<std::size_t> rank(previous.size());
  for (std::size_t i = 0; i < previous.size(); ++i) {
    rank[previous[i]] = i;
  }
  for (std::size_t i = 0; i < order.groups(); ++i) {
    const std::span<const std::uint32_t> parts = order.group(i);
    if (!std::is_sorted(parts.begin(), parts.end(),
                        [&](std::uint32_t a, std::uint32_t b) { return rank[a] < rank[b]; })) {
      return "a group's parts are not in the previous order";
    }
  }
  return "";
}

inline std::vector<std::uint32_t> identityOrder(std::size_t parts) {
  std::vector<std::uint32_t> order(parts);
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

inline std::uint32_t below(std::size_t bound, std::mt19937& random) {
  return static_cast<std::uint32_t>(random() % bound);
}

// Shuffles by the method of Fisher and Yates, with the same result on every platform.
inline std::vector<std::uint32_t> shuffledOrder(std::size_t parts, std::mt19937& random) {
  std::vector<std::uint32_t> order = identityOrder(parts);
  for (std::size_t i = parts; i > 1; --i) {
    std::swap(order[i - 1], order[below(i, random)]);
  }
  return order;
}

// Returns a graph that has each of the n (n - 1) arcs with a probability of per_mille / 1000.
inline GraphSource randomGraph(std::size_t parts, std::uint32_t per_mille, std::mt19937& random) {
  GraphSource graph(parts);
  for (std::uint32_t back = 0; back < parts; ++back) {
    for (std::uint32_t front = 0; front < parts; ++front) {
      if (below(1000, random) < per_mille) {
        graph.add(front, back);
      }
    }
  }
  return graph;
}

// Returns a random graph without cycles: the arcs of randomGraph() that go forwards in a shuffled order.
inline GraphSource randomAcyclicGraph(std::size_t parts, std::uint32_t per_mille, std::mt19937& random) {
  const std::vector<std::uint32_t> order = shuffledOrder(parts, random);
  GraphSource graph(parts);
  for (std::size_t b = 0; b < parts; ++b) {
    for (std::size_t f = 0; f < b; ++f) {
      if (below(1000, random) < per_mille) {
        graph.add(order[f], order[b]);
      }
    }
  }
  return graph;
}

// Returns the graph in which the k-th of the n (n - 1) ordered pairs is an arc if bit k of the number is set.
inline GraphSource numberedGraph(std::size_t parts, std::uint32_t number) {
  GraphSource graph(parts);
  for (std::uint32_t front = 0; front < parts; ++front) {
    for (std::uint32_t back = 0; back < parts; ++back) {
      if (front != back) {
        if ((number & 1u) != 0) {
          graph.add(front, back);
        }
        number >>= 1;
      }
    }
  }
  return graph;
}

// Returns a random graph with from far below one to nearly all arcs per part, but mostly about one, where
// components have all sizes.
inline GraphSource variedGraph(std::uint32_t seed, std::size_t parts, std::mt19937& random) {
  const std::uint32_t per_mille =
      seed % 3 == 0 ? below(1001, random) : (500 + below(2000, random)) / static_cast<std::uint32_t>(parts);
  return randomGraph(parts, per_mille, random);
}

// Sorts every graph of up to four parts from every previous order and returns the first fault of a result, if
// any.
template <typename Sorter>
std::string faultOfSmallGraphs(Sorter& sorter) {
  for (std::size_t parts = 0; parts <= 4; ++parts) {
    const std::uint32_t graphs = 1u << (parts == 0 ? 0 : parts * (parts - 1));
    for (std::uint32_t number = 0; number < graphs; ++number) {
      GraphSource graph = numberedGraph(parts, number);
      const std::vector<std::uint32_t> component = componentsOf(graph);
      std::vector<std::uint32_t> previous = identityOrder(parts);
      GroupedOrder order;
      do {
        graph.reset();
        sorter.sort(previous, graph, order);
        if (const std::string fault = faultOf(order, graph, component); !fault.empty()) {
          return std::to_string(parts) + " parts, graph " + std::to_string(number) + ": " + fault;
        }
      } while (std::next_permutation(previous.begin(), previous.end()));
    }
  }
  return "";
}

// The question that sorts ask, of a GraphSource.
inline bool askGraph(void* graph, std::uint32_t front, std::uint32_t back) {
  return static_cast<GraphSource*>(graph)->occludes(front, back);
}

}  // namespace sightline::layers
