#pragma once

// From a group's boundary, drawn in tiles or in runs, to depths of the pixels that it covers.

#include <cstdint>

#include "src/occlusion/surfaces/boundary_runs.h"
#include "src/occlusion/surfaces/depth_target.h"
#include "src/occlusion/surfaces/far_depths.h"
#include "src/occlusion/surfaces/need_map.h"
#include "src/occlusion/surfaces/square_depths.h"
#include "src/occlusion/surfaces/winding_tiles.h"

namespace sightline::occlusion {

// What a group covers of a target.
struct GroupCover {
  const TileRowRuns* runs = nullptr;    // by row of tiles, of a group that is drawn in runs; else null
  WindingTile* tiles = nullptr;         // of one that is not; cleared
  const TileExtent* extents = nullptr;  // by row of tiles, of one that is not
  SquareDepths* squares = nullptr;      // of the target; they are kept up to date
  std::int32_t columns = 0;             // tiles in a row of the target
  TileRange range;                      // those of the group
  DepthTarget target;
  const NeedMap* needs = nullptr;  // null: every pixel that becomes nearer is a gain
};

// What drawing a group did.
struct WindingGain {
  std::uint32_t nearer = 0;  // pixels that became nearer by an eighth or more, where that is needed
  std::uint32_t tiles = 0;   // that were looked at
};

// Sets the pixels that a group covers to its depth where that is nearer.
WindingGain resolveFar(const GroupCover& group, const FarDepths& depths);
WindingGain resolvePlane(const GroupCover& group, const DepthBound& depth);

}  // namespace sightline::occlusion
