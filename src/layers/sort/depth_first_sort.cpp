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
  order.first_of.assign(1, 0);
  for (const std::uint32_t part : previous) {
    if (found_[part] == 0) {
      search(part, source, order);
    }
  }
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
  candidates_.clear();
  open_.clear();
  path_.clear();
  // Their greatest size is known; that of candidates_ depends on the extents.
  open_.reserve(previous.size());
  path_.reserve(previous.size());
  entered_ = 0;
}

void DepthFirstSort::search(std::uint32_t root, OccluderSource& source, GroupedOrder& order) {
  enter(root, source);
  while (!path_.empty()) {
    Visit& visit = path_.back();
    if (visit.next == last_[visit.part]) {
      const std::uint32_t part = visit.part;
      path_.pop_back();
      leave(part, source, order);
      continue;
    }
    // One that was visited since is in the output, or was reached from this part.
    const std::uint32_t candidate = candidates_[visit.next++];
    if (found_[candidate] == 0 && source.candidateOccludes(candidate, visit.part)) {
      enter(candidate, source);
    }
  }
}

void DepthFirstSort::enter(std::uint32_t part, OccluderSource& source) {
  found_[part] = low_[part] = ++entered_;
  open_.push_back(part);
  first_[part] = candidates_.size();
  source.candidatesOf(part, candidates_);
  const auto begin = candidates_.begin() + static_cast<std::ptrdiff_t>(first_[part]);
  const auto open = std::partition(begin, candidates_.end(),
                                   [this](std::uint32_t candidate) { return found_[candidate] == 0; });
  visited_.assign(open, candidates_.end());
  candidates_.erase(open, candidates_.end());
  last_[part] = candidates_.size();
  std::sort(begin, candidates_.end(),
            [this](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
  lower(part, source);
  path_.push_back({part, first_[part]});
}

// Finds the part that was visited first of those in visited_ that occlude this one: it alone matters.
void DepthFirstSort::lower(std::uint32_t part, OccluderSource& source) {
  std::sort(visited_.begin(), visited_.end(),
            [this](std::uint32_t a, std::uint32_t b) { return found_[a] < found_[b]; });
  const auto first = std::find_if(visited_.begin(), visited_.end(), [&](std::uint32_t candidate) {
    return source.candidateOccludes(candidate, part);
  });
  if (first != visited_.end()) {
    low_[part] = found_[*first];
  }
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

// Emits the root and all open parts that were visited after it as one group. Their candidates end
// candidates_.
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
  candidates_.resize(first_[root]);
  order.first_of.push_back(static_cast<std::uint32_t>(order.parts.size()));
}

}  // namespace sightline::layers
