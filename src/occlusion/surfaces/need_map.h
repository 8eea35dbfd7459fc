#pragma once

// Where in a depth buffer something has to be hidden, and how near it is there.

#include <cstdint>
#include <vector>

#include "src/occlusion/surfaces/depth_target.h"
#include "src/occlusion/surfaces/square_depths.h"

namespace sightline::occlusion {

// Squares of pixels in which boxes are to be hidden. A surface that is before none of them, or only where all
// that there is of them is hidden, is of no use. All rectangles lie within the target.
class NeedMap {
 public:
  // Needs nothing.
  void clear(const DepthTarget& target);
  // A box that lies in these pixels and is nowhere nearer than this reciprocal depth is to be hidden.
  void add(const PixelRectangle& rectangle, float nearest);
  // Finds out what the target hides by now. Call this before pixels(), and after the target has come nearer:
  // then for the pixels where it has, at least.
  void look(const SquareDepths& target);
  void look(const SquareDepths& target, const PixelRectangle& where);

  // An upper bound, but for rounding, of the pixels of a rectangle in which a surface with these depths may
  // hide something of a box.
  std::uint32_t pixels(const PixelRectangle& rectangle, const DepthBound& depth) const;
  // The same for one that is nowhere nearer than this reciprocal depth.
  std::uint32_t pixels(const PixelRectangle& rectangle, float nearest) const {
    return pixels(rectangle, DepthBound{.at_origin = nearest, .floor = nearest});
  }

  // A value for each square of a row, and one more: reciprocal depths of the farthest and of the nearest box
  // there. A surface is of use where it is before the farthest, and what is there already is not before the
  // nearest.
  const float* farthestOf(std::int32_t row) const { return farthest_.data() + at(row); }
  const float* nearestOf(std::int32_t row) const { return nearest_.data() + at(row); }

 private:
  std::size_t at(std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(stride_);
  }

  std::int32_t columns_ = 0, rows_ = 0;
  std::int32_t stride_ = 0;  // columns_, and room for a vector
  std::vector<float> farthest_, nearest_;
  // A surface is of use in a square only where it is nearer than this: than the farthest box and the
  // farthest pixel there. Infinite where the farthest pixel hides even the nearest box.
  std::vector<float> open_;
};

}  // namespace sightline::occlusion
