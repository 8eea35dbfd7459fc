#pragma once

// The rasteriser's inner loops: polygons and seams into rows of a map. Every instruction set gives the same
// bits, and a row's bits do not depend on which other rows are drawn with it.

#include <cstdint>
#include <span>
#include <vector>

#include "src/occlusion/map_polygon.h"

namespace sightline::occlusion {

// Some rows of a map.
struct RasterBand {
  float* reciprocal_depth = nullptr;  // of the whole map
  std::uint32_t width = 0, stride = 0;
  std::uint32_t first_row = 0, end_row = 0;  // to be drawn
};

// First and last pixels in some rows; where the first is beyond the last there are none.
struct RowRuns {
  static constexpr std::uint32_t kRows = 16;

  std::int32_t first[kRows] = {}, last[kRows] = {};
};

// Rows of a map have so many more floats than their width, so that whole vectors may be written.
inline constexpr std::uint32_t kRowSlack = RowRuns::kRows;

// Of one thread; kept from one use to the next.
struct RasterScratch {
  // A polygon's pixels in RowRuns::kRows rows, with the reciprocal depth of its planes in the first one of
  // each row.
  struct Part {
    const MapPolygon* polygon = nullptr;
    RowRuns runs;
    RowRuns own;  // seams: those of them that the polygon touches
    float at_first[MapPolygon::kMaxPlanes][RowRuns::kRows];
  };
  std::vector<Part> insides;  // of a polygon, from its lowest row on
  std::vector<Part> seams;    // of a group, in the same rows
  std::vector<RowRuns> ends;
  std::vector<float> seam_rows;  // of reciprocal depth: RowRuns::kRows rows
};

// Draws the pixels that lie wholly inside each polygon; order: indices into polygons. drawn: a byte for each
// polygon, set where some of it is nearer than what the band had.
void drawInsides(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                 RasterScratch& scratch, std::span<std::uint8_t> drawn);

// Draws the pixels that the seams of a group cross; group: indices into polygons.
void drawSeams(const MapPolygons& polygons, std::span<const std::uint32_t> group, const RasterBand& band,
               double rounding, RasterScratch& scratch);

// Draws the pixels whose centres a polygon covers.
void drawCentres(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band);

void fillMap(std::span<float> reciprocal_depth, float value);

}  // namespace sightline::occlusion
