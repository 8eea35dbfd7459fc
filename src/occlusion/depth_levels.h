#pragma once

// The least and the greatest reciprocal depth of blocks of a depth map, level by level.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/occlusion/rasteriser.h"

namespace sightline::occlusion {

// Cells along the side of a block that becomes one cell of the next level.
inline constexpr std::uint32_t kBlock = 8, kBlockShift = 3;

// Of level k, a cell is the square of 8^k pixels, cut at the map's borders. Eight cells from any cell
// x <= stride - 8 of a row can be read; what lies beyond the width has no meaning.
struct DepthLevel {
  const float* least = nullptr;
  const float* greatest = nullptr;  // of level 0 the same
  std::uint32_t width = 0, height = 0, stride = 0;
};

class DepthLevels {
 public:
  static constexpr std::uint32_t kMaxLevels = 6;

  // The map must outlive the use of this; it is copied only where its rows are not whole groups of eight.
  // The same bits with any number of threads and on every instruction set.
  void build(const DepthMapView& map, const ParallelFor& parallel_for = serialFor);

  // [0] is the map itself; the last has at most eight cells along each side.
  std::span<const DepthLevel> levels() const { return {levels_, count_}; }

 private:
  void reduce(std::uint32_t level, std::uint32_t begin_row, std::uint32_t end_row);
  void useMap(const DepthMapView& map);

  DepthLevel levels_[kMaxLevels];
  std::uint32_t count_ = 0;
  std::vector<float> copy_;                                    // of a map of another layout
  std::vector<float> min_[kMaxLevels], greatest_[kMaxLevels];  // of level k >= 1
};

}  // namespace sightline::occlusion
