#pragma once

// A disc over a grid of pixels, as one chord for each row.

#include <vector>

namespace sightline::render {

struct BlurDisc {
  // half_chords[dy] is half the chord of the rows dy and -dy from the middle one, in pixels, averaged over
  // the row's height; >= 0.
  std::vector<double> half_chords;
  double area = 0.0;  // pixels; the sum of all chords

  int reach() const { return static_cast<int>(half_chords.size()); }  // pixels, in all directions
};

// Reuses the disc's memory. Precondition: diameter, in pixels, is > 0 and finite.
void setDiameter(BlurDisc& disc, double diameter);

}  // namespace sightline::render
