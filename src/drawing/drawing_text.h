#pragma once

// What the writers of drawings share: rounded coordinates, colours, names.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/drawing/drawing.h"

namespace sightline::drawing {

struct RoundedPoint {
  std::int64_t x = 0, y = 0;  // steps of the grid

  friend bool operator==(const RoundedPoint&, const RoundedPoint&) = default;
};

struct RoundedPath {
  std::vector<RoundedPoint> points;  // no two in a row are the same; if closed, the first is not repeated
  bool closed = false;
};

// Coordinates with as many decimals as a page needs: two, and on pages below 100 units four digits in all.
class DecimalGrid {
 public:
  explicit DecimalGrid(const Drawing& drawing);

  std::int64_t round(double value) const;  // of no finite one: 0
  // As a decimal number without superfluous digits: "12", "-.5".
  void append(std::string& text, std::int64_t steps) const;
  std::string text(double value) const;
  // Of a length: what is not zero is at least one step.
  std::string lengthText(double value) const;

  // ring: closed without a repeated point. false: nothing is left of it, or a point is not finite.
  bool round(const PagePath& path, bool ring, RoundedPath& rounded) const;

 private:
  int decimals_ = 2;
  std::int64_t steps_ = 100;  // a unit
};

// "#rrggbb" as three shares of 255; none for any other text.
std::optional<std::array<int, 3>> parseColour(std::string_view text);

// A style that can be written: colours and width that are none are replaced by the defaults.
DrawingStyle usableStyle(const DrawingStyle& style);

// The object's name, or "object 12" where it has none.
std::string nameOf(const DrawingObject& object);

// Whether the painter's form: some object has an outline.
bool hasOutlines(const Drawing& drawing);

}  // namespace sightline::drawing
