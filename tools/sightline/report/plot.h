#pragma once

// Line plots as SVG text for per-frame curves: one curve a method (Bittner et al. 1998, figures 9 and 10).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sightline::tool {

struct PlotSeries {
  std::string name{};
  std::vector<double>
      values{};  // one a frame; a gap where not finite (or not positive, on a logarithmic axis)
  std::optional<std::size_t> pen{};  // number of its colour and dashes; empty: its place among the series
};

struct Plot {
  std::string title{};
  std::string x_label = "frame";
  std::string y_label{};  // with its unit: "frame time (ms)"
  std::vector<PlotSeries> series{};
  bool log_y = false;
  double first_x = 0.0, step_x = 1.0;       // of each series' first value; from one value to the next
  std::uint32_t width = 960, height = 380;  // of the SVG's own units; it scales to the room there is
};

// A complete <svg> element that can stand in an HTML page or alone in a file. Text and axes take the
// surrounding text colour (currentColor), curves differ in colour and dashes: readable on light
// and dark backgrounds and for colour-blind people. Any text is escaped.
std::string toSvg(const Plot& plot);

}  // namespace sightline::tool
