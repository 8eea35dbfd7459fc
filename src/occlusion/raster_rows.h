#pragma once

// The rasteriser's inner loops: polygons and seams into rows of a map. Every instruction set gives the same
// bits, and a row's bits do not depend on which other rows are drawn with it.

#include <cstdint>
#include <span>
#include <vector>

#include "occlusion/map_polygon.h"

namespace sightline::occlusion_detail {

// Rows of a map have so many more floats than their width, so that whole vectors may be written.
inline constexpr std::uint32_t kRowSlack = 64;

// Some rows of a map.
struct RasterBand {
  float* nearness = nullptr;  // of the whole map
  std::uint32_t width = 0, stride = 0;
  std::uint32_t first_row = 0, end_row = 0;  // to be drawn
};

// Of one thread; kept from one use to the next.
struct RasterScratch {
  std::vector<float> low, high;  // by edge and row: first and last pixel
  std::vector<float> seam_row;   // a row of nearness
};

// Draws the pixels that lie wholly inside each polygon; order: indices into polygons. hidden: a byte for each
// of `order`, cleared where some of it is before what the band holds.
void drawInsides(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                 RasterScratch& scratch, std::span<std::uint8_t> hidden);

// Draws the pixels that the seams of a group cross; group: indices into polygons.
void drawSeams(const MapPolygons& polygons, std::span<const std::uint32_t> group, const RasterBand& band,
               double rounding, RasterScratch& scratch);

// Draws the pixels whose centres a polygon covers.
void drawCentres(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band);

void fillMap(std::span<float> nearness, float value);

}  // namespace sightline::occlusion_detail
