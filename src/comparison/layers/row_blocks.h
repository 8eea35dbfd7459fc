#pragma once

// Allocates blocks of 8, 16, 32, ... consecutive rows of one growing array, and reuses freed blocks.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightline::comparison {

class RowBlocks {
 public:
  static constexpr std::uint32_t kMin = 8;

  // Returns the size class of the smallest block with at least `rows` rows.
  static std::uint32_t classFor(std::uint32_t rows) {
    return rows <= kMin ? 0u : static_cast<std::uint32_t>(std::bit_width((rows - 1) / kMin));
  }
  static std::uint32_t rowsOf(std::uint32_t size_class) { return kMin << size_class; }

  // Forgets all blocks but keeps the memory.
  void clear() {
    rows_ = 0;
    next_.clear();
    free_.fill(kNone);
  }
  std::uint32_t rows() const { return rows_; }  // required size of the array

  // Allocates a block and returns its first row.
  std::uint32_t take(std::uint32_t size_class) {
    std::uint32_t& free = free_[size_class];
    if (free != kNone) {
      const std::uint32_t first = free;
      free = next_[first / kMin];
      return first;
    }
    const std::uint32_t first = rows_;
    rows_ += rowsOf(size_class);
    next_.resize(rows_ / kMin);
    return first;
  }
  void give(std::uint32_t first, std::uint32_t size_class) {
    next_[first / kMin] = free_[size_class];
    free_[size_class] = first;
  }
  // Reserves memory for `rows` rows, and half as much again if it must allocate.
  void reserve(std::size_t rows) {
    if (next_.capacity() < rows / kMin) {
      next_.reserve(rows / kMin + rows / (2 * kMin));
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::uint32_t rows_ = 0;
  std::array<std::uint32_t, 29> free_{};  // one per size class: the first row of a free block
  std::vector<std::uint32_t> next_;       // at the beginning of a free block: the next free block
};

}  // namespace sightline::comparison
