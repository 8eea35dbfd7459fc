#pragma once

// Work divided into parts. Their number depends on the amount of work alone and not on the threads, so that
// results that are put together part by part are always the same.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sightline/base/parallel_for.h"

namespace sightline::base {

// Calls one(i) for all i below a number.
template <typename One>
void forEach(const ParallelFor& parallel_for, std::size_t count, const One& one) {
  parallel_for(static_cast<std::uint32_t>(count), [&one](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      one(i);
    }
  });
}

// The numbers below `size` in ranges of at most `part_size`.
class Parts {
 public:
  Parts(std::size_t size, std::size_t part_size) : size_(size), part_size_(part_size) {}

  std::size_t count() const { return (size_ + part_size_ - 1) / part_size_; }
  std::size_t begin(std::size_t part) const { return part * part_size_; }
  std::size_t end(std::size_t part) const { return std::min(size_, (part + 1) * part_size_); }

  // Calls body(part, begin, end) for each part.
  template <typename Body>
  void run(const ParallelFor& parallel_for, const Body& body) const {
    forEach(parallel_for, count(), [&](std::uint32_t part) { body(part, begin(part), end(part)); });
  }

 private:
  std::size_t size_, part_size_;
};

}  // namespace sightline::base
