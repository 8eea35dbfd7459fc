#pragma once

// Windings of a group's boundary around the pixels of a depth buffer, in tiles.

#include <cstdint>
#include <span>

#include "src/occlusion/surfaces/boundary_edge.h"

namespace sightline::occlusion {

// A tile of a depth buffer. In each row there is a bit for each pixel, the leftmost one in the lowest bit.
struct alignas(64) WindingTile {
  static constexpr std::int32_t kPlanes = 4;  // bits of a winding
  // Lower bounds of windings in two's complement, one bit of them after the other, the lowest one first.
  std::uint32_t planes[kPlanes][kTileHeight];
  std::uint32_t unknown[kTileHeight];  // a winding here went beyond what its bits can hold
  std::int32_t carry[kTileHeight];     // what edges to the left of the tile add to all of a row
};

// Which tiles of a row of them edges have changed; last < first: none.
struct TileExtent {
  std::int32_t first = 0, last = -1;
};

// Columns and rows of tiles.
struct TileRange {
  std::int32_t first_column = 0, last_column = -1, first_row = 0, last_row = -1;
};

// What a boundary is drawn into.
struct WindingTiles {
  WindingTile* tiles = nullptr;   // all zero before a group is drawn
  TileExtent* extents = nullptr;  // by row of tiles
  std::int32_t stride = 0;        // tiles a row
  EdgeBuffer buffer;
};

// Draws the boundary of a group into some tiles.
void drawTiles(const WindingTiles& target, const TileRange& range, std::span<const BoundaryEdge> edges,
               std::span<const BoundaryChain> chains);

}  // namespace sightline::occlusion
