#pragma once

// A list in which it is known at once which of two items comes first.
//
// Based on: Bender, Cole, Demaine, Farach-Colton, Zito. Two simplified algorithms for maintaining order in a
// list. ESA 2002, section 3 (labels from a fixed range, crowded ranges are spread evenly).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::comparison {

// A doubly linked list of numbers, each at most once. Removing and comparing take constant time, inserting
// takes O(log n) amortised. No allocation in a list that was assigned as many numbers before.
class OrderLabels {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // The list is `items`, each below `bound`. Items that are not among them may be inserted later.
  void assign(std::span<const std::uint32_t> items, std::size_t bound);

  bool empty() const { return next_[head_] == head_; }
  // kNone: none.
  std::uint32_t first() const { return itemOrNone(next_[head_]); }
  std::uint32_t next(std::uint32_t item) const { return itemOrNone(next_[item]); }
  // Of items in the list: whether a comes before b.
  bool before(std::uint32_t a, std::uint32_t b) const { return labels_[a] < labels_[b]; }

  void remove(std::uint32_t item);
  void insertFirst(std::uint32_t item) { insertAfter(item, head_); }
  // place: in the list; item: not.
  void insertAfter(std::uint32_t item, std::uint32_t place);

 private:
  std::uint32_t itemOrNone(std::uint32_t node) const { return node == head_ ? kNone : node; }
  std::uint64_t gapAfter(std::uint32_t place) const;
  void spread(std::uint32_t place);

  // One an item, and last the head: it is before the first item and after the last, and its label is 0.
  std::vector<std::uint64_t> labels_;
  std::vector<std::uint32_t> next_, previous_;
  std::uint32_t head_ = 0;
  std::uint64_t step_ = 1;  // between labels of a fresh list
};

}  // namespace sightline::comparison
