#pragma once

// How far away the farthest pixels of a depth buffer are, square by square.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/occlusion/surfaces/depth_target.h"

namespace sightline::occlusion {

// The least reciprocal depths in squares of pixels.
class SquareDepths {
 public:
  static constexpr std::int32_t kSize = 8;     // pixels along each side of a square
  static constexpr std::int32_t kVector = 16;  // squares that are looked at together, at most

  // Looks at all of a target.
  void look(const DepthTarget& target);
  // The same of a target of which all pixels have this value.
  void fill(const DepthTarget& target, float value);
  // Whether all of a rectangle is nearer than this reciprocal depth. It lies within the target, which is the
  // one that was looked at last.
  bool allNearer(const DepthTarget& target, const PixelRectangle& rectangle, float than) const;

  // A value for each square of a row. Whoever draws into the target has to change them.
  float* ofRow(std::int32_t row) { return least_.data() + at(row); }
  const float* ofRow(std::int32_t row) const { return least_.data() + at(row); }

 private:
  std::size_t at(std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(stride_);
  }

  std::int32_t stride_ = 0;  // squares of a row, and room for a vector
  std::vector<float> least_;
};

// Squares of this size, whole or in part, along so many pixels.
inline std::int32_t squaresIn(std::uint32_t pixels) {
  return (static_cast<std::int32_t>(pixels) + SquareDepths::kSize - 1) / SquareDepths::kSize;
}

}  // namespace sightline::occlusion
