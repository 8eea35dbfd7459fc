#pragma once

// Groups of surfaces whose pixels in each row are one run: to the right of all edges that begin the group
// there, and to the left of all that end it. Most flat surfaces, and the outlines of most solids, are such.

#include <cstdint>
#include <span>

#include "src/occlusion/surfaces/boundary_edge.h"
#include "src/occlusion/surfaces/winding_tiles.h"

namespace sightline::occlusion {

// The runs of a row of tiles, by row of pixels. Places are in 256ths of a pixel.
struct alignas(64) TileRowRuns {
  float after[kTileHeight];            // the rightmost place that an edge touches which begins the group
  float before[kTileHeight];           // the leftmost place that an edge touches which ends it
  std::uint32_t crossed[kTileHeight];  // all bits: an edge that begins the group crosses the row's middle
  // What follows from these:
  std::int32_t begin[kTileHeight];  // the first pixel of the run
  std::int32_t end[kTileHeight];    // the one after its last one; none if end <= begin
  TileExtent extent;                // tiles between which the runs lie; last < first: there are none
};

// Rows of tiles of a group.
struct RunRows {
  TileRowRuns* runs = nullptr;  // by row of tiles of the buffer
  TileRange tiles;              // nothing is drawn outside of them
  EdgeBuffer buffer;
};

// Whether the group has one run in each row, or so it seems: then little or nothing of it is lost if it is
// drawn in runs.
bool hasRuns(std::span<const BoundaryEdge> edges, std::span<const BoundaryChain> chains);

// Sets the runs of a group to those that its boundary leaves. Pixels in them are touched by no edge, and the
// group's winding number is 1 or more there: any boundary may be drawn.
void drawRuns(const RunRows& target, std::span<const BoundaryEdge> edges,
              std::span<const BoundaryChain> chains);

}  // namespace sightline::occlusion
