#include "sightline/render/depth_of_field.h"

#include <cmath>
#include <numbers>

#include "src/render/lens/depth_of_field_circle.h"

namespace sightline {

using namespace render;

double circleOfConfusion(const View& view, const Lens& lens, double depth, std::uint32_t height) {
  return std::abs(signedCircle(view, lens, depth, height));
}

std::vector<DiscPoint> discPoints(std::uint32_t count) {
  // Half the golden angle, since there are two arms.
  constexpr double kTurn = std::numbers::pi * (2.0 - std::numbers::phi);
  std::vector<DiscPoint> points;
  points.reserve(count);
  const std::uint32_t odd = count % 2;
  if (odd) {
    points.emplace_back();
  }
  for (std::uint32_t i = 0; i < count / 2; ++i) {
    // These two points share a ring of the disc; this radius halves the ring's area.
    const double radius = 0.5 * std::sqrt((odd + 2.0 * i + 1.0) / count);
    const DiscPoint point{radius * std::cos(kTurn * i), radius * std::sin(kTurn * i)};
    points.push_back(point);
    points.push_back({-point.x, -point.y});
  }
  return points;
}

}  // namespace sightline
