#pragma once

// Rounded coordinates, colours and names, for all writers of drawings.

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
  std::vector<RoundedPoint> points;  // neighbours differ; if closed, the first is not repeated
  bool closed = false;
};

// Coordinates with as many decimals as the page needs: two; on pages below 100 units four digits in all.
class DecimalGrid {
 public:
  explicit DecimalGrid(const Drawing& drawing);

  std::int64_t round(double value) const;  // in steps of the grid; 0 if the value is not finite
  // Appends a decimal number without superfluous digits: "12", "-.5".
  void append(std::string& text, std::int64_t steps) const;
  // The text of a length. A length that is not zero is at least one step.
  std::string lengthText(double value) const;

  // A ring is closed and does not repeat its first point. False if nothing is left of the path, or if a point
  // is not finite.
  bool round(const PagePath& path, bool ring, RoundedPath& rounded) const;

 private:
  int decimals_ = 2;
  std::int64_t steps_ = 100;  // steps for each unit
};

// Red, green and blue (0 to 255) of "#rrggbb"; none for any other text.
std::optional<std::array<int, 3>> parseColour(std::string_view text);

// The style with invalid colours and an invalid width replaced by the defaults.
DrawingStyle usableStyle(const DrawingStyle& style);

// The object's name, or "object 12" if it has none.
std::string nameOf(const DrawingObject& object);

// Whether some object has an outline, which is so in the painter's form.
bool hasOutlines(const Drawing& drawing);

}  // namespace sightline::drawing
