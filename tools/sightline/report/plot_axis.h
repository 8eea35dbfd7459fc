#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sightline::tool {

// One axis of a plot: a range of values that ends on round numbers, and its ticks.
struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  std::vector<double> ticks{};

  // The value's place on the axis: 0 at low, 1 at high.
  double fraction(double value) const;
};

// An axis that covers [low, high] with about tick_count ticks. With with_zero it starts at 0 if low is not
// negative.
Axis linearAxis(double low, double high, int tick_count, bool with_zero);
// An axis that ends at low and high themselves, with ticks inside, for frame numbers.
Axis tightAxis(double low, double high, int tick_count);
// An axis of whole powers of ten around [low, high], both positive, with ticks at 1, 2 and 5 if there are few
// powers.
Axis logarithmicAxis(double low, double high);

// The value with as few digits as distinguish it from its neighbours: "0.5", "250,000", "1e-07".
std::string tickLabel(double value);

// The first lines of a plot as SVG, of this width and height: its title as what screen readers say, and as
// text that starts at title_x. "</svg>" closes the plot.
std::string beginningOfPlot(std::uint32_t width, std::uint32_t height, const std::string& title,
                            double title_x);

}  // namespace sightline::tool
