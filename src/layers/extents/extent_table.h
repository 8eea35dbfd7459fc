#pragma once

// The extents of all parts as columns of numbers, and the test of whether two extents overlap.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/layers/extent_axis.h"

namespace sightline::layers {

// A closed interval, rounded outwards. On a spatial axis it may be infinite. On an angular axis it holds
// pseudo-angles, which grow with the angle and make a full turn in 4 (an eighth of a turn is 0.5): low is in
// [-2, 2] and high in [low, low + 4]; a width of 4 is the full circle.
struct Interval {
  float low = 0.0f, high = 0.0f;

  friend bool operator==(const Interval&, const Interval&) = default;
};

inline Interval unite(const Interval& a, const Interval& b) {
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

// One interval per axis: the bounds of a part, or a query (a part's bounds, the spatial ones widened to the
// eye).
using Extent = std::array<Interval, kMaxExtentAxes>;

// Column a holds the intervals of all parts along axis a (or of all hulls of all parts). It is padded to a
// multiple of kPadding rows with intervals that overlap nothing.
struct ExtentTable {
  static constexpr std::size_t kPadding = 16;

  std::vector<ExtentAxis::Kind> kinds;   // one per axis
  std::vector<std::vector<float>> lows;  // per axis one per part, then padding
  std::vector<std::vector<float>> highs;
  std::size_t parts = 0;

  std::size_t axes() const { return kinds.size(); }
  Interval at(std::size_t axis, std::uint32_t part) const { return {lows[axis][part], highs[axis][part]}; }
  bool angular(std::size_t axis) const { return kinds[axis] == ExtentAxis::Kind::kAngular; }
};

inline Extent extentOf(const ExtentTable& table, std::uint32_t row) {
  Extent extent{};
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    extent[axis] = table.at(axis, row);
  }
  return extent;
}

// Closed intervals that touch overlap.
inline bool overlapsSpatial(const Interval& a, const Interval& b) {
  return a.low <= b.high && b.low <= a.high;
}
// Intervals on a circle of length 4. The rounding error of adding 4 is less than the intervals' outward
// rounding.
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
