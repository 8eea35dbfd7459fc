#pragma once

// How far away a group of surfaces may be, by blocks of pixels.

#include <cstdint>
#include <span>

#include "src/occlusion/surfaces/boundary_edge.h"
#include "src/occlusion/surfaces/depth_target.h"
#include "src/occlusion/surfaces/winding_tiles.h"

namespace sightline::occlusion {

// The least reciprocal depths of a group, for blocks of pixels; a tile has whole ones.
struct FarDepths {
  static constexpr std::int32_t kWidth = 8, kHeight = 4;  // pixels of a block
  static constexpr std::int32_t kAcross = kTileWidth / kWidth, kUp = kTileHeight / kHeight;  // of a tile
  static constexpr std::int32_t kSpare = 16;  // what lies behind the blocks of a row may be written to

  float* least = nullptr;    // infinite in blocks in which none of the group is
  std::uint32_t stride = 0;  // for each row of blocks: those of all tiles and kSpare
};

// Lowers them to those of the parts of a group in some tiles.
void lowerFarDepths(const FarDepths& depths, const TileRange& range, std::span<const PartDepth> parts);
// Makes those in some tiles infinite. All others are already.
void clearFarDepths(const FarDepths& depths, const TileRange& range);

}  // namespace sightline::occlusion
