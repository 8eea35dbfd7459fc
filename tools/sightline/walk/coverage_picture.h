#pragma once

// A picture of a method's depth buffer of occluders: which pixels are covered, by what, and how far away.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/io/image.h"
#include "sightline/occlusion/rasteriser.h"
#include "tools/sightline/report/depth_colors.h"

namespace sightline::tool {

// A copy of a depth buffer (DepthBufferView) without the padding of its rows; the lowest row comes first.
struct KeptDepthBuffer {
  std::uint32_t width = 0, height = 0;
  std::vector<float> reciprocal_depth{};

  bool empty() const { return reciprocal_depth.empty(); }
};
KeptDepthBuffer copyOf(const DepthBufferView& buffer);

// What covers a pixel of a depth buffer: a part of a whole surface, or a chosen occluder.
enum class CoveredBy : std::uint8_t { kNothing, kSurface, kOccluder };

struct CoverageMap {
  std::uint32_t width = 0, height = 0;
  std::vector<CoveredBy> covered_by{};  // width * height pixels, the top row first
  std::vector<double> metres{};         // depth of each pixel along the view's direction, 0 where uncovered
  std::size_t by_surfaces = 0, by_occluders = 0;  // pixels
  DepthScale scale{};                             // the depths of all covered pixels

  std::size_t covered() const { return by_surfaces + by_occluders; }
  double share() const { return static_cast<double>(covered()) / static_cast<double>(covered_by.size()); }
};

// Precondition: the buffer is not empty. occluders: a buffer of the same size with the chosen occluders
// alone; what is not nearer than they are is covered by them. Empty: everything is covered by `all_by`.
CoverageMap coverageMap(const KeptDepthBuffer& buffer, const KeptDepthBuffer& occluders, CoveredBy all_by,
                        bool orthographic);

// Each pixel of the map as a rectangle of one colour: its depth in the green ramp for surfaces, in the red
// one for occluders; below them, the legend. The picture is at least min_width pixels wide, up to the
// rounding to whole pixels of the map, and its rectangles are as high as the view's aspect asks for.
Image coverageImage(const CoverageMap& map, double aspect, std::uint32_t min_width);

}  // namespace sightline::tool
