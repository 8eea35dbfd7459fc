#include "src/occlusion/surfaces/far_depths.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/far_depths.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A lane for each block.
using Blocks = hn::CappedTag<float, FarDepths::kSpare>;
inline constexpr Blocks kBlocks;

constexpr std::int32_t kWidth = FarDepths::kWidth, kHeight = FarDepths::kHeight;

HWY_INLINE float* rowOf(const FarDepths& depths, std::int32_t y) {
  return depths.least + std::size_t{depths.stride} * static_cast<std::uint32_t>(y);
}

HWY_INLINE void lowerTo(const FarDepths& depths, const PixelRectangle& r, const DepthBound& depth) {
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(kBlocks));
  const std::int32_t first = r.x0 / kWidth, end = (r.x1 - 1) / kWidth + 1;
  // The pixel of a block in which the plane is farthest.
  const float top = depth.along_y < 0.0f ? kHeight - 1 : 0.0f,
              right = depth.along_x < 0.0f ? kWidth - 1 : 0.0f;
  const float at_left = depth.along_x * right + depth.at_origin;
  const auto along = hn::Set(kBlocks, depth.along_x * kWidth), floor = hn::Set(kBlocks, depth.floor);
  for (std::int32_t y = r.y0 / kHeight; y <= (r.y1 - 1) / kHeight; ++y) {
    const auto at_row = hn::Set(kBlocks, depth.along_y * (static_cast<float>(y * kHeight) + top) + at_left);
    float* row = rowOf(depths, y);
    for (std::int32_t x = first; x < end; x += lanes) {
      const auto blocks = hn::FirstN(kBlocks, static_cast<std::size_t>(end - x));
      const auto plane = hn::Add(hn::Mul(hn::Iota(kBlocks, static_cast<float>(x)), along), at_row);
      const auto old = hn::LoadU(kBlocks, row + x), lowered = hn::Min(old, hn::Max(plane, floor));
      hn::StoreU(hn::IfThenElse(blocks, lowered, old), kBlocks, row + x);
    }
  }
}

void lowerAll(const FarDepths& depths, const TileRange& range, std::span<const PartDepth> parts) {
  const PixelRectangle all{range.first_column * kTileWidth, range.first_row * kTileHeight,
                           (range.last_column + 1) * kTileWidth, (range.last_row + 1) * kTileHeight};
  for (const PartDepth& part : parts) {
    const PixelRectangle r{std::max(part.rectangle.x0, all.x0), std::max(part.rectangle.y0, all.y0),
                           std::min(part.rectangle.x1, all.x1), std::min(part.rectangle.y1, all.y1)};
    if (!r.empty()) {
      lowerTo(depths, r, part.depth);
    }
  }
}

void clearAll(const FarDepths& depths, const TileRange& range) {
  const std::int32_t end = (range.last_column + 1) * FarDepths::kAcross;
  for (std::int32_t y = range.first_row * FarDepths::kUp; y < (range.last_row + 1) * FarDepths::kUp; ++y) {
    float* row = rowOf(depths, y);
    for (std::int32_t x = range.first_column * FarDepths::kAcross; x < end;
         x += static_cast<std::int32_t>(hn::Lanes(kBlocks))) {
      hn::StoreU(hn::Set(kBlocks, std::numeric_limits<float>::infinity()), kBlocks, row + x);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(lowerAll);
HWY_EXPORT(clearAll);
}  // namespace

void lowerFarDepths(const FarDepths& depths, const TileRange& range, std::span<const PartDepth> parts) {
  HWY_DYNAMIC_DISPATCH(lowerAll)(depths, range, parts);
}

void clearFarDepths(const FarDepths& depths, const TileRange& range) {
  HWY_DYNAMIC_DISPATCH(clearAll)(depths, range);
}

}  // namespace sightline::occlusion
#endif
