#include "layers/plane_angle.h"

#include <algorithm>

#include "layers/round_outwards.h"

namespace sightline::layers {
namespace {

constexpr double kTurn = 4.0;

// Of a difference of pseudo-angles: in [0, 4).
double wrapped(double difference) {
  const double turns = std::floor(difference / kTurn);
  return difference - kTurn * turns;
}

}  // namespace

AngleRange rangeBetween(const PlanePoint& low, const PlanePoint& high) {
  AngleRange range{pseudoAngle(low), pseudoAngle(high)};
  if (range.high < range.low - 2.0) {
    range.high += kTurn;
  } else if (range.high < range.low) {
    std::swap(range.low, range.high);
  }
  return range;
}

AngleRange unite(const AngleRange& a, const AngleRange& b) {
  if (a.full() || b.full()) {
    return {};
  }
  const double a_width = a.high - a.low, b_width = b.high - b.low;
  const double from_a = std::max(a_width, wrapped(b.low - a.low) + b_width);
  const double from_b = std::max(b_width, wrapped(a.low - b.low) + a_width);
  const AngleRange united =
      from_a <= from_b ? AngleRange{a.low, a.low + from_a} : AngleRange{b.low, b.low + from_b};
  return united.full() ? AngleRange{} : united;
}

Interval roundedAngles(const AngleRange& range) {
  // Near the ends of the circle there is room for rounding, so that bounds stay where they are promised.
  constexpr double kRoom = 1e-6;
  if (!(range.high - range.low < kTurn - 4.0 * kRoom)) {
    return kFullCircle;
  }
  double low = range.low, high = range.high;
  while (low < -2.0 + kRoom) {
    low += kTurn, high += kTurn;
  }
  while (low > 2.0 + kRoom) {
    low -= kTurn, high -= kTurn;
  }
  return {std::min(roundedDown(low), 2.0f), roundedUp(high)};
}

}  // namespace sightline::layers
