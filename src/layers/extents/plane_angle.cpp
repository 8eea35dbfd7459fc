#include "src/layers/extents/plane_angle.h"

#include <algorithm>

namespace sightline::layers {
namespace {

constexpr double kTurn = 4.0;

// Returns a difference of pseudo-angles modulo a turn, in [0, 4).
double wrapped(double difference) {
  const double turns = std::floor(difference / kTurn);
  return difference - kTurn * turns;
}

}  // namespace

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

}  // namespace sightline::layers
