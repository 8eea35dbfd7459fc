#include "src/layers/sort/conditioning_sort.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline::layers {

namespace {

double comparable(double key) {
  return std::isnan(key) ? std::numeric_limits<double>::infinity() : key;
}

// Whether certainly no part of `passed` occludes a part of `moving`; false once no tests are left.
bool mayPass(std::span<const std::uint32_t> passed, std::span<const std::uint32_t> moving,
             const ConditioningSort::MayOcclude& may_occlude, std::uint64_t& tests_left) {
  for (const std::uint32_t front : passed) {
    for (const std::uint32_t back : moving) {
      if (tests_left == 0) {
        return false;
      }
      --tests_left;
      if (may_occlude.ask(may_occlude.user, front, back)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::uint64_t ConditioningSort::sort(std::span<const double> group_keys, std::span<const double> part_keys,
                                     const MayOcclude& may_occlude, const Settings& settings,
                                     GroupedOrder& order) {
  groups_.clear();
  for (std::uint32_t i = 0; i < order.groups(); ++i) {
    groups_.push_back({comparable(group_keys[i]), i, i});
  }
  const std::uint64_t moved = moveGroups(may_occlude, settings.max_tests, order);
  if (moved > 0) {
    rebuild(order);
  }
  sortParts(part_keys, order);
  return moved;
}

std::uint64_t ConditioningSort::moveGroups(const MayOcclude& may_occlude, std::uint64_t tests_left,
                                           const GroupedOrder& order) {
  std::uint64_t moved = 0;
  for (std::size_t i = 1; i < groups_.size() && tests_left > 0; ++i) {
    const Keyed moving = groups_[i];
    std::size_t to = i;
    while (to > 0 && moving.key < groups_[to - 1].key &&
           mayPass(order.group(groups_[to - 1].item), order.group(moving.item), may_occlude, tests_left)) {
      groups_[to] = groups_[to - 1];
      --to;
    }
    groups_[to] = moving;
    moved += to < i ? 1 : 0;
  }
  return moved;
}

void ConditioningSort::rebuild(GroupedOrder& order) {
  parts_.assign(order.parts.begin(), order.parts.end());
  first_of_.assign(order.first_of.begin(), order.first_of.end());
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const std::uint32_t group = groups_[i].item;
    for (std::uint32_t from = first_of_[group]; from < first_of_[group + 1]; ++from) {
      order.parts[end++] = parts_[from];
    }
    order.first_of[i + 1] = end;
  }
}

void ConditioningSort::sortParts(std::span<const double> part_keys, GroupedOrder& order) {
  for (std::size_t i = 0; i < order.groups(); ++i) {
    if (order.group(i).size() < 2) {
      continue;
    }
    members_.clear();
    for (std::uint32_t place = order.first_of[i]; place < order.first_of[i + 1]; ++place) {
      members_.push_back({comparable(part_keys[order.parts[place]]), place, order.parts[place]});
    }
    std::sort(members_.begin(), members_.end(), [](const Keyed& a, const Keyed& b) {
      return a.key != b.key ? a.key < b.key : a.place < b.place;
    });
    for (std::size_t k = 0; k < members_.size(); ++k) {
      order.parts[order.first_of[i] + k] = members_[k].item;
    }
  }
}

}  // namespace sightline::layers
