#pragma once

// The rasteriser's inner loops, which draw polygons and shared edges into rows of a depth buffer. Every
// instruction set gives the same bits, and a row's bits do not depend on which other rows are drawn with it.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/polygons/buffer_polygon.h"

namespace sightline::occlusion {

// The rows of a depth buffer that one call draws.
struct RasterBand {
  float* reciprocal_depth = nullptr;    // of the whole buffer, row by row
  std::uint32_t width = 0, stride = 0;  // pixels, and from one row to the next
  std::uint32_t first_row = 0, end_row = 0;
};

// A run of pixels in each of kRows rows; a run whose first pixel is beyond its last is empty.
struct RowRuns {
  static constexpr std::uint32_t kRows = 16;

  std::int32_t first[kRows] = {}, last[kRows] = {};
};

// Floats that rows of a depth buffer have beyond their width, so that whole vectors may be written.
inline constexpr std::uint32_t kRowSlack = RowRuns::kRows;

// Scratch for one thread, kept from one use to the next.
struct RasterScratch {
  // A polygon's pixels in RowRuns::kRows rows.
  struct Part {
    const BufferPolygon* polygon = nullptr;
    RowRuns runs;
    RowRuns own;  // of a shared edge: the pixels of `runs` that the polygon touches
    // Reciprocal depth of each plane in the first pixel of each run.
    float at_first[BufferPolygon::kMaxPlanes][RowRuns::kRows];
  };
  std::vector<Part> insides;        // parts of one polygon, from its lowest row on
  std::vector<Part> shared_edges;   // of one group, in the same rows
  std::vector<RowRuns> open_edges;  // pixels near the group's open edges, in the same rows
  std::vector<float> edge_rows;     // RowRuns::kRows rows of reciprocal depth
};

// Draws the pixels that lie wholly inside each polygon. order: indices into polygons. drawn: a byte for each
// polygon, set where some of it is nearer than what the band had.
void drawInsides(const BufferPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                 RasterScratch& scratch, std::span<std::uint8_t> drawn);

// Draws the pixels that the shared edges of a group cross. group: indices into polygons. rounding: see
// bufferRounding().
void drawSharedEdges(const BufferPolygons& polygons, std::span<const std::uint32_t> group,
                     const RasterBand& band, double rounding, RasterScratch& scratch);

void fillBuffer(std::span<float> reciprocal_depth, float value);

}  // namespace sightline::occlusion
