#include "src/occlusion/winding_map.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/winding_map.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t kWide = kTileWidth, kHigh = kTileHeight;
constexpr std::int32_t kLanes = 8;  // most lanes of a vector of pixels

// The least value of a rectangle of the target's pixels.
float leastOf(const DepthTarget& target, const PixelRectangle& r) {
  const hn::CappedTag<float, kLanes> d;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  auto least = hn::Set(d, std::numeric_limits<float>::infinity());
  for (std::int32_t y = r.y0; y < r.y1; ++y) {
    const float* row = target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(y);
    for (std::int32_t x = r.x0; x < r.x1; x += lanes) {
      const auto valid = hn::FirstN(d, static_cast<std::size_t>(std::min(r.x1 - x, lanes)));
      least = hn::Min(least, hn::IfThenElse(valid, hn::LoadU(d, row + x), least));
    }
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

// Whether all pixels of a rectangle have a greater value than this. leasts, stale: by tile, stride for each
// row of them.
bool allNearer(const DepthTarget& target, float* leasts, bool* stale, std::int32_t stride,
               const PixelRectangle& r, float than) {
  const auto width = static_cast<std::int32_t>(target.width),
             height = static_cast<std::int32_t>(target.height);
  for (std::int32_t tile_y = r.y0 / kHigh; tile_y * kHigh < r.y1; ++tile_y) {
    for (std::int32_t tile_x = r.x0 / kWide; tile_x * kWide < r.x1; ++tile_x) {
      const std::ptrdiff_t tile = std::ptrdiff_t{stride} * tile_y + tile_x;
      if (leasts[tile] > than) {
        continue;
      }
      const PixelRectangle whole{tile_x * kWide, tile_y * kHigh, std::min(tile_x * kWide + kWide, width),
                                 std::min(tile_y * kHigh + kHigh, height)};
      if (stale[tile]) {
        stale[tile] = false;
        leasts[tile] = leastOf(target, whole);
        if (leasts[tile] > than) {
          continue;
        }
      }
      const PixelRectangle part{std::max(whole.x0, r.x0), std::max(whole.y0, r.y0), std::min(whole.x1, r.x1),
                                std::min(whole.y1, r.y1)};
      if (part.area() == whole.area() || !(leastOf(target, part) > than)) {
        return false;
      }
    }
  }
  return true;
}

// Tiles from `first` up to `end` are no nearer than max(along * tile + at_row, floor).
void lowerTiles(float* far, std::int32_t first, std::int32_t end, float along, float at_row, float floor) {
  const hn::CappedTag<float, kLanes> d;
  std::int32_t tile = first;
  const auto lower = [&](auto tag) HWY_ATTR {
    const auto x = hn::Add(hn::Set(tag, static_cast<float>(tile)), hn::Iota(tag, 0.0f));
    const auto plane = hn::Add(hn::Mul(x, hn::Set(tag, along)), hn::Set(tag, at_row));
    hn::StoreU(hn::Min(hn::LoadU(tag, far + tile), hn::Max(plane, hn::Set(tag, floor))), tag, far + tile);
  };
  for (; tile + static_cast<std::int32_t>(hn::Lanes(d)) <= end;
       tile += static_cast<std::int32_t>(hn::Lanes(d))) {
    lower(d);
  }
  for (; tile < end; ++tile) {
    lower(hn::CappedTag<float, 1>());
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(allNearer);
HWY_EXPORT(lowerTiles);

constexpr std::uint64_t kLargestSum = 16000;  // of edges' values in a group: WindingTile::carry is a word
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::int32_t kBlocksAcross = kTileWidth / FarDepths::kWidth,
                       kBlocksUp = kTileHeight / FarDepths::kHeight;

}  // namespace

void WindingMap::resize(const DepthTarget& target) {
  target_ = target;
  const auto wholes = [](std::uint32_t pixels, std::int32_t size) {
    return (static_cast<std::int32_t>(pixels) + size - 1) / size;
  };
  const std::int32_t columns = wholes(target.width, kTileWidth), rows = wholes(target.height, kTileHeight);
  const std::size_t tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (columns != columns_ || rows != rows_) {
    columns_ = columns;
    rows_ = rows;
    tiles_.assign(tiles, {});
    stale_ = std::make_unique<bool[]>(tiles);
    extents_.assign(static_cast<std::size_t>(rows), {});
    runs_.assign(static_cast<std::size_t>(rows), {});
    far_stride_ = static_cast<std::uint32_t>(columns * kBlocksAcross);
    far_.assign(tiles * kBlocksAcross * kBlocksUp, kInfinity);
  }
  least_.assign(tiles, -kInfinity);
  std::fill_n(stale_.get(), tiles, true);
}

bool WindingMap::hides(const PixelRectangle& rectangle, float nearest) {
  return HWY_DYNAMIC_DISPATCH(allNearer)(target_, least_.data(), stale_.get(), columns_, rectangle, nearest);
}

WindingMap::Plan WindingMap::planOf(const WindingGroup& group, std::span<const BoundaryEdge> edges) const {
  const PixelRectangle& r = group.rectangle;
  Plan plan;
  plan.tiles = {r.x0 / kTileWidth, std::min((r.x1 - 1) / kTileWidth, columns_ - 1), r.y0 / kTileHeight,
                std::min((r.y1 - 1) / kTileHeight, rows_ - 1)};
  plan.in_runs = hasRuns(edges, group.boundary);
  std::uint64_t sum = 0;
  for (const BoundaryChain& chain : group.boundary) {
    sum += std::uint64_t{chain.count} * static_cast<std::uint32_t>(std::abs(chain.value));
  }
  plan.known = plan.in_runs || sum <= kLargestSum;
  return plan;
}

void WindingMap::draw(std::span<const WindingGroup> groups, std::span<const BoundaryEdge> edges,
                      std::span<WindingGain> gains, const ParallelFor& parallel_for) {
  const auto rows = static_cast<std::size_t>(rows_);
  plans_.clear();
  for (const WindingGroup& group : groups) {
    plans_.push_back(planOf(group, edges));
  }
  gains_.assign(groups.size() * rows, {});
  const auto drawBand = [&](std::uint32_t begin, std::uint32_t end) {
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const TileRange& tiles = plans_[i].tiles;
      drawRows(groups[i], plans_[i], edges, std::max(tiles.first_row, static_cast<std::int32_t>(begin)),
               std::min(tiles.last_row, static_cast<std::int32_t>(end) - 1), gains_.data() + rows * i);
    }
  };
  // ParallelFor's function captures one reference only: larger captures would be allocated on the heap.
  parallel_for(static_cast<std::uint32_t>(rows_),
               [&drawBand](std::uint32_t begin, std::uint32_t end) { drawBand(begin, end); });
  for (std::size_t i = 0; i < groups.size(); ++i) {
    gains[i] = {};
    for (std::size_t row = 0; row < rows; ++row) {
      gains[i].nearer += gains_[rows * i + row].nearer;
      gains[i].tiles += gains_[rows * i + row].tiles;
    }
  }
}

void WindingMap::drawRows(const WindingGroup& group, const Plan& plan, std::span<const BoundaryEdge> edges,
                          std::int32_t first_row, std::int32_t last_row, WindingGain* gains) {
  TileRange tiles = plan.tiles;
  tiles.first_row = first_row;
  tiles.last_row = last_row;
  if (!plan.known || first_row > last_row || tiles.first_column > tiles.last_column) {
    return;
  }
  const double end_x = static_cast<double>(target_.width) * kGridStep;
  if (plan.in_runs) {
    drawRuns({runs_.data(), first_row, last_row, end_x}, edges, group.boundary);
  } else {
    drawTiles({tiles_.data(), extents_.data(), columns_, end_x}, tiles, edges, group.boundary);
  }
  if (!group.flat) {
    addDepths(group, tiles);
  }
  for (std::int32_t row = first_row; row <= last_row; ++row) {
    gains[row] = resolve(group, plan, row);
  }
}

void WindingMap::addDepths(const WindingGroup& group, const TileRange& tiles) {
  constexpr std::int32_t kWidth = FarDepths::kWidth, kHeight = FarDepths::kHeight;
  for (const PartDepth& part : group.depths) {
    const PixelRectangle r{std::max(part.rectangle.x0, tiles.first_column * kTileWidth),
                           std::max(part.rectangle.y0, tiles.first_row * kTileHeight),
                           std::min(part.rectangle.x1, (tiles.last_column + 1) * kTileWidth),
                           std::min(part.rectangle.y1, (tiles.last_row + 1) * kTileHeight)};
    if (r.empty()) {
      continue;
    }
    const DepthBound& depth = part.depth;
    const std::int32_t first = r.x0 / kWidth, end = (r.x1 - 1) / kWidth + 1;
    const float top = depth.along_y < 0.0f ? kHeight - 1 : 0.0f,
                right = depth.along_x < 0.0f ? kWidth - 1 : 0.0f;
    for (std::int32_t y = r.y0 / kHeight; y <= (r.y1 - 1) / kHeight; ++y) {
      const float at_row =
          depth.along_y * (static_cast<float>(y * kHeight) + top) + (depth.along_x * right + depth.at_origin);
      HWY_DYNAMIC_DISPATCH(lowerTiles)
      (far_.data() + std::size_t{far_stride_} * static_cast<std::uint32_t>(y), first, end,
       depth.along_x * kWidth, at_row, depth.floor);
    }
  }
}

// Gives the group's depth to what it covers of a row of tiles, and clears what was drawn there.
WindingGain WindingMap::resolve(const WindingGroup& group, const Plan& plan, std::int32_t row) {
  const auto at = static_cast<std::size_t>(row);
  const std::size_t first_tile = static_cast<std::size_t>(columns_) * at;
  const std::int32_t y = row * kTileHeight;
  const TileExtent extent = plan.in_runs ? TileExtent{} : extents_[at];
  WindingGain gain;
  if (plan.in_runs || extent.first <= extent.last) {
    const CoveredRow covered{.runs = plan.in_runs ? &runs_[at] : nullptr,
                             .tiles = tiles_.data() + first_tile,
                             .stale = stale_.get() + first_tile,
                             .extent = extent,
                             .first = plan.tiles.first_column,
                             .end = plan.tiles.last_column + 1,
                             .reciprocal_depth = target_.reciprocal_depth +
                                                 std::size_t{target_.stride} * static_cast<std::uint32_t>(y),
                             .stride = target_.stride,
                             .width = (static_cast<std::int32_t>(target_.width) + 7) & ~7,
                             .rows = std::min(kTileHeight, static_cast<std::int32_t>(target_.height) - y)};
    const FarDepths depths{
        far_.data() + std::size_t{far_stride_} * static_cast<std::uint32_t>(row * kBlocksUp), far_stride_};
    gain = group.flat ? resolvePlane(covered, group.depths[0].depth, y) : resolveFar(covered, depths);
  }
  for (std::int32_t block = row * kBlocksUp; !group.flat && block < (row + 1) * kBlocksUp; ++block) {
    const auto far_row = far_.begin() + static_cast<std::ptrdiff_t>(far_stride_) * block;
    std::fill(far_row + plan.tiles.first_column * kBlocksAcross,
              far_row + (plan.tiles.last_column + 1) * kBlocksAcross, kInfinity);
  }
  return gain;
}

}  // namespace sightline::occlusion
#endif
