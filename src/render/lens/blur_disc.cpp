#include "src/render/lens/blur_disc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sightline::render {
namespace {

// The integral of sqrt(r^2 - t^2) over t from 0 to y; beyond the disc the integrand is 0.
double areaUpTo(double y, double r) {
  const double t = std::min(y, r);
  return 0.5 * (t * std::sqrt(std::max(r * r - t * t, 0.0)) + r * r * std::asin(t / r));
}

}  // namespace

void setDiameter(BlurDisc& disc, double diameter) {
  const double r = 0.5 * diameter;
  disc.area = std::numbers::pi * r * r;
  disc.half_chords.clear();
  double below = areaUpTo(0.5, r);
  disc.half_chords.push_back(2.0 * below);
  for (double y = 0.5; y < r; y += 1.0) {
    const double above = areaUpTo(y + 1.0, r);
    // The disc's part in its last row may be thinner than rounding.
    disc.half_chords.push_back(std::max(above - below, 0.0));
    below = above;
  }
}

}  // namespace sightline::render
