#pragma once

// A disc over pixels: in each row of them a chord.

#include <vector>

namespace sightline::render {

struct BlurDisc {
  // Half the chord of row dy and of row -dy, pixels, averaged over the row's height; >= 0. The middle row
  // first.
  std::vector<double> half_chords;
  double area = 0.0;  // pixels; the sum of all chords

  int reach() const { return static_cast<int>(half_chords.size()); }  // pixels, in all directions
};

// Keeps the memory. Precondition: diameter > 0 and finite.
void setDiameter(BlurDisc& disc, double diameter);

}  // namespace sightline::render
