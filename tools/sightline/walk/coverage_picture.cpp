#include "tools/sightline/walk/coverage_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/sightline/report/depth_legend.h"

namespace sightline::tool {
namespace {

constexpr double kMinMetres = 0.01;  // nearer depths have the colour of this one
constexpr double kMinRatio = 1.01;   // of the farthest to the nearest depth of a scale

double metresOf(float reciprocal_depth, bool orthographic) {
  const double value = reciprocal_depth;
  if (orthographic) {
    return std::max(kMinMetres, -value);
  }
  return value > 0.0 ? std::max(kMinMetres, 1.0 / value) : std::numeric_limits<double>::infinity();
}

DepthScale scaleOf(const std::vector<double>& metres) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
  for (const double depth : metres) {
    if (depth > 0.0 && std::isfinite(depth)) {
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  if (farthest == 0.0) {
    return {1.0, kMinRatio};
  }
  return {nearest, std::max(farthest, kMinRatio * nearest)};
}

DepthColor colorOf(const CoverageMap& map, std::size_t pixel) {
  const CoveredBy by = map.covered_by[pixel];
  return by == CoveredBy::kNothing ? kUncoveredColor
                                   : colorAt(by == CoveredBy::kSurface ? greenRamp() : redRamp(),
                                             map.scale.place(map.metres[pixel]));
}

}  // namespace

KeptDepthBuffer copyOf(const DepthBufferView& buffer) {
  KeptDepthBuffer copy{buffer.width, buffer.height, {}};
  copy.reciprocal_depth.reserve(std::size_t{buffer.width} * buffer.height);
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    copy.reciprocal_depth.insert(copy.reciprocal_depth.end(), buffer.row(y).begin(), buffer.row(y).end());
  }
  return copy;
}

CoverageMap coverageMap(const KeptDepthBuffer& buffer, const KeptDepthBuffer& occluders, CoveredBy all_by,
                        bool orthographic) {
  CoverageMap map{.width = buffer.width, .height = buffer.height};
  map.covered_by.reserve(buffer.reciprocal_depth.size());
  map.metres.reserve(buffer.reciprocal_depth.size());
  for (std::uint32_t y = buffer.height; y-- > 0;) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      const std::size_t i = std::size_t{y} * buffer.width + x;
      const float value = buffer.reciprocal_depth[i];
      CoveredBy by = CoveredBy::kNothing;
      if (value > kUncovered) {
        by = occluders.empty()                        ? all_by
             : occluders.reciprocal_depth[i] >= value ? CoveredBy::kOccluder
                                                      : CoveredBy::kSurface;
      }
      map.covered_by.push_back(by);
      map.metres.push_back(by == CoveredBy::kNothing ? 0.0 : metresOf(value, orthographic));
      map.by_surfaces += by == CoveredBy::kSurface ? 1 : 0;
      map.by_occluders += by == CoveredBy::kOccluder ? 1 : 0;
    }
  }
  map.scale = scaleOf(map.metres);
  return map;
}

Image coverageImage(const CoverageMap& map, double aspect, std::uint32_t min_width) {
  const std::uint32_t wide = std::max(1u, (min_width + map.width - 1) / map.width);
  const double high_exact = wide * map.width / (aspect * map.height);
  const auto high = static_cast<std::uint32_t>(std::clamp(std::lround(high_exact), 1l, 64l * wide));
  std::vector<DepthColor> colors(map.covered_by.size());
  for (std::size_t pixel = 0; pixel < colors.size(); ++pixel) {
    colors[pixel] = colorOf(map, pixel);
  }
  Image image{map.width * wide, map.height * high, {}};
  image.rgba.reserve(std::size_t{4} * image.width * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const DepthColor& color = colors[std::size_t{y / high} * map.width + x / wide];
      image.rgba.insert(image.rgba.end(), {color[0], color[1], color[2], 255});
    }
  }
  std::vector<std::span<const DepthColor>> ramps;
  if (map.by_surfaces > 0) {
    ramps.push_back(greenRamp());
  }
  if (map.by_occluders > 0) {
    ramps.push_back(redRamp());
  }
  return ramps.empty() ? image : withDepthLegend(image, map.scale, ramps);
}

}  // namespace sightline::tool
