#pragma once

// A plot of points as SVG text: one of two quantities against the other, and the front of the points that
// none beats in both.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sightline::tool {

struct ScatterPoint {
  std::string name{};  // shown when the pointer is over it
  double x = 0.0;
  double y_low = 0.0, y_high = 0.0;  // drawn as a vertical line if they differ
  std::size_t group = 0;             // index into ScatterPlot::groups
  bool on_front = false;
  bool chosen = false;  // has a ring around it
};

struct ScatterPlot {
  std::string title{}, x_label{}, y_label{};  // labels with their units
  std::vector<std::string> groups{};          // each with a colour, in the legend
  std::vector<ScatterPoint> points{};         // points that are not finite and positive are left out
  std::uint32_t width = 960, height = 460;    // in the SVG's units; it scales to the space available
};

// A complete <svg> element with logarithmic axes. Points on the front are filled and joined by steps, the
// others are hollow. Text and axes take the surrounding text colour. All text is escaped.
std::string toSvg(const ScatterPlot& plot);

}  // namespace sightline::tool
