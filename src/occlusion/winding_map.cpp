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

// A lane for each pixel. Vectors begin at multiples of their length, so that they end within the stride.
using Pixels = hn::CappedTag<float, 16>;
inline constexpr Pixels kPixels;

// The least value of a rectangle of the target's pixels.
float leastOf(const DepthTarget& target, const PixelRectangle& r) {
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(kPixels));
  const auto infinite = hn::Set(kPixels, std::numeric_limits<float>::infinity());
  auto least = infinite;
  for (std::int32_t x = r.x0 / lanes * lanes; x < r.x1; x += lanes) {
    const float* pixels = target.reciprocal_depth + x;
    auto column = infinite;
    for (std::int32_t y = r.y0; y < r.y1; ++y) {
      column = hn::Min(
          column, hn::LoadU(kPixels, pixels + std::size_t{target.stride} * static_cast<std::uint32_t>(y)));
    }
    const auto before = hn::FirstN(kPixels, static_cast<std::size_t>(std::max(r.x0 - x, 0))),
               to = hn::FirstN(kPixels, static_cast<std::size_t>(std::min(r.x1 - x, lanes)));
    least = hn::IfThenElse(hn::AndNot(before, to), hn::Min(least, column), least);
  }
  return hn::GetLane(hn::MinOfLanes(kPixels, least));
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

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(allNearer);

constexpr std::uint64_t kLargestSum = 1u << 30;  // of edges' values in a group: see WindingTile::carry
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void WindingMap::begin(const DepthTarget& target, NeedMap* needs) {
  target_ = target;
  needs_ = needs;
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
    far_stride_ = static_cast<std::uint32_t>(columns * FarDepths::kAcross + FarDepths::kSpare);
    far_.assign(std::size_t{far_stride_} * static_cast<std::uint32_t>(rows * FarDepths::kUp), kInfinity);
  }
  least_.assign(tiles, -kInfinity);
  std::fill_n(stale_.get(), tiles, needs_ == nullptr);
  if (needs_ != nullptr) {
    needs_->look(target_, {0, 0, buffer().width, buffer().height});
  }
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
    for (std::size_t i = 0; begin < end && i < groups.size(); ++i) {
      const TileRange& tiles = plans_[i].tiles;
      gains_[rows * i + begin] =
          drawRows(groups[i], plans_[i], edges, std::max(tiles.first_row, static_cast<std::int32_t>(begin)),
                   std::min(tiles.last_row, static_cast<std::int32_t>(end) - 1));
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
  if (needs_ != nullptr) {
    lookAgain();
  }
}

// Looks at the tiles that have changed, run by run.
void WindingMap::lookAgain() {
  for (std::int32_t y = 0; y < rows_; ++y) {
    bool* changed = stale_.get() + static_cast<std::ptrdiff_t>(columns_) * y;
    for (bool *first = changed, *end = changed + columns_; first != end;) {
      first = std::find(first, end, true);
      bool* after = std::find(first, end, false);
      if (first != after) {
        std::fill(first, after, false);
        const auto x0 = static_cast<std::int32_t>(first - changed),
                   x1 = static_cast<std::int32_t>(after - changed);
        needs_->look(target_, {x0 * kTileWidth, y * kTileHeight, std::min(x1 * kTileWidth, buffer().width),
                               std::min((y + 1) * kTileHeight, buffer().height)});
      }
      first = after;
    }
  }
}

WindingGain WindingMap::drawRows(const WindingGroup& group, const Plan& plan,
                                 std::span<const BoundaryEdge> edges, std::int32_t first_row,
                                 std::int32_t last_row) {
  TileRange tiles = plan.tiles;
  tiles.first_row = first_row;
  tiles.last_row = last_row;
  if (!plan.known || first_row > last_row || tiles.first_column > tiles.last_column) {
    return {};
  }
  if (plan.in_runs) {
    drawRuns({runs_.data(), tiles, buffer()}, edges, group.boundary);
  } else {
    drawTiles({tiles_.data(), extents_.data(), columns_, buffer()}, tiles, edges, group.boundary);
  }
  const GroupCover cover{.runs = plan.in_runs ? runs_.data() : nullptr,
                         .tiles = tiles_.data(),
                         .extents = extents_.data(),
                         .stale = stale_.get(),
                         .columns = columns_,
                         .range = tiles,
                         .target = target_,
                         .needs = needs_};
  if (group.flat) {
    return resolvePlane(cover, group.depths[0].depth);
  }
  const FarDepths depths{far_.data(), far_stride_};
  lowerFarDepths(depths, tiles, group.depths);
  const WindingGain gain = resolveFar(cover, depths);
  clearFarDepths(depths, tiles);
  return gain;
}

}  // namespace sightline::occlusion
#endif
