#include "sightline/culling/measured_renderer.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr double kFading = 1.0 - 1.0 / 32.0;  // from each frame to the next
// Numbers of triangles differ if their standard deviation is more than this part of their mean.
constexpr double kDiffer = 0.05;

}  // namespace

void MeasuredRenderer::frame(double draw_us, std::uint64_t triangles) {
  if (!std::isfinite(draw_us) || draw_us < 0.0) {
    return;
  }
  const auto count = static_cast<double>(triangles);
  const auto add = [](double& sum, double value) { sum = kFading * sum + value; };
  add(weight_, 1.0);
  add(triangles_, count);
  add(us_, draw_us);
  add(triangles_squared_, count * count);
  add(products_, count * draw_us);
}

std::optional<double> MeasuredRenderer::triangleUs() const {
  if (!(triangles_ > 0.0)) {
    return std::nullopt;
  }
  const double mean = triangles_ / weight_, mean_us = us_ / weight_;
  const double variance = triangles_squared_ / weight_ - mean * mean;
  if (variance > kDiffer * kDiffer * mean * mean) {
    const double slope = (products_ / weight_ - mean * mean_us) / variance;
    return std::isfinite(slope) ? std::max(slope, 0.0) : std::optional<double>();
  }
  const double share = us_ / triangles_;
  return std::isfinite(share) ? share : std::optional<double>();
}

}  // namespace sightline
