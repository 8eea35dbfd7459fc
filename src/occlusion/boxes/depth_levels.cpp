#include "src/occlusion/boxes/depth_levels.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/boxes/depth_levels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Makes one row of a level from up to eight rows of the level below, whose cells beyond the width are left
// out. Minima and maxima do not depend on the order of cells.
void reduceRow(const DepthLevel& below, std::uint32_t row, float* min, float* max) {
  constexpr float kMax = std::numeric_limits<float>::max();
  const hn::CappedTag<float, kBlock> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::uint32_t first = row * kBlock, rows = std::min(kBlock, below.height - first);
  for (std::uint32_t x = 0; x < below.width; x += kBlock) {
    auto low = hn::Set(d, kMax), high = hn::Set(d, -kMax);
    for (std::size_t lane = 0; lane < kBlock && x + lane < below.width; lane += lanes) {
      const std::size_t at = std::size_t{first} * below.stride + x + lane;
      auto column_low = hn::LoadU(d, below.min + at), column_high = hn::LoadU(d, below.max + at);
      for (std::uint32_t i = 1; i < rows; ++i) {
        const std::size_t next = at + std::size_t{i} * below.stride;
        column_low = hn::Min(column_low, hn::LoadU(d, below.min + next));
        column_high = hn::Max(column_high, hn::LoadU(d, below.max + next));
      }
      const auto valid = hn::FirstN(d, below.width - x - lane);
      low = hn::Min(low, hn::IfThenElse(valid, column_low, low));
      high = hn::Max(high, hn::IfThenElse(valid, column_high, high));
    }
    min[x / kBlock] = hn::GetLane(hn::MinOfLanes(d, low));
    max[x / kBlock] = hn::GetLane(hn::MaxOfLanes(d, high));
  }
}

void reduceRows(const DepthLevel& below, const DepthLevel& level, float* min, float* max,
                std::uint32_t begin_row, std::uint32_t end_row) {
  for (std::uint32_t row = begin_row; row < end_row; ++row) {
    const std::size_t at = std::size_t{row} * level.stride;
    reduceRow(below, row, min + at, max + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(reduceRows);

constexpr std::uint32_t kBandRows = 4;  // rows of level 1 that a thread makes together, at least

std::uint32_t blocksOf(std::uint32_t cells) {
  return (cells + kBlock - 1) / kBlock;
}

}  // namespace

void DepthLevels::useBuffer(const DepthBufferView& buffer) {
  const std::uint32_t whole = blocksOf(buffer.width) * kBlock;
  const bool fits =
      buffer.stride % kBlock == 0 && buffer.stride >= whole &&
      buffer.reciprocal_depth.size() >= std::size_t{buffer.stride} * (buffer.height - 1) + whole;
  const float* reciprocal_depth = buffer.reciprocal_depth.data();
  if (!fits) {
    copy_.resize(std::size_t{whole} * buffer.height);
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      std::ranges::copy(buffer.row(y), copy_.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * whole));
    }
    reciprocal_depth = copy_.data();
  }
  levels_[0] = {reciprocal_depth, reciprocal_depth, buffer.width, buffer.height,
                fits ? buffer.stride : whole};
}

void DepthLevels::build(const DepthBufferView& buffer, const ParallelFor& parallel_for) {
  count_ = 0;
  if (buffer.width == 0 || buffer.height == 0) {
    return;
  }
  useBuffer(buffer);
  count_ = 1;
  while (levels_[count_ - 1].width > kBlock || levels_[count_ - 1].height > kBlock) {
    const DepthLevel& below = levels_[count_ - 1];
    DepthLevel& level = levels_[count_];
    level.width = blocksOf(below.width);
    level.height = blocksOf(below.height);
    level.stride = blocksOf(level.width) * kBlock;
    min_[count_].resize(std::size_t{level.stride} * level.height);
    max_[count_].resize(std::size_t{level.stride} * level.height);
    level.min = min_[count_].data();
    level.max = max_[count_].data();
    if (count_ == 1) {
      // Bands of rows; small enough a capture to need no memory.
      parallel_for((level.height + kBandRows - 1) / kBandRows,
                   [this](std::uint32_t begin, std::uint32_t end) {
                     reduce(1, begin * kBandRows, std::min(end * kBandRows, levels_[1].height));
                   });
    } else {
      reduce(count_, 0, level.height);
    }
    ++count_;
  }
}

void DepthLevels::reduce(std::uint32_t level, std::uint32_t begin_row, std::uint32_t end_row) {
  HWY_DYNAMIC_DISPATCH(reduceRows)
  (levels_[level - 1], levels_[level], min_[level].data(), max_[level].data(), begin_row, end_row);
}

}  // namespace sightline::occlusion
#endif
