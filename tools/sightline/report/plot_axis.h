#pragma once

#include <string>
#include <vector>

namespace sightline::tool {

// One axis of a plot: a range of values that ends on round numbers, and its ticks.
struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  std::vector<double> ticks{};

  // 0 at low, 1 at high.
  double fraction(double value) const;
};

// Covers [low, high] with about so many ticks; starts at 0 when low is not negative and with_zero.
Axis linearAxis(double low, double high, int tick_count, bool with_zero);
// Ends at the data itself, ticks inside: for frame numbers.
Axis tightAxis(double low, double high, int tick_count);
// Whole powers of ten around [low, high], both positive; ticks at 1, 2 and 5 when there are few powers.
Axis logarithmicAxis(double low, double high);

// As few digits as tell it from its neighbours: "0.5", "250,000", "1e-07".
std::string tickLabel(double value);

}  // namespace sightline::tool
