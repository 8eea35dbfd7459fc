#include "src/layers/sort/depth_first_sort.h"

#include <algorithm>

namespace sightline::layers {

namespace {

constexpr std::uint32_t kNoGroup = 0xffffffffu;

}  // namespace

// The search goes from a part to its occluders. A group is complete when the occluders of all its parts are,
// so groups are emitted front to back.
void DepthFirstSort::sort(std::span<const std::uint32_t> previous, OccluderSource& source,
                          GroupedOrder& order) {
  prepare(previous);
  order.parts.clear();
  order.arcs.clear();
  order.first_of.assign(1, 0);
  for (const std::uint32_t part : previous) {
    if (found_[part] == 0) {
      search(part, source, order);
    }
  }
  std::sort(order.arcs.begin(), order.arcs.end());
}

void DepthFirstSort::prepare(std::span<const std::uint32_t> previous) {
  std::size_t bound = 0;
  for (const std::uint32_t part : previous) {
    bound = std::max(bound, std::size_t{part} + 1);
  }
  rank_.resize(bound);
  found_.assign(bound, 0);
  low_.resize(bound);
  group_.assign(bound, kNoGroup);
  first_.resize(bound);
  last_.resize(bound);
  for (std::size_t i = 0; i < previous.size(); ++i) {
    rank_[previous[i]] = static_cast<std::uint32_t>(i);
  }
  occluders_.clear();
  open_.clear();
  path_.clear();
  // Their greatest size is known; that of occluders_ depends on the arcs.
  open_.reserve(previous.size());
  path_.reserve(previous.size());
  entered_ = 0;
}

void DepthFirstSort::search(std::uint32_t root, OccluderSource& source, GroupedOrder& order) {
  enter(root, source);
  while (!path_.empty()) {
    Visit& visit = path_.back();
    if (visit.next_edge == last_[visit.part]) {
      const std::uint32_t part = visit.part;
      path_.pop_back();
      leave(part, source, order);
      continue;
    }
    const std::uint32_t occluder = occluders_[visit.next_edge++];
    if (found_[occluder] == 0) {
      enter(occluder, source);
    } else if (group_[occluder] == kNoGroup) {
      low_[visit.part] = std::min(low_[visit.part], found_[occluder]);
    }
  }
}

void DepthFirstSort::enter(std::uint32_t part, OccluderSource& source) {
  found_[part] = low_[part] = ++entered_;
  open_.push_back(part);
  first_[part] = occluders_.size();
  source.occludersOf(std::span(&part, 1), occluders_);
  last_[part] = occluders_.size();
  std::sort(occluders_.begin() + static_cast<std::ptrdiff_t>(first_[part]), occluders_.end(),
            [this](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
  path_.push_back({part, first_[part]});
}

void DepthFirstSort::leave(std::uint32_t part, OccluderSource& source, GroupedOrder& order) {
  if (low_[part] == found_[part]) {
    emit(part, source, order);
  }
  if (!path_.empty() && group_[part] == kNoGroup) {
    const std::uint32_t parent = path_.back().part;
    low_[parent] = std::min(low_[parent], low_[part]);
  }
}

// Emits the root and all open parts that were visited after it as one group. Their occluders end occluders_.
void DepthFirstSort::emit(std::uint32_t root, OccluderSource& source, GroupedOrder& order) {
  const auto group = static_cast<std::uint32_t>(order.groups());
  const std::size_t begin = order.parts.size();
  std::uint32_t part;
  do {
    part = open_.back();
    open_.pop_back();
    group_[part] = group;
    order.parts.push_back(part);
    source.setActive(part, false);
  } while (part != root);
  std::sort(order.parts.begin() + static_cast<std::ptrdiff_t>(begin), order.parts.end(),
            [this](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
  for (std::size_t i = begin; i < order.parts.size(); ++i) {
    const std::uint32_t back = order.parts[i];
    for (std::size_t edge = first_[back]; edge < last_[back]; ++edge) {
      if (group_[occluders_[edge]] == group) {
        order.arcs.push_back({occluders_[edge], back});
      }
    }
  }
  occluders_.resize(first_[root]);
  order.first_of.push_back(static_cast<std::uint32_t>(order.parts.size()));
}

}  // namespace sightline::layers
