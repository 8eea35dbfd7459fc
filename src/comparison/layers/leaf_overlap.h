#pragma once

// Compares a query with the parts of a leaf, a vector of parts at a time.

#include <array>
#include <cstdint>

#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

using layers::Interval;

// A query as intervals. A part must overlap one of them along each axis: the query's interval and, on an
// angular axis, that interval shifted by a turn in either direction, as in overlapsAngular().
struct OverlapTests {
  struct Axis {
    std::array<Interval, 3> tests;
    std::uint32_t count = 1;
  };
  std::array<Axis, kMaxExtentAxes> along;
  std::uint32_t axes = 0;
};

// Returns a word with bit i set if part i overlaps.
// bounds: for each axis `rows` lows and then `rows` highs. rows: a multiple of 8.
// count: 1 to 32 parts; rows up to the next multiple of 8 are read and ignored.
std::uint32_t overlapBits(const OverlapTests& tests, const float* bounds, std::uint32_t rows,
                          std::uint32_t count);

}  // namespace sightline::comparison
