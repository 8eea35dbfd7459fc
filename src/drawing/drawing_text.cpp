#include "src/drawing/drawing_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sightline::drawing {
namespace {

constexpr int kMaxDecimals = 15;
constexpr double kLargestCoordinate = 1e16;  // units; hundredths of it are below 2^63

}  // namespace

DecimalGrid::DecimalGrid(const Drawing& drawing) {
  const double side = std::max(drawing.width, drawing.height);
  for (double unit = side; unit < 100.0 && unit > 0.0 && decimals_ < kMaxDecimals; unit *= 10.0) {
    ++decimals_;
    steps_ *= 10;
  }
}

std::int64_t DecimalGrid::round(double value) const {
  const double limit = kLargestCoordinate * 100.0 / static_cast<double>(steps_);
  return std::isfinite(value) ? std::llround(std::clamp(value, -limit, limit) * static_cast<double>(steps_))
                              : 0;
}

void DecimalGrid::append(std::string& text, std::int64_t steps) const {
  if (steps < 0) {
    text += '-';
  }
  const auto size = static_cast<std::uint64_t>(std::abs(steps));
  const std::uint64_t whole = size / static_cast<std::uint64_t>(steps_);
  std::uint64_t rest = size % static_cast<std::uint64_t>(steps_);
  if (whole != 0 || rest == 0) {
    fmt::format_to(std::back_inserter(text), "{}", whole);
  }
  if (rest != 0) {
    int digits = decimals_;
    for (; rest % 10 == 0; rest /= 10) {
      --digits;
    }
    fmt::format_to(std::back_inserter(text), ".{:0{}}", rest, digits);
  }
}

std::string DecimalGrid::lengthText(double value) const {
  std::string text;
  append(text, value > 0.0 ? std::max<std::int64_t>(round(value), 1) : 0);
  return text;
}

bool DecimalGrid::round(const PagePath& path, bool ring, RoundedPath& rounded) const {
  rounded.points.clear();
  for (const PagePoint& p : path) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
      return false;
    }
    const RoundedPoint q{round(p.x), round(p.y)};
    if (rounded.points.empty() || rounded.points.back() != q) {
      rounded.points.push_back(q);
    }
  }
  rounded.closed = ring || (path.size() > 3 && path.front() == path.back());
  while (rounded.closed && rounded.points.size() > 1 && rounded.points.front() == rounded.points.back()) {
    rounded.points.pop_back();
  }
  // Rounding may leave two points of a closed stroke: a line back and forth.
  rounded.closed = rounded.closed && rounded.points.size() > 2;
  return rounded.points.size() > (ring ? 2u : 1u);
}

std::optional<std::array<int, 3>> parseColour(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') {
    return std::nullopt;
  }
  std::array<int, 3> colour{};
  for (std::size_t i = 0; i < 6; ++i) {
    const char c = text[i + 1];
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    if (digit < 0) {
      return std::nullopt;
    }
    colour[i / 2] = colour[i / 2] * 16 + digit;
  }
  return colour;
}

DrawingStyle usableStyle(const DrawingStyle& style) {
  DrawingStyle usable = style;
  const DrawingStyle defaults;
  if (!parseColour(style.stroke)) {
    usable.stroke = defaults.stroke;
  }
  if (!parseColour(style.paper)) {
    usable.paper = defaults.paper;
  }
  if (!std::isfinite(style.stroke_width) || style.stroke_width < 0.0) {
    usable.stroke_width = defaults.stroke_width;
  }
  return usable;
}

std::string nameOf(const DrawingObject& object) {
  return object.name.empty() ? fmt::format("object {}", object.object.value) : object.name;
}

bool hasOutlines(const Drawing& drawing) {
  for (const DrawingGroup& group : drawing.groups) {
    for (const DrawingObject& object : group.objects) {
      if (!object.outline.empty()) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace sightline::drawing
