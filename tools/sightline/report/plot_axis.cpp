#include "tools/sightline/report/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/sightline/report/markup.h"

namespace sightline::tool {
namespace {

// A step of 1, 2 or 5 times a power of ten that divides the range into about `count` steps.
double roundStep(double range, int count) {
  const double rough = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double leading = rough / power;
  return power * (leading <= 1.0 ? 1.0 : leading <= 2.0 ? 2.0 : leading <= 5.0 ? 5.0 : 10.0);
}

// Adds ticks at multiples of the step, or at the ends only if doubles are too coarse for the step.
void addTicks(Axis& axis, double step) {
  if (!(std::abs(axis.low / step) < 1e15 && std::abs(axis.high / step) < 1e15)) {
    axis.ticks = {axis.low, axis.high};
    return;
  }
  const auto first = static_cast<long long>(std::ceil(axis.low / step - 1e-9));
  const auto last = static_cast<long long>(std::floor(axis.high / step + 1e-9));
  for (long long i = first; i <= last; ++i) {
    axis.ticks.push_back(static_cast<double>(i) * step);
  }
}

}  // namespace

double Axis::fraction(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

Axis linearAxis(double low, double high, int tick_count, bool with_zero) {
  if (with_zero && low >= 0.0) {
    low = 0.0;
  }
  if (!(high > low)) {
    high = low + std::max(1.0, std::abs(low));
  }
  const double step = roundStep(high - low, tick_count);
  Axis axis{.low = std::floor(low / step) * step, .high = std::ceil(high / step) * step};
  addTicks(axis, step);
  return axis;
}

Axis tightAxis(double low, double high, int tick_count) {
  Axis axis{.low = low, .high = high > low ? high : low + 1.0};
  addTicks(axis, std::max(1.0, roundStep(axis.high - axis.low, tick_count)));
  return axis;
}

Axis logarithmicAxis(double low, double high) {
  const double first = std::clamp(std::floor(std::log10(low) + 1e-9), -300.0, 300.0);
  const double last = std::clamp(std::ceil(std::log10(high) - 1e-9), first + 1.0, 301.0);
  Axis axis{.low = std::pow(10.0, first), .high = std::pow(10.0, last), .logarithmic = true};
  const bool few = last - first <= 2.0;
  for (double power = first; power <= last; ++power) {
    for (const double leading : {1.0, 2.0, 5.0}) {
      if (leading == 1.0 || (few && power < last)) {
        axis.ticks.push_back(leading * std::pow(10.0, power));
      }
    }
  }
  return axis;
}

std::string tickLabel(double value) {
  if (value == 0.0) {
    return "0";
  }
  const double size = std::abs(value);
  if (size >= 1e9 || size < 1e-4) {
    return fmt::format("{:.3g}", value);
  }
  std::string label = groupedNumber(value, 6);
  label.erase(label.find_last_not_of('0') + 1);
  if (label.back() == '.') {
    label.pop_back();
  }
  return label;
}

std::string beginningOfPlot(std::uint32_t width, std::uint32_t height, const std::string& title,
                            double title_x) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "role=\"img\" aria-label=\"{2}\" font-family=\"system-ui, -apple-system, Segoe UI, Roboto, Helvetica, "
      "Arial, sans-serif\" font-size=\"13\" fill=\"currentColor\">\n"
      "<text x=\"{3:.1f}\" y=\"22\" font-size=\"16\" font-weight=\"600\">{2}</text>\n",
      width, height, escapeMarkup(title), title_x);
}

}  // namespace sightline::tool
