#pragma once

// Divides a range of boxes in two along the axis on which their centres are spread most, in as many calls as
// the caller likes.
//
// Based on: Hoare. Algorithm 65: Find. CACM 1961. Differs from the paper in: it can stop at any step.

#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/math/box.h"

namespace sightline::hierarchy {

// A number of the caller's, and a well-formed box.
struct NumberedBox {
  std::uint32_t number = 0;
  Box box;
};

// By centres along an axis; where these are equal, by number. So the order is that of the boxes alone, and a
// division gives the same two sets wherever it stops in between.
struct AlongAxis {
  int axis = 0;
  bool operator()(const NumberedBox& a, const NumberedBox& b) const {
    const float x = a.box.min[axis] + a.box.max[axis], y = b.box.min[axis] + b.box.max[axis];
    return x != y ? x < y : a.number < b.number;
  }
};

class SlicedDivision {
 public:
  // Begins to divide `count` items from `first` on, `left` of which come before the others.
  void begin(std::size_t first, std::size_t count, std::size_t left);
  // Returns whether it is done. Takes from `steps` what it took, and at most 512 steps more than there were.
  // A step is about 20 nanoseconds. items: the same in each call.
  bool proceed(std::span<NumberedBox> items, std::uint32_t& steps);

 private:
  void choosePivot(std::span<NumberedBox> items);
  void partition(std::span<NumberedBox> items, std::uint32_t& steps);

  std::size_t end_ = 0, middle_ = 0;
  std::size_t scanned_ = 0;  // items before this have been looked at for the axis
  Vec3d least_, most_;       // of the centres of these
  AlongAxis before_;
  // All items before low_ come before the middle, and all from high_ on behind it.
  std::size_t low_ = 0, high_ = 0;
  // While items are compared with the one at low_: those from low_ + 1 to next_ come before it, those from
  // last_ on after it.
  bool partitioning_ = false;
  std::size_t next_ = 0, last_ = 0;
};

}  // namespace sightline::hierarchy
