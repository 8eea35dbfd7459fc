#include "src/comparison/layers/leaf_overlap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/comparison/layers/leaf_overlap.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::comparison {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 8>;

template <class V>
HWY_INLINE auto overlapWith(const Interval& test, V lows, V highs) {
  const Lanes lanes;
  return hn::And(hn::Le(lows, hn::Set(lanes, test.high)), hn::Ge(highs, hn::Set(lanes, test.low)));
}

// Uses only comparisons, so the result is the same on every instruction set.
std::uint32_t overlapBitsOf(const OverlapTests& tests, const float* bounds, std::uint32_t rows,
                            std::uint32_t count) {
  const Lanes lanes;
  std::uint32_t bits = 0;
  for (std::uint32_t first = 0; first < count; first += static_cast<std::uint32_t>(hn::Lanes(lanes))) {
    auto overlap = hn::Eq(hn::Zero(lanes), hn::Zero(lanes));
    for (std::uint32_t axis = 0; axis < tests.axes; ++axis) {
      const float* column = bounds + 2 * std::size_t{rows} * axis + first;
      const auto lows = hn::LoadU(lanes, column), highs = hn::LoadU(lanes, column + rows);
      const OverlapTests::Axis& along = tests.along[axis];
      auto one = overlapWith(along.tests[0], lows, highs);
      if (along.count == 3) {
        one = hn::Or(
            one, hn::Or(overlapWith(along.tests[1], lows, highs), overlapWith(along.tests[2], lows, highs)));
      }
      overlap = hn::And(overlap, one);
    }
    std::uint8_t eight[8] = {};
    hn::StoreMaskBits(lanes, overlap, eight);
    bits |= std::uint32_t{eight[0]} << first;
  }
  return count < 32 ? bits & ((1u << count) - 1u) : bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::comparison
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::comparison {
namespace {

HWY_EXPORT(overlapBitsOf);

}  // namespace

std::uint32_t overlapBits(const OverlapTests& tests, const float* bounds, std::uint32_t rows,
                          std::uint32_t count) {
  return HWY_DYNAMIC_DISPATCH(overlapBitsOf)(tests, bounds, rows, count);
}

}  // namespace sightline::comparison
#endif
