#include "src/comparison/layers/extent_keys.h"

#include <bit>

namespace sightline::comparison {
namespace {

// Why plain comparison suffices away from the cut. Let a and b be angular intervals with -2 <= low and high
// <= 2 - m, m = 1e-5. The second and third clauses of overlapsAngular() need a.low + 4 <= b.high or b.low <=
// a.high - 4. In floats a.low + 4 >= 2 > b.high, since rounding is monotone and 2 is a float; and a.high - 4
// rounds to at most -2 - m + 2^-22 < -2 <= b.low. So both clauses are false and the plain comparison decides.
constexpr float kCutMargin = 1e-5f;

inline std::uint32_t sortKeyInline(float number) {
  const auto bits = std::bit_cast<std::uint32_t>(number + 0.0f);  // makes 0 of -0
  const std::uint32_t flip = (0u - (bits >> 31)) | 0x80000000u;
  return bits ^ flip;
}

}  // namespace

std::uint32_t sortKey(float number) {
  return sortKeyInline(number);
}

KeyInterval keyInterval(const Interval& interval, bool angular) {
  const bool is_ordered = interval.low <= interval.high;
  const bool is_within_cut = interval.low >= -2.0f + kCutMargin && interval.high <= 2.0f - kCutMargin;
  if (!is_ordered || (angular && !is_within_cut)) {
    return {};
  }
  return {sortKeyInline(interval.low), sortKeyInline(interval.high)};
}

void ExtentKeys::set(const ExtentTable& table) {
  lows.resize(table.axes());
  highs.resize(table.axes());
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    lows[axis].resize(table.parts);
    highs[axis].resize(table.parts);
    const bool angular = table.angular(axis);
    for (std::size_t part = 0; part < table.parts; ++part) {
      const KeyInterval keys = keyInterval({table.lows[axis][part], table.highs[axis][part]}, angular);
      lows[axis][part] = keys.low;
      highs[axis][part] = keys.high;
    }
  }
}

}  // namespace sightline::comparison
