#pragma once

// Which parts of a leaf overlap a query, a vector of parts at a time.

#include <array>
#include <cstdint>

#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::Interval;

// A part must overlap, along each axis, one of the tests. Spatial: the interval itself; angular: that, a turn
// on and a turn back, as in overlapsAngular().
struct OverlapTests {
  struct Axis {
    std::array<Interval, 3> tests;
    std::uint32_t count = 1;
  };
  std::array<Axis, kMaxExtentAxes> along;
  std::uint32_t axes = 0;
};

// Bounds of parts: for each axis `rows` lows and then `rows` highs, from `bounds`. Bit i of the answer: part
// i overlaps. rows: a multiple of 8. count: 1 to 32; what lies between it and the next multiple of 8 is read
// and left out.
std::uint32_t overlapBits(const OverlapTests& tests, const float* bounds, std::uint32_t rows,
                          std::uint32_t count);

}  // namespace sightline::comparison
