#pragma once

// Colours of depths: from light and near to dark and far, so that they can be ordered by eye, also without
// seeing hues.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::tool {

using DepthColor = std::array<std::uint8_t, 3>;  // red, green, blue

// Two ramps of different hues; each is the colours at equal steps from the nearest to the farthest.
std::span<const DepthColor> greenRamp();  // yellow, green, blue, violet ("viridis", Smith, van der Walt 2015)
std::span<const DepthColor> redRamp();    // cream, orange, red, dark red

// Where nothing is covered; no ramp comes near it.
inline constexpr DepthColor kUncoveredColor{236, 236, 240};

// The ramp's colour at a place from 0, the nearest, to 1; places beyond are clamped.
DepthColor colorAt(std::span<const DepthColor> ramp, double place);

// Which place of a ramp a depth in metres has: equal ratios are equally far apart, so that both a room and
// the hills behind it have colours of their own.
struct DepthScale {
  double nearest = 1.0, farthest = 1.0;  // metres, 0 < nearest <= farthest

  double place(double metres) const;
};

// Round depths (1, 2 or 5 times a power of ten) within the scale, the roundest ones first.
std::vector<double> ticksOf(const DepthScale& scale);

}  // namespace sightline::tool
