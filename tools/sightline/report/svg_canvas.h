#pragma once

// Pictures made of a few lines, areas and words, as an SVG file of its own.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::tool {

struct SvgPoint {
  double x = 0.0, y = 0.0;
};

// How a shape is painted. Colours are those of CSS.
struct SvgPaint {
  std::string fill = "none", stroke = "none";
  double width = 1.0;    // of the stroke
  std::string dashes{};  // "6 4"; empty: a solid line
  double fill_opacity = 1.0;
};

struct SvgText {
  enum class Anchor { kStart, kMiddle, kEnd };
  double size = 13.0;
  Anchor anchor = Anchor::kMiddle;
  std::string color = "#222222";
  bool bold = false, italic = false;
};

// Shapes lie over each other in the order in which they are added. Units are pixels, y grows downwards.
// Shapes with a coordinate that is not finite are left out. Text is escaped.
class SvgCanvas {
 public:
  SvgCanvas(double width, double height, std::string_view title);

  void polygon(std::span<const SvgPoint> corners, const SvgPaint& paint);
  void line(const SvgPoint& from, const SvgPoint& to, const SvgPaint& paint);
  void arrow(const SvgPoint& from, const SvgPoint& to, const std::string& color);
  void circle(const SvgPoint& center, double radius, const SvgPaint& paint);
  void rectangle(const SvgPoint& corner, const SvgPoint& size, const SvgPaint& paint);
  // The middle of the text is at this height.
  void text(const SvgPoint& at, std::string_view words, const SvgText& style = {});

  // The whole file, on white paper.
  std::string file() const;

 private:
  std::string head_, body_;
};

}  // namespace sightline::tool
