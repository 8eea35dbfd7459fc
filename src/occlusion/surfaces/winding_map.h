#pragma once

// Draws surfaces into a depth buffer by the winding of their boundaries. See docs/conservative.md,
// "Surfaces".

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "src/occlusion/surfaces/boundary_edge.h"
#include "src/occlusion/surfaces/boundary_runs.h"
#include "src/occlusion/surfaces/depth_target.h"
#include "src/occlusion/surfaces/need_map.h"
#include "src/occlusion/surfaces/square_depths.h"
#include "src/occlusion/surfaces/winding_resolve.h"
#include "src/occlusion/surfaces/winding_tiles.h"

namespace sightline::occlusion {

// Surfaces that are drawn together: all of their boundary, and how far away they are.
struct WindingGroup {
  PixelRectangle rectangle;  // nothing is drawn outside of the tiles that have a part of it
  std::span<const BoundaryChain> boundary{};
  std::span<const PartDepth> depths{};  // of all of the group; parts may overlap
  bool flat = false;                    // all of it has the depth of the first of them, everywhere
};

class WindingMap {
 public:
  // The target holds what it is to begin with, and nobody else writes into it up to the last draw().
  void begin(const DepthTarget& target);
  // The same where all of the target has this value, which spares looking at it.
  void begin(const DepthTarget& target, float everywhere);
  // What counts as a gain from now on; null, as after begin(): all that becomes nearer. The map must outlive
  // that, and is kept up to date with what is drawn.
  void aimAt(NeedMap* needs);
  const DepthTarget& target() const { return target_; }
  EdgeBuffer buffer() const {
    return {static_cast<std::int32_t>(target_.width), static_cast<std::int32_t>(target_.height)};
  }

  // Whether all of a rectangle of the target is nearer than this reciprocal depth.
  bool hides(const PixelRectangle& rectangle, float nearest) const {
    return squares_.allNearer(target_, rectangle, nearest);
  }
  // In how many pixels of a rectangle of the target a surface that is nowhere nearer than this reciprocal
  // depth may gain something; or more.
  std::uint32_t wanted(const PixelRectangle& rectangle, float nearest) const {
    if (needs_ != nullptr) {
      return needs_->pixels(rectangle, nearest);
    }
    return hides(rectangle, nearest) ? 0u : static_cast<std::uint32_t>(rectangle.area());
  }
  // The same for one that gets these depths. With needs it is a closer bound than that of the nearest depth,
  // without them the whole rectangle.
  std::uint32_t wanted(const PixelRectangle& rectangle, const DepthBound& depth) const {
    return needs_ != nullptr ? needs_->pixels(rectangle, depth)
                             : static_cast<std::uint32_t>(rectangle.area());
  }

  // Draws groups one after the other: covered pixels get the group's depth where that is nearer. Different
  // rows of tiles may be drawn by different threads; the result does not depend on them. edges: those that
  // the boundaries refer to, prepared for buffer(). gains: as many as groups.
  void draw(std::span<const WindingGroup> groups, std::span<const BoundaryEdge> edges,
            std::span<WindingGain> gains, const ParallelFor& parallel_for = serialFor);

 private:
  // How a group is drawn.
  struct Plan {
    TileRange tiles;
    bool in_runs = false;
    bool known = false;  // numbers are large enough for its windings
  };

  void beginMap(const DepthTarget& target);
  PixelRectangle pixelsOfPlans() const;
  Plan planOf(const WindingGroup& group, std::span<const BoundaryEdge> edges) const;
  // Draws a group into the rows of tiles from first_row to last_row, and returns what that gained.
  WindingGain drawRows(const WindingGroup& group, const Plan& plan, std::span<const BoundaryEdge> edges,
                       std::int32_t first_row, std::int32_t last_row);

  DepthTarget target_;
  NeedMap* needs_ = nullptr;
  std::int32_t columns_ = 0, rows_ = 0;  // of tiles
  std::vector<WindingTile> tiles_;       // all zero between groups
  std::vector<TileExtent> extents_;      // by row of tiles
  std::vector<TileRowRuns> runs_;        // by row of tiles
  std::uint32_t far_stride_ = 0;
  std::vector<float> far_;          // see FarDepths; all infinite between groups
  SquareDepths squares_;            // of the target
  std::vector<Plan> plans_;         // of the groups that are drawn
  std::vector<WindingGain> gains_;  // by group and first row of the tiles that a thread draws
};

}  // namespace sightline::occlusion
