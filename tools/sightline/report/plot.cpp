#include "tools/sightline/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/sightline/report/markup.h"
#include "tools/sightline/report/plot_axis.h"
#include "tools/sightline/report/plot_pens.h"

namespace sightline::tool {
namespace {

const Pen& penOf(const Plot& plot, std::size_t series) {
  return kPens[plot.series[series].pen.value_or(series) % kPens.size()];
}

constexpr double kLeft = 92.0, kRight = 18.0, kTop = 34.0, kBottom = 46.0, kLegendRow = 20.0;

// The rectangle that holds the curves, in the SVG's units, and its two axes.
struct Canvas {
  double left, top, right, bottom;
  Axis x, y;
  bool log_y;

  double px(double value) const { return left + x.fraction(value) * (right - left); }
  double py(double value) const { return bottom - y.fraction(value) * (bottom - top); }
  bool shows(double value) const { return std::isfinite(value) && (!log_y || value > 0.0); }
};

// The place of a name in the legend. Rows are filled from the left.
struct LegendEntry {
  double x, y;
};
std::vector<LegendEntry> placeLegend(const Plot& plot) {
  std::vector<LegendEntry> entries;
  double x = kLeft, y = kTop + 12.0;
  for (const PlotSeries& series : plot.series) {
    const double width = 44.0 + 7.2 * static_cast<double>(characterCount(series.name));
    if (x > kLeft && x + width > plot.width - kRight) {
      x = kLeft;
      y += kLegendRow;
    }
    entries.push_back({x, y});
    x += width;
  }
  return entries;
}

Axis yAxisOf(const Plot& plot) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const PlotSeries& series : plot.series) {
    for (const double value : series.values) {
      if (std::isfinite(value) && (!plot.log_y || value > 0.0)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  }
  if (low > high) {
    low = high = 1.0;
  }
  constexpr double kLargest = 1e300;  // leaves room for rounding up
  low = std::clamp(low, -kLargest, kLargest);
  high = std::clamp(high, -kLargest, kLargest);
  return plot.log_y ? logarithmicAxis(low, high) : linearAxis(low, high, 5, true);
}

Canvas canvasOf(const Plot& plot, double legend_bottom) {
  std::size_t longest = 1;
  for (const PlotSeries& series : plot.series) {
    longest = std::max(longest, series.values.size());
  }
  const double last_x = plot.first_x + plot.step_x * static_cast<double>(longest - 1);
  Canvas canvas{.left = kLeft,
                .top = legend_bottom,
                .right = plot.width - kRight,
                .bottom = plot.height - kBottom,
                .x = tightAxis(plot.first_x, last_x, 8),
                .y = yAxisOf(plot),
                .log_y = plot.log_y};
  canvas.right = std::max(canvas.right, canvas.left + 40.0);
  canvas.bottom = std::max(canvas.bottom, canvas.top + 40.0);
  return canvas;
}

void addAxes(std::string& out, const Plot& plot, const Canvas& c) {
  for (const double tick : c.y.ticks) {
    out += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"currentColor\" "
        "stroke-opacity=\"0.15\"/><text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" "
        "dy=\"0.35em\">{}</text>\n",
        c.left, c.py(tick), c.right, c.py(tick), c.left - 8.0, c.py(tick), tickLabel(tick));
  }
  for (const double tick : c.x.ticks) {
    out += fmt::format(
        "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"currentColor\" "
        "stroke-opacity=\"0.5\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
        c.px(tick), c.bottom, c.bottom + 5.0, c.bottom + 19.0, tickLabel(tick));
  }
  out += fmt::format(
      "<path d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\" fill=\"none\" stroke=\"currentColor\" "
      "stroke-opacity=\"0.5\"/>\n",
      c.left, c.top, c.bottom, c.right);
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                     (c.left + c.right) / 2, c.bottom + 38.0, escapeMarkup(plot.x_label));
  out +=
      fmt::format("<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                  (c.top + c.bottom) / 2, escapeMarkup(plot.y_label));
}

// Adds a series as one path. A gap starts a new stroke; a point between gaps becomes a dot by its round caps.
void addCurve(std::string& out, const Plot& plot, const Canvas& c, std::size_t index) {
  const PlotSeries& series = plot.series[index];
  std::string path;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    if (!c.shows(series.values[i])) {
      continue;
    }
    const double x = c.px(plot.first_x + plot.step_x * static_cast<double>(i));
    const double y = c.py(series.values[i]);
    const bool starts = i == 0 || !c.shows(series.values[i - 1]);
    const bool alone = starts && (i + 1 == series.values.size() || !c.shows(series.values[i + 1]));
    path += fmt::format("{}{:.1f} {:.1f}{}", starts ? "M" : "L", x, y, alone ? "h0.1" : "");
  }
  if (!path.empty()) {
    out += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"{}\" "
        "stroke-linejoin=\"round\" stroke-linecap=\"round\"><title>{}</title></path>\n",
        path, penOf(plot, index).color, penOf(plot, index).dashes, escapeMarkup(series.name));
  }
}

void addLegend(std::string& out, const Plot& plot, const std::vector<LegendEntry>& entries) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    out += fmt::format(
        "<path d=\"M{:.1f} {:.1f}h26\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.4\" "
        "stroke-dasharray=\"{}\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" dy=\"0.35em\">{}</text>\n",
        entries[i].x, entries[i].y, penOf(plot, i).color, penOf(plot, i).dashes, entries[i].x + 32.0,
        entries[i].y, escapeMarkup(plot.series[i].name));
  }
}

}  // namespace

std::string toSvg(const Plot& plot) {
  const std::vector<LegendEntry> legend = placeLegend(plot);
  const Canvas canvas = canvasOf(plot, legend.empty() ? kTop + 8.0 : legend.back().y + 20.0);
  std::string out = beginningOfPlot(plot.width, plot.height, plot.title, kLeft);
  addAxes(out, plot, canvas);
  addLegend(out, plot, legend);
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    addCurve(out, plot, canvas, i);
  }
  return out + "</svg>\n";
}

}  // namespace sightline::tool
