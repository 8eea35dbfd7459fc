#pragma once

// Where in a depth buffer something has to be hidden, and how near it is there.

#include <cstdint>
#include <vector>

#include "src/occlusion/depth_target.h"

namespace sightline::occlusion {

// In squares of pixels, for boxes that are to be hidden. What is drawn before none of them is of no use.
class NeedMap {
 public:
  static constexpr std::int32_t kSize = 8;  // pixels along each side of a square

  // Needs nothing.
  void clear(const DepthTarget& target);
  // A box that lies in these pixels and is nowhere nearer than this reciprocal depth is to be hidden.
  void add(const PixelRectangle& rectangle, float nearest);

  // Whether a surface in this rectangle, nowhere nearer than this reciprocal depth, may hide something of a
  // box in a pixel of the target where that is not hidden yet.
  bool needs(const DepthTarget& target, const PixelRectangle& rectangle, float nearest) const;

  // A value for each square of a row: of the farthest box there, and of the nearest one. A surface is of use
  // where it is before the farthest and what is there already is not before the nearest. One more is there.
  const float* farthestOf(std::int32_t row) const { return farthest_.data() + at(row); }
  const float* nearestOf(std::int32_t row) const { return nearest_.data() + at(row); }

 private:
  std::size_t at(std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(stride_);
  }

  std::int32_t stride_ = 0;
  std::vector<float> farthest_, nearest_;  // least and greatest reciprocal depth
};

}  // namespace sightline::occlusion
