#include "src/occlusion/surfaces/winding_map.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace sightline::occlusion {
namespace {

constexpr std::uint64_t kLargestSum = 1u << 30;  // of edges' values in a group: see WindingTile::carry
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void WindingMap::begin(const DepthTarget& target) {
  beginMap(target);
  squares_.look(target);
}

void WindingMap::begin(const DepthTarget& target, float everywhere) {
  beginMap(target);
  squares_.fill(target, everywhere);
}

void WindingMap::aimAt(NeedMap* needs) {
  needs_ = needs;
  if (needs_ != nullptr) {
    needs_->look(squares_);
  }
}

void WindingMap::beginMap(const DepthTarget& target) {
  target_ = target;
  needs_ = nullptr;
  const auto wholes = [](std::uint32_t pixels, std::int32_t size) {
    return (static_cast<std::int32_t>(pixels) + size - 1) / size;
  };
  const std::int32_t columns = wholes(target.width, kTileWidth), rows = wholes(target.height, kTileHeight);
  if (columns != columns_ || rows != rows_) {
    columns_ = columns;
    rows_ = rows;
    tiles_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), {});
    extents_.assign(static_cast<std::size_t>(rows), {});
    runs_.assign(static_cast<std::size_t>(rows), {});
    far_stride_ = static_cast<std::uint32_t>(columns * FarDepths::kAcross + FarDepths::kSpare);
    far_.assign(std::size_t{far_stride_} * static_cast<std::uint32_t>(rows * FarDepths::kUp), kInfinity);
  }
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

// All pixels that may have been drawn.
PixelRectangle WindingMap::pixelsOfPlans() const {
  PixelRectangle all{buffer().width, buffer().height, 0, 0};
  for (const Plan& plan : plans_) {
    const TileRange& tiles = plan.tiles;
    all = {std::min(all.x0, tiles.first_column * kTileWidth), std::min(all.y0, tiles.first_row * kTileHeight),
           std::max(all.x1, (tiles.last_column + 1) * kTileWidth),
           std::max(all.y1, (tiles.last_row + 1) * kTileHeight)};
  }
  return {all.x0, all.y0, std::min(all.x1, buffer().width), std::min(all.y1, buffer().height)};
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
    needs_->look(squares_, pixelsOfPlans());
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
                         .squares = &squares_,
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
