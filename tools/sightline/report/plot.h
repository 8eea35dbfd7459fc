#pragma once

// Line plots as SVG text, with one curve for each method (as in Bittner et al. 1998, figures 9 and 10).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sightline::tool {

struct PlotSeries {
  std::string name{};
  std::vector<double>
      values{};  // one for each frame; a value that is not finite (logarithmic axis: not positive) is a gap
  std::optional<std::size_t> pen{};  // index of its colour and dashes; empty: its index among the series
};

struct Plot {
  std::string title{};
  std::string x_label = "frame";
  std::string y_label{};  // with its unit: "frame time (ms)"
  std::vector<PlotSeries> series{};
  bool log_y = false;
  double first_x = 0.0, step_x = 1.0;       // x of each series' first value, and the step to the next
  std::uint32_t width = 960, height = 380;  // in the SVG's units; it scales to the space available
};

// A complete <svg> element, for an HTML page or a file of its own. Text and axes take the surrounding text
// colour (currentColor); curves differ in colour and dashes, so that they are readable on light and dark
// backgrounds and for colour-blind readers. All text is escaped.
std::string toSvg(const Plot& plot);

}  // namespace sightline::tool
