#pragma once

// A list that tells in constant time which of two items comes first.
//
// Based on: Bender, Cole, Demaine, Farach-Colton, Zito. Two simplified algorithms for maintaining order in a
// list. ESA 2002, section 3 (labels from a fixed range, crowded ranges are spread evenly).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::comparison {

// A doubly linked list of distinct numbers. Removing and comparing take constant time, inserting takes O(log
// n) amortised. Does not allocate in a list that has been assigned as many numbers before.
class OrderLabels {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Sets the list to `items`. bound: above all items, also those that are inserted later.
  void assign(std::span<const std::uint32_t> items, std::size_t bound);

  bool empty() const { return next_[head_] == head_; }
  // Returns the first item, or kNone.
  std::uint32_t first() const { return itemOrNone(next_[head_]); }
  std::uint32_t next(std::uint32_t item) const { return itemOrNone(next_[item]); }
  // Whether a comes before b; both are in the list.
  bool before(std::uint32_t a, std::uint32_t b) const { return labels_[a] < labels_[b]; }

  void remove(std::uint32_t item);
  void insertFirst(std::uint32_t item) { insertAfter(item, head_); }
  // Inserts an item that is not in the list after one that is.
  void insertAfter(std::uint32_t item, std::uint32_t place);

 private:
  std::uint32_t itemOrNone(std::uint32_t node) const { return node == head_ ? kNone : node; }
  std::uint64_t gapAfter(std::uint32_t place) const;
  void spread(std::uint32_t place);

  // One element per item, and then the head, which is before the first item and after the last and has label
  // 0.
  std::vector<std::uint64_t> labels_;
  std::vector<std::uint32_t> next_, previous_;
  std::uint32_t head_ = 0;
  std::uint64_t step_ = 1;  // difference of neighbouring labels in a fresh list
};

}  // namespace sightline::comparison
