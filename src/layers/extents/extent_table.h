#pragma once

// The extents of all parts as columns of numbers, and when two of them rule an occlusion out.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/layers/extent_axis.h"

namespace sightline::layers {

// Of a spatial axis: closed, may be infinite. Of an angular one: pseudo-angles, which grow with the angle and
// make a full turn in 4 (an eighth of a turn is 0.5): low in [-2, 2], high in [low, low + 4]; a width of 4 is
// the full circle. Rounded outwards.
struct Interval {
  float low = 0.0f, high = 0.0f;

  friend bool operator==(const Interval&, const Interval&) = default;
};

inline Interval unite(const Interval& a, const Interval& b) {
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

// One interval an axis: of a part, or what a part asks about (its own, its spatial ones widened to the eye).
using Extent = std::array<Interval, kMaxExtentAxes>;

// Column a holds the intervals of all parts along axis a, and is padded to whole vectors (see kPadding) with
// intervals that overlap nothing.
struct ExtentTable {
  static constexpr std::size_t kPadding = 16;

  std::vector<ExtentAxis::Kind> kinds;   // one an axis
  std::vector<std::vector<float>> lows;  // an axis: one a part, then padding
  std::vector<std::vector<float>> highs;
  std::size_t parts = 0;

  std::size_t axes() const { return kinds.size(); }
  Interval at(std::size_t axis, std::uint32_t part) const { return {lows[axis][part], highs[axis][part]}; }
  bool angular(std::size_t axis) const { return kinds[axis] == ExtentAxis::Kind::kAngular; }
};

// Closed intervals; touching is overlapping.
inline bool overlapsSpatial(const Interval& a, const Interval& b) {
  return a.low <= b.high && b.low <= a.high;
}
// On the circle of length 4. Adding 4 rounds by less than the outward rounding of the intervals allows for.
inline bool overlapsAngular(const Interval& a, const Interval& b) {
  return (a.low <= b.high && b.low <= a.high) || (a.low + 4.0f <= b.high && b.low <= a.high + 4.0f) ||
         (a.low - 4.0f <= b.high && b.low <= a.high - 4.0f);
}
inline bool overlaps(const ExtentTable& table, const Extent& query, std::uint32_t part) {
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    const Interval own = table.at(axis, part);
    if (table.angular(axis) ? !overlapsAngular(query[axis], own) : !overlapsSpatial(query[axis], own)) {
      return false;
    }
  }
  return true;
}

}  // namespace sightline::layers
