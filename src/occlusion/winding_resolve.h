#pragma once

// From a group's boundary, drawn in tiles or in runs, to depths of the pixels that it covers.

#include <cstdint>
#include <vector>

#include "src/occlusion/boundary_runs.h"
#include "src/occlusion/winding_tiles.h"

namespace sightline::occlusion {

// A lower bound of the reciprocal depth over pixel (x, y): max(along_x x + along_y y + at_origin, floor).
struct DepthBound {
  float along_x = 0.0f, along_y = 0.0f, at_origin = 0.0f;
  float floor = 0.0f;
};

// The least reciprocal depths of a group, for blocks of pixels; a tile has whole ones.
struct FarDepths {
  static constexpr std::int32_t kWidth = 8, kHeight = 4;  // pixels of a block
  const float* least = nullptr;                           // of the blocks in the lowest row of a row of tiles
  std::uint32_t stride = 0;                               // for each row of blocks
};

// A row of tiles, and the pixels to which it belongs.
struct CoveredRow {
  const TileRowRuns* runs = nullptr;  // of a group that is drawn in runs; else null
  WindingTile* tiles = nullptr;       // of one that is not; cleared
  bool* stale = nullptr;              // by tile: set where depths may have changed
  TileExtent extent;                  // the tiles that edges have changed
  std::int32_t first = 0, end = 0;    // tiles of the group
  float* reciprocal_depth = nullptr;  // of the first pixel of the lowest row
  std::uint32_t stride = 0;
  std::int32_t width = 0, rows = 0;  // pixels that there are
};

// What drawing a group did.
struct WindingGain {
  std::uint32_t nearer = 0;  // pixels that became nearer by an eighth or more
  std::uint32_t tiles = 0;   // that were looked at
};

// Sets the pixels that a group covers to its depth where that is nearer.
WindingGain resolveFar(const CoveredRow& row, const FarDepths& depths);
// first_row: the number of the lowest row of pixels.
WindingGain resolvePlane(const CoveredRow& row, const DepthBound& depth, std::int32_t first_row);

}  // namespace sightline::occlusion
