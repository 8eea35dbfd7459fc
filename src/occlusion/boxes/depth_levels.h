#pragma once

// The minimum and maximum reciprocal depth of blocks of a depth buffer, level by level.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/occlusion/rasteriser.h"

namespace sightline::occlusion {

// Cells along the side of a block that becomes one cell of the next level.
inline constexpr std::uint32_t kBlock = 8, kBlockShift = 3;

// A level of the pyramid. A cell of level k is a square of 8^k x 8^k pixels, cut at the buffer's borders.
// Eight cells from any cell x <= stride - 8 of a row can be read; values beyond the width have no meaning.
struct DepthLevel {
  const float* min = nullptr;
  const float* max = nullptr;  // level 0: the same as min
  std::uint32_t width = 0, height = 0, stride = 0;
};

class DepthLevels {
 public:
  static constexpr std::uint32_t kMaxLevels = 6;

  DepthLevels() = default;
  // The levels of a copy would be those of the original.
  DepthLevels(const DepthLevels&) = delete;
  DepthLevels& operator=(const DepthLevels&) = delete;
  DepthLevels(DepthLevels&&) noexcept = default;
  DepthLevels& operator=(DepthLevels&&) noexcept = default;

  // Builds the levels of a depth buffer, which must outlive their use; it is copied only where its rows are
  // not whole groups of eight. The bits are the same with any number of threads and every instruction set.
  void build(const DepthBufferView& buffer, const ParallelFor& parallel_for = serialFor);

  // Level 0 is the buffer itself; the last level has at most eight cells along each side.
  std::span<const DepthLevel> levels() const { return {levels_, count_}; }

 private:
  void reduce(std::uint32_t level, std::uint32_t begin_row, std::uint32_t end_row);
  void useBuffer(const DepthBufferView& buffer);

  DepthLevel levels_[kMaxLevels];
  std::uint32_t count_ = 0;
  std::vector<float> copy_;  // of a buffer whose rows are not whole groups of eight
  std::vector<float> min_[kMaxLevels], max_[kMaxLevels];  // cells of the levels k >= 1
};

}  // namespace sightline::occlusion
