#include "tools/sightline/report/scatter_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/sightline/report/markup.h"
#include "tools/sightline/report/plot_axis.h"
#include "tools/sightline/report/plot_pens.h"

namespace sightline::tool {
namespace {

constexpr double kScatterLeft = 92.0, kScatterRight = 18.0, kScatterTop = 64.0, kScatterBottom = 46.0;

bool isShown(const ScatterPoint& point) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  return positive(point.x) && positive(point.y_low) && positive(point.y_high);
}

struct ScatterCanvas {
  double right, bottom;
  Axis x, y;

  double px(double value) const { return kScatterLeft + x.fraction(value) * (right - kScatterLeft); }
  double py(double value) const { return bottom - y.fraction(value) * (bottom - kScatterTop); }
};

ScatterCanvas canvasFor(const ScatterPlot& plot, const std::vector<ScatterPoint>& shown) {
  double x_low = 1.0, x_high = 1.0, y_low = 1.0, y_high = 1.0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const ScatterPoint& point = shown[i];
    x_low = i == 0 ? point.x : std::min(x_low, point.x);
    x_high = i == 0 ? point.x : std::max(x_high, point.x);
    y_low = i == 0 ? point.y_low : std::min(y_low, point.y_low);
    y_high = i == 0 ? point.y_high : std::max(y_high, point.y_high);
  }
  return {plot.width - kScatterRight, plot.height - kScatterBottom, logarithmicAxis(x_low, x_high),
          logarithmicAxis(y_low, y_high)};
}

void addScatterAxes(std::string& out, const ScatterPlot& plot, const ScatterCanvas& c) {
  for (const double tick : c.y.ticks) {
    out += fmt::format(
        "<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/><text "
        "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" dy=\"0.35em\">{}</text>\n",
        kScatterLeft, c.py(tick), c.right, kScatterLeft - 8.0, c.py(tick), tickLabel(tick));
  }
  for (const double tick : c.x.ticks) {
    out += fmt::format(
        "<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/><text "
        "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
        c.px(tick), kScatterTop, c.bottom, c.px(tick), c.bottom + 19.0, tickLabel(tick));
  }
  out += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kScatterLeft + c.right) / 2, c.bottom + 38.0, escapeMarkup(plot.x_label), (kScatterTop + c.bottom) / 2,
      escapeMarkup(plot.y_label));
}

void addGroups(std::string& out, const ScatterPlot& plot) {
  double x = kScatterLeft;
  for (std::size_t g = 0; g < plot.groups.size(); ++g) {
    out += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"44\" r=\"5\" fill=\"{}\"/><text x=\"{:.1f}\" y=\"44\" "
        "dy=\"0.35em\">{}</text>\n",
        x + 6.0, kPens[g % kPens.size()].color, x + 16.0, escapeMarkup(plot.groups[g]));
    x += 34.0 + 7.2 * static_cast<double>(characterCount(plot.groups[g]));
  }
}

// Adds the boundary between what is reached and what is not: steps from point to point.
void addFront(std::string& out, const ScatterCanvas& c, std::vector<ScatterPoint> shown) {
  std::erase_if(shown, [](const ScatterPoint& point) { return !point.on_front; });
  std::sort(shown.begin(), shown.end(),
            [](const ScatterPoint& a, const ScatterPoint& b) { return a.x < b.x; });
  std::string path;
  for (const ScatterPoint& point : shown) {
    path += path.empty() ? fmt::format("M{:.1f} {:.1f}", c.px(point.x), c.py(point.y_high))
                         : fmt::format("H{:.1f}V{:.1f}", c.px(point.x), c.py(point.y_high));
  }
  if (!path.empty()) {
    out += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-opacity=\"0.45\" stroke-dasharray=\"4 "
        "3\"/>\n",
        path);
  }
}

void addPoint(std::string& out, const ScatterCanvas& c, const ScatterPoint& point) {
  const char* color = kPens[point.group % kPens.size()].color;
  const double x = c.px(point.x), low = c.py(point.y_low), high = c.py(point.y_high);
  out += fmt::format("<g stroke=\"{0}\"><title>{1}</title>", color, escapeMarkup(point.name));
  if (low - high > 0.5) {
    out += fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke-width=\"1.5\"/>", x, low, high);
  }
  if (point.chosen) {
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"10\" fill=\"none\" stroke-width=\"2\"/>", x,
                       high);
  }
  out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\" stroke-width=\"1.5\"/></g>\n",
                     x, high, point.on_front ? color : "transparent");
}

}  // namespace

std::string toSvg(const ScatterPlot& plot) {
  std::vector<ScatterPoint> shown = plot.points;
  std::erase_if(shown, [](const ScatterPoint& point) { return !isShown(point); });
  const ScatterCanvas canvas = canvasFor(plot, shown);
  std::string out = beginningOfPlot(plot.width, plot.height, plot.title, kScatterLeft);
  addScatterAxes(out, plot, canvas);
  addGroups(out, plot);
  addFront(out, canvas, shown);
  for (const ScatterPoint& point : shown) {
    addPoint(out, canvas, point);
  }
  return out + "</svg>\n";
}

}  // namespace sightline::tool
