#pragma once

// Draws surfaces into a depth buffer by the winding of their boundaries. See docs/conservative.md,
// "Surfaces".

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "src/occlusion/boundary_edge.h"
#include "src/occlusion/boundary_runs.h"
#include "src/occlusion/winding_resolve.h"
#include "src/occlusion/winding_tiles.h"

namespace sightline::occlusion {

// What is drawn into; greater values are nearer.
struct DepthTarget {
  float* reciprocal_depth = nullptr;
  std::uint32_t width = 0, height = 0, stride = 0;  // stride: a multiple of 8, 8 or more above the width
};

struct PixelRectangle {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // first pixel, and the one after the last
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int32_t area() const { return (x1 - x0) * (y1 - y0); }
};

// Some of a group that is no farther away than `depth` may appear in these pixels.
struct PartDepth {
  PixelRectangle rectangle;
  DepthBound depth;
};

// Surfaces that are drawn together: all of their boundary, and how far away they are.
struct WindingGroup {
  PixelRectangle rectangle;  // nothing is drawn outside of the tiles that have a part of it
  std::span<const BoundaryChain> boundary{};
  std::span<const PartDepth> depths{};  // of all of the group; parts may overlap
  bool flat = false;                    // all of it has the depth of the first of them, everywhere
};

class WindingMap {
 public:
  void resize(const DepthTarget& target);
  EdgeBuffer buffer() const {
    return {static_cast<std::int32_t>(target_.width), static_cast<std::int32_t>(target_.height)};
  }

  // Whether all of a rectangle of the target is nearer than this reciprocal depth.
  bool hides(const PixelRectangle& rectangle, float nearest);

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

  Plan planOf(const WindingGroup& group, std::span<const BoundaryEdge> edges) const;
  // The rows of tiles from first_row to last_row of a group. gains: by row of tiles.
  void drawRows(const WindingGroup& group, const Plan& plan, std::span<const BoundaryEdge> edges,
                std::int32_t first_row, std::int32_t last_row, WindingGain* gains);
  void addDepths(const WindingGroup& group, const TileRange& tiles);
  WindingGain resolve(const WindingGroup& group, const Plan& plan, std::int32_t row);

  DepthTarget target_;
  std::int32_t columns_ = 0, rows_ = 0;  // of tiles
  std::vector<WindingTile> tiles_;       // all zero between groups
  std::vector<TileExtent> extents_;      // by row of tiles
  std::vector<TileRowRuns> runs_;        // by row of tiles
  std::uint32_t far_stride_ = 0;
  std::vector<float> far_;    // by block: the least reciprocal depth of the group; infinite between groups
  std::vector<float> least_;  // by tile: of the target's values, or less
  std::unique_ptr<bool[]> stale_;   // by tile: it may be less
  std::vector<Plan> plans_;         // of the groups that are drawn
  std::vector<WindingGain> gains_;  // by group and row of tiles
};

}  // namespace sightline::occlusion
