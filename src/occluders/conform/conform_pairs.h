#pragma once

// Boxes that meet: those of a list with each other, or with a given one.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/math/box.h"

namespace sightline::occluders {

// A tree with four children a node over boxes that are sorted by size and then along a space-filling curve.
// Sorting by size first keeps the few large triangles of a scene from widening the nodes of the small ones.
class BoxPairs {
 public:
  // boxes: finite ones; numbers: one for each box, by which pairs name them.
  BoxPairs(std::span<const Box> boxes, std::span<const std::uint32_t> numbers);

  // The search is divided into this many parts, whatever the threads.
  std::uint32_t partCount() const;
  // Calls use(a, b) once for each pair of boxes that touch, with their numbers; every pair is in one part.
  template <typename Use>
  void forPairs(std::uint32_t part, Use&& use) const;
  // Calls use(a) for each box that touches the given one, with its number.
  template <typename Use>
  void forMeeting(const Box& box, Use&& use) const {
    forMeeting(
        box, [](const Box&) { return true; }, use);
  }
  // The same, but not for boxes that may_meet(box) is false for, or is false for a larger box around them.
  template <typename MayMeet, typename Use>
  void forMeeting(const Box& box, MayMeet&& may_meet, Use&& use) const;

 private:
  static constexpr std::uint32_t kWidth = 4, kLeavesOfPart = 256;

  // Boxes that only touch meet as well.
  static bool meet(const Box& a, const Box& b) {
    return (a.min.x <= b.max.x) & (b.min.x <= a.max.x) & (a.min.y <= b.max.y) & (b.min.y <= a.max.y) &
           (a.min.z <= b.max.z) & (b.min.z <= a.max.z);
  }
  template <typename Use>
  void forPairsOfLeaves(std::uint32_t leaf, std::uint32_t other, Use&& use) const;

  std::vector<Box> boxes_;              // in the order of the curve
  std::vector<std::uint32_t> numbers_;  // by box
  std::vector<std::vector<Box>>
      levels_;  // each box holds kWidth of the level before; the first one, of boxes_
};

template <typename Use>
void BoxPairs::forPairsOfLeaves(std::uint32_t leaf, std::uint32_t other, Use&& use) const {
  const auto count = static_cast<std::uint32_t>(boxes_.size());
  const std::uint32_t end = std::min(count, (leaf + 1) * kWidth),
                      other_end = std::min(count, (other + 1) * kWidth);
  for (std::uint32_t i = leaf * kWidth; i < end; ++i) {
    for (std::uint32_t k = leaf == other ? i + 1 : other * kWidth; k < other_end; ++k) {
      if (meet(boxes_[i], boxes_[k])) {
        use(numbers_[i], numbers_[k]);
      }
    }
  }
}

template <typename Use>
void BoxPairs::forPairs(std::uint32_t part, Use&& use) const {
  const auto leaves = static_cast<std::uint32_t>(levels_.empty() ? 0 : levels_[0].size());
  struct Entry {
    std::uint32_t level, node;
  };
  std::vector<Entry> open;
  for (std::uint32_t leaf = part * kLeavesOfPart; leaf < std::min(leaves, (part + 1) * kLeavesOfPart);
       ++leaf) {
    const Box& box = levels_[0][leaf];
    open.assign(1, {static_cast<std::uint32_t>(levels_.size() - 1), 0});
    while (!open.empty()) {
      const Entry at = open.back();
      open.pop_back();
      if (at.level == 0) {
        forPairsOfLeaves(leaf, at.node, use);
        continue;
      }
      const std::vector<Box>& below = levels_[at.level - 1];
      const auto end = static_cast<std::uint32_t>(
          std::min<std::size_t>(below.size(), (at.node + 1) * std::size_t{kWidth}));
      for (std::uint32_t node = at.node * kWidth; node < end; ++node) {
        // Leaves before this one have looked for their pairs with it.
        const std::uint64_t last_leaf = ((std::uint64_t{node} + 1) << (2 * (at.level - 1))) - 1;
        if (last_leaf >= leaf && meet(box, below[node])) {
          open.push_back({at.level - 1, node});
        }
      }
    }
  }
}

template <typename MayMeet, typename Use>
void BoxPairs::forMeeting(const Box& box, MayMeet&& may_meet, Use&& use) const {
  struct Entry {
    std::uint32_t level, node;  // level 0: leaves
  };
  // Each level leaves all but one of its nodes behind at most; 2^32 boxes have 16 levels.
  Entry open[16 * (kWidth - 1) + 1];
  std::uint32_t count = 0;
  if (!levels_.empty()) {
    open[count++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
  }
  while (count > 0) {
    const Entry at = open[--count];
    const std::vector<Box>& below = at.level == 0 ? boxes_ : levels_[at.level - 1];
    const auto end =
        static_cast<std::uint32_t>(std::min<std::size_t>(below.size(), (at.node + 1) * std::size_t{kWidth}));
    for (std::uint32_t i = at.node * kWidth; i < end; ++i) {
      if (meet(box, below[i]) && may_meet(below[i])) {
        if (at.level == 0) {
          use(numbers_[i]);
        } else {
          open[count++] = {at.level - 1, i};
        }
      }
    }
  }
}

}  // namespace sightline::occluders
