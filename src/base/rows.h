#pragma once

// Rows of items that lie one after the other in one array, with a second array that says where each row
// begins ("compressed sparse rows").

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include "sightline/base/large_vector.h"

namespace sightline::base {

// Groups items by row, keeping their order within a row: afterwards row r has items[first[r]] up to, not
// including, items[first[r + 1]]; `first` has rows + 1 entries. for_each_pair(body) calls body(row, item) for
// every pair, row < rows; it is called twice and has to give the same pairs both times.
// first, items: vectors.
template <typename Firsts, typename Items, typename ForEachPair>
void groupIntoRows(std::size_t rows, Firsts& first, Items& items, ForEachPair&& for_each_pair) {
  using Item = typename Items::value_type;
  first.assign(rows + 1, 0);
  for_each_pair([&](auto row, const Item&) { ++first[row + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  items.resize(first.back());
  // While the rows fill, first[r] is where the next item of row r goes; in the end that is where row r + 1
  // begins.
  for_each_pair([&](auto row, const Item& item) { items[first[row]++] = item; });
  std::copy_backward(first.begin(), first.end() - 1, first.end());
  first[0] = 0;
}

// Rows that are filled one after the other, or grouped all at once. Keeps its storage when it is cleared.
template <typename Item>
class Rows {
 public:
  std::size_t count() const { return first_.size() - 1; }  // of rows
  // row < count().
  std::span<const Item> operator[](std::size_t row) const {
    return {items_.data() + first_[row], items_.data() + first_[row + 1]};
  }
  std::span<Item> operator[](std::size_t row) {
    return {items_.data() + first_[row], items_.data() + first_[row + 1]};
  }
  std::span<const Item> items() const { return items_; }  // of all rows

  void clear() {
    first_.assign(1, 0);
    items_.clear();
  }
  // Adds an item to the row that the next endRow() ends.
  void add(const Item& item) { items_.push_back(item); }
  void endRow() { first_.push_back(static_cast<std::uint32_t>(items_.size())); }
  // Replaces everything: see groupIntoRows().
  template <typename ForEachPair>
  void group(std::size_t rows, ForEachPair&& for_each_pair) {
    groupIntoRows(rows, first_, items_, for_each_pair);
  }

  // The arrays themselves, to be filled at once: as those of groupIntoRows() of parallel_rows.h.
  LargeVector<std::uint32_t>& first() { return first_; }
  LargeVector<Item>& all() { return items_; }

  void shrinkToFit() { items_.shrink_to_fit(); }
  std::size_t bytes() const {  // beside the object itself
    return first_.capacity() * sizeof(std::uint32_t) + items_.capacity() * sizeof(Item);
  }

 private:
  LargeVector<std::uint32_t> first_ = LargeVector<std::uint32_t>(1, 0);
  LargeVector<Item> items_;
};

}  // namespace sightline::base
