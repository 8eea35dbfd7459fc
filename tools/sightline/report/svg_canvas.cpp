#include "tools/sightline/report/svg_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/sightline/report/markup.h"

namespace sightline::tool {
namespace {

bool finite(std::span<const SvgPoint> points) {
  return std::all_of(points.begin(), points.end(),
                     [](const SvgPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); });
}

std::string paintText(const SvgPaint& paint) {
  std::string text = fmt::format(" fill=\"{}\"", escapeMarkup(paint.fill));
  if (paint.fill_opacity < 1.0) {
    text += fmt::format(" fill-opacity=\"{:.2f}\"", paint.fill_opacity);
  }
  if (paint.stroke != "none") {
    text += fmt::format(" stroke=\"{}\" stroke-width=\"{:.2f}\" stroke-linejoin=\"round\"",
                        escapeMarkup(paint.stroke), paint.width);
  }
  return paint.dashes.empty() ? text
                              : text + fmt::format(" stroke-dasharray=\"{}\"", escapeMarkup(paint.dashes));
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height, std::string_view title)
    : head_(fmt::format(
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
          "height=\"{1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\">\n<title>{2}</title>\n"
          "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
          width, height, escapeMarkup(title))) {}

void SvgCanvas::polygon(std::span<const SvgPoint> corners, const SvgPaint& paint) {
  if (corners.size() < 2 || !finite(corners)) {
    return;
  }
  body_ += "<polygon points=\"";
  for (const SvgPoint& p : corners) {
    body_ += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
  }
  body_.back() = '"';
  body_ += paintText(paint) + "/>\n";
}

void SvgCanvas::line(const SvgPoint& from, const SvgPoint& to, const SvgPaint& paint) {
  const std::array<SvgPoint, 2> ends{from, to};
  if (finite(ends)) {
    body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"{}/>\n", from.x,
                         from.y, to.x, to.y, paintText(paint));
  }
}

void SvgCanvas::arrow(const SvgPoint& from, const SvgPoint& to, const std::string& color) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0.0)) {
    return;
  }
  constexpr double kHead = 8.0, kHalfWidth = 3.5;
  const double ux = (to.x - from.x) / length, uy = (to.y - from.y) / length;
  const SvgPoint base{to.x - kHead * ux, to.y - kHead * uy};
  line(from, base, {.stroke = color, .width = 1.4});
  const std::array<SvgPoint, 3> head{to, SvgPoint{base.x - kHalfWidth * uy, base.y + kHalfWidth * ux},
                                     SvgPoint{base.x + kHalfWidth * uy, base.y - kHalfWidth * ux}};
  polygon(head, {.fill = color});
}

void SvgCanvas::circle(const SvgPoint& center, double radius, const SvgPaint& paint) {
  if (finite({&center, 1})) {
    body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"{}/>\n", center.x, center.y, radius,
                         paintText(paint));
  }
}

void SvgCanvas::rectangle(const SvgPoint& corner, const SvgPoint& size, const SvgPaint& paint) {
  const std::array<SvgPoint, 2> both{corner, size};
  if (finite(both)) {
    body_ += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"{}/>\n", corner.x,
                         corner.y, size.x, size.y, paintText(paint));
  }
}

void SvgCanvas::text(const SvgPoint& at, std::string_view words, const SvgText& style) {
  if (!finite({&at, 1})) {
    return;
  }
  constexpr std::array<const char*, 3> kAnchors{"start", "middle", "end"};
  constexpr double kMiddle = 0.35;  // of the size, from the base line up to the middle of a letter
  body_ += fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\"{}{}>{}"
      "</text>\n",
      at.x, at.y + kMiddle * style.size, style.size, kAnchors[static_cast<std::size_t>(style.anchor)],
      escapeMarkup(style.color), style.bold ? " font-weight=\"bold\"" : "",
      style.italic ? " font-style=\"italic\"" : "", escapeMarkup(words));
}

std::string SvgCanvas::file() const {
  return head_ + body_ + "</svg>\n";
}

}  // namespace sightline::tool
