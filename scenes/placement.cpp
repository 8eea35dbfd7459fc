#include "scenes/placement.h"

#include <cmath>
#include <numbers>

namespace sightline::scenes {

Point2 unitVector(double turns) {
  // Whole quarter turns are exact. The rest, at most an eighth of a turn, is a Taylor series accurate to the
  // last bit or two.
  const double quarters = std::floor(turns * 4.0 + 0.5);
  const double a = (turns - quarters * 0.25) * (2.0 * std::numbers::pi);
  const double a2 = a * a;
  double c = 1.0, s = 1.0;
  for (int k = 8; k >= 1; --k) {
    c = 1.0 - c * a2 / static_cast<double>((2 * k - 1) * (2 * k));
    s = 1.0 - s * a2 / static_cast<double>((2 * k) * (2 * k + 1));
  }
  s *= a;
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

}  // namespace sightline::scenes
