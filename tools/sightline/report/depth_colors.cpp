#include "tools/sightline/report/depth_colors.h"

#include <algorithm>
#include <cmath>

namespace sightline::tool {
namespace {

constexpr std::array<DepthColor, 9> kGreenRamp{{{253, 231, 37},
                                                {170, 220, 50},
                                                {92, 200, 99},
                                                {39, 173, 129},
                                                {33, 145, 140},
                                                {44, 113, 142},
                                                {59, 82, 139},
                                                {71, 44, 122},
                                                {68, 1, 84}}};
constexpr std::array<DepthColor, 6> kRedRamp{
    {{253, 212, 158}, {253, 187, 132}, {252, 141, 89}, {227, 74, 51}, {179, 0, 0}, {103, 0, 13}}};

}  // namespace

std::span<const DepthColor> greenRamp() {
  return kGreenRamp;
}
std::span<const DepthColor> redRamp() {
  return kRedRamp;
}

DepthColor colorAt(std::span<const DepthColor> ramp, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(ramp.size() - 1);
  const std::size_t from = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
  const double part = at - static_cast<double>(from);
  DepthColor color{};
  for (std::size_t c = 0; c < color.size(); ++c) {
    color[c] =
        static_cast<std::uint8_t>(std::lround((1.0 - part) * ramp[from][c] + part * ramp[from + 1][c]));
  }
  return color;
}

double DepthScale::place(double metres) const {
  if (!(metres > nearest)) {
    return 0.0;
  }
  return metres < farthest ? std::log(metres / nearest) / std::log(farthest / nearest) : 1.0;
}

std::vector<double> ticksOf(const DepthScale& scale) {
  std::vector<double> ticks;
  for (const double digit : {1.0, 5.0, 2.0}) {
    double power = std::pow(10.0, std::floor(std::log10(scale.nearest)));
    for (; digit * power <= scale.farthest; power *= 10.0) {
      if (digit * power >= scale.nearest) {
        ticks.push_back(digit * power);
      }
    }
  }
  return ticks;
}

}  // namespace sightline::tool
