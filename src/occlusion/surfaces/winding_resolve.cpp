#include "src/occlusion/surfaces/winding_resolve.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/winding_resolve.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/surfaces/edge_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

constexpr std::int32_t kWide = kTileWidth, kHigh = kTileHeight, kSquare = SquareDepths::kSize;
static_assert(kHigh == kSquare && kWide % kSquare == 0);
constexpr float kGain = 1.125f;  // a pixel counts as changed if it becomes nearer by this factor
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A lane for each pixel of a row of a tile, or of a part of it.
using Pixels = hn::CappedTag<float, 16>;
using PixelsV = hn::Vec<Pixels>;
inline constexpr Pixels kPixels;
static_assert(hn::MaxLanes(kPixels) <= 2 * kSquare);

// In each lane the value of the square that the pixel is in. squares: the square of the first pixel, and the
// next one.
HWY_INLINE PixelsV ofSquares(const float* squares) {
  auto values = hn::Set(kPixels, squares[0]);
  if (hn::Lanes(kPixels) > kSquare) {
    values = hn::IfThenElse(hn::FirstN(kPixels, kSquare), values, hn::Set(kPixels, squares[1]));
  }
  return values;
}

// Pixels of the target in a row of tiles.
struct PixelRows {
  HWY_INLINE PixelRows(const DepthTarget& target, std::int32_t tile_row)
      : reciprocal_depth(target.reciprocal_depth +
                         std::size_t{target.stride} * static_cast<std::uint32_t>(tile_row * kHigh)),
        stride(target.stride),
        width(drawnWidth(static_cast<std::int32_t>(target.width))),
        valid(static_cast<std::int32_t>(target.width)),
        rows(std::min(kHigh, static_cast<std::int32_t>(target.height) - tile_row * kHigh)) {}

  float* reciprocal_depth;  // of the first pixel of the lowest row
  std::uint32_t stride;
  std::int32_t width, valid, rows;  // valid: those of a row that have a meaning
};

// The depths of a plane in a row of tiles.
class PlaneDepths {
 public:
  static constexpr std::int32_t kRows = kHigh;  // for which ofColumn() holds

  HWY_INLINE PlaneDepths(const DepthBound& depth, std::int32_t tile_row) : depth_(depth) {
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
      const auto y = hn::Iota(kPlaces, static_cast<float>(tile_row * kHigh + lane));
      hn::Store(hn::Add(hn::Mul(hn::Set(kPlaces, depth.along_y), y), hn::Set(kPlaces, depth.at_origin)),
                kPlaces, at_rows_ + lane);
    }
  }
  // What ofRow() takes for the pixels from x on, in row y of the tiles and those above it.
  HWY_INLINE PixelsV ofColumn(std::int32_t x, std::int32_t) const {
    return hn::Mul(hn::Iota(kPixels, static_cast<float>(x)), hn::Set(kPixels, depth_.along_x));
  }
  // The nearest of each column of pixels from x on.
  HWY_INLINE PixelsV nearest(std::int32_t x) const {
    const auto column = ofColumn(x, 0);
    return hn::Max(ofRow(column, 0), ofRow(column, kHigh - 1));
  }
  // Their depths in row y.
  HWY_INLINE PixelsV ofRow(PixelsV column, std::int32_t y) const {
    return hn::Max(hn::Add(column, hn::Set(kPixels, at_rows_[y])), hn::Set(kPixels, depth_.floor));
  }

 private:
  DepthBound depth_;
  HWY_ALIGN float at_rows_[kHigh];
};

// The depths of blocks in a row of tiles.
class BlockDepths {
 public:
  static constexpr std::int32_t kRows = FarDepths::kHeight;

  HWY_INLINE BlockDepths(const FarDepths& depths, std::int32_t tile_row)
      : least_(depths.least +
               std::size_t{depths.stride} * static_cast<std::uint32_t>(tile_row * FarDepths::kUp)),
        stride_(depths.stride) {}

  HWY_INLINE PixelsV ofColumn(std::int32_t x, std::int32_t y) const {
    const float* block =
        least_ + stride_ * static_cast<std::uint32_t>(y / FarDepths::kHeight) + x / FarDepths::kWidth;
    auto depth = hn::Set(kPixels, block[0]);
    static_assert(hn::MaxLanes(kPixels) <= 2 * FarDepths::kWidth);
    if constexpr (hn::MaxLanes(kPixels) > FarDepths::kWidth) {
      depth = hn::IfThenElse(hn::FirstN(kPixels, FarDepths::kWidth), depth, hn::Set(kPixels, block[1]));
    }
    // Where none of the group is, it is behind everything.
    const auto most = hn::Set(kPixels, std::numeric_limits<float>::max());
    return hn::IfThenElse(hn::Le(depth, most), depth, hn::Neg(most));
  }
  HWY_INLINE PixelsV nearest(std::int32_t x) const {
    static_assert(FarDepths::kUp == 2);
    return hn::Max(ofColumn(x, 0), ofColumn(x, kRows));
  }
  HWY_INLINE PixelsV ofRow(PixelsV column, std::int32_t) const { return column; }

 private:
  const float* least_;
  std::uint32_t stride_;
};

// Which changes of the pixels in a row of tiles are gains.
class Gains {
 public:
  HWY_INLINE Gains(const NeedMap* needs, std::int32_t tile_row) {
    if (needs != nullptr) {
      farthest_ = needs->farthestOf(tile_row);
      nearest_ = needs->nearestOf(tile_row);
    }
  }
  // What the depths of the pixels from x on must be before, and the largest old ones that count.
  HWY_INLINE PixelsV farthest(std::int32_t x) const {
    return farthest_ != nullptr ? ofSquares(farthest_ + x / kSquare) : hn::Set(kPixels, -kInfinite);
  }
  HWY_INLINE PixelsV nearest(std::int32_t x) const {
    return nearest_ != nullptr ? ofSquares(nearest_ + x / kSquare) : hn::Set(kPixels, kInfinite);
  }

 private:
  const float *farthest_ = nullptr, *nearest_ = nullptr;
};

// Sets the values of one or two squares to the least ones of their lanes.
HWY_INLINE void setSquares(PixelsV lanes, float* squares) {
  if (hn::Lanes(kPixels) > kSquare) {
    const auto first = hn::FirstN(kPixels, kSquare);
    const auto infinite = hn::Set(kPixels, kInfinite);
    squares[1] = hn::GetLane(hn::MinOfLanes(kPixels, hn::IfThenElse(first, infinite, lanes)));
    lanes = hn::IfThenElse(first, lanes, infinite);
  }
  squares[0] = hn::GetLane(hn::MinOfLanes(kPixels, lanes));
}

// Sets the pixels of a vector of columns, from x on, that have bits in covered[] to a depth where that is
// nearer. Adds to each lane of `gained` how many become nearer by kGain, and gain by that. Returns the least
// depths that there are by now. Pixels without a meaning are neither counted nor returned.
template <typename Depths, typename Counts>
HWY_INLINE PixelsV gainColumns(const PixelRows& pixels, std::int32_t x, const std::uint32_t* covered,
                               const Depths& depths, const Gains& gain, Counts& gained) {
  const hn::RebindToUnsigned<Pixels> bits;
  const hn::RebindToSigned<Pixels> numbers;
  const auto first_bit = static_cast<std::uint32_t>(x % kWide);
  const auto lane_bits = hn::Shl(hn::Set(bits, 1u), hn::Add(hn::Iota(bits, 0u), hn::Set(bits, first_bit)));
  const auto valid = hn::FirstN(kPixels, static_cast<std::size_t>(std::max(pixels.valid - x, 0)));
  const auto farthest = gain.farthest(x), nearest = gain.nearest(x);
  auto least = hn::Set(kPixels, kInfinite);
  float* out = pixels.reciprocal_depth + x;
  for (std::int32_t y = 0; y < pixels.rows;) {
    const auto column = depths.ofColumn(x, y);
    for (const std::int32_t end = std::min(pixels.rows, y + Depths::kRows); y < end;
         ++y, out += pixels.stride) {
      const auto mask = hn::RebindMask(kPixels, hn::TestBit(hn::Set(bits, covered[y]), lane_bits));
      const auto old = hn::LoadU(kPixels, out), depth = depths.ofRow(column, y);
      const auto nearer = hn::And(mask, hn::Gt(depth, old));
      const auto now = hn::IfThenElse(nearer, depth, old);
      hn::StoreU(now, kPixels, out);
      least = hn::Min(least, now);
      const auto needed = hn::And(hn::Gt(depth, hn::Max(farthest, hn::Mul(old, hn::Set(kPixels, kGain)))),
                                  hn::Lt(old, nearest));
      const auto counted = hn::And(hn::And(nearer, valid), needed);
      gained = hn::Sub(gained, hn::VecFromMask(numbers, hn::RebindMask(numbers, counted)));
    }
  }
  return hn::IfThenElse(valid, least, hn::Set(kPixels, kInfinite));
}

// Sets the pixels of a tile that have bits in covered[] to a depth where that is nearer. Squares are passed
// over that are nearer already than any of these depths. squares: the farthest pixels of those of the tile.
// Returns how many pixels gain.
template <typename Depths>
HWY_INLINE std::uint32_t gainTile(const PixelRows& pixels, std::int32_t tile, const std::uint32_t* covered,
                                  const Depths& depths, const Gains& gain, float* squares) {
  const hn::RebindToSigned<Pixels> numbers;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(kPixels)), step = std::max(lanes, kSquare);
  const std::uint32_t all_of_step = ~0u >> (kWide - step);
  const std::int32_t width = std::min(pixels.width - tile * kWide, kWide);
  std::uint32_t columns = 0;  // that have covered pixels
  for (std::int32_t y = 0; y < kHigh; ++y) {
    columns |= covered[y];
  }
  auto gained = hn::Zero(numbers);
  for (std::int32_t in_tile = 0; in_tile < width; in_tile += step, squares += step / kSquare) {
    if ((columns >> in_tile & all_of_step) == 0) {
      continue;
    }
    const std::int32_t first = tile * kWide + in_tile;
    bool comes_nearer = false;
    for (std::int32_t x = first; x < first + step; x += lanes) {
      comes_nearer = comes_nearer || !hn::AllFalse(kPixels, hn::Gt(depths.nearest(x), ofSquares(squares)));
    }
    if (!comes_nearer) {
      continue;
    }
    auto now = hn::Set(kPixels, kInfinite);
    for (std::int32_t x = first; x < first + step; x += lanes) {
      now = hn::Min(now, gainColumns(pixels, x, covered, depths, gain, gained));
    }
    setSquares(now, squares);
  }
  return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(numbers, gained)));
}

// Clears a tile, and leaves in its first plane the pixels in which the winding is surely positive. outside[]:
// windings to the left of the tile. valid: pixels of a row that there are.
HWY_INLINE void coverTile(WindingTile& tile, const std::int32_t* outside, std::uint32_t valid) {
  constexpr std::int32_t kPlanes = WindingTile::kPlanes, kLargest = (1 << (kPlanes - 1)) - 1;
  for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kBits))) {
    const auto added = hn::Min(hn::Max(hn::Load(kNumbers, outside + lane), hn::Set(kNumbers, -kLargest - 1)),
                               hn::Set(kNumbers, kLargest));
    const auto zero = hn::Zero(kBits);
    BitsV carry = zero, any = zero, sign = zero;
    for (std::int32_t plane = 0; plane < kPlanes; ++plane) {
      std::uint32_t* row = tile.planes[plane] + lane;
      const auto a = hn::Load(kBits, row),
                 b = hn::BitCast(
                     kBits, hn::VecFromMask(kNumbers, hn::TestBit(added, hn::Set(kNumbers, 1 << plane))));
      const auto differ = hn::Xor(a, b);
      any = hn::Or(any, hn::Xor(differ, carry));
      carry = hn::Or(hn::And(a, b), hn::And(carry, differ));
      sign = hn::Xor(differ, carry);  // of the sum, with one more plane that repeats the signs of both
      hn::Store(zero, kBits, row);
    }
    const auto unknown = hn::Load(kBits, tile.unknown + lane);
    hn::Store(zero, kBits, tile.unknown + lane);
    const auto positive = hn::AndNot(hn::Or(sign, unknown), any);
    hn::Store(hn::And(positive, hn::Set(kBits, valid)), kBits, tile.planes[0] + lane);
  }
}

// Clears a row of tiles of a group, and leaves in the first plane of each the pixels that it covers. Returns
// the last tile. Others are cleared, and it covers none of them.
HWY_INLINE std::int32_t coverRow(WindingTile* tiles, const TileExtent& extent, std::int32_t last_column,
                                 std::int32_t width) {
  HWY_ALIGN std::int32_t outside[kHigh] = {};
  std::int32_t x = extent.first;
  bool inside = false;  // some pixel at the right border of the tile before may be
  for (; x <= last_column && (x <= extent.last || inside); ++x) {
    WindingTile& tile = tiles[x];
    inside = false;
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kNumbers))) {
      const auto sum = hn::Add(hn::Load(kNumbers, outside + lane), hn::Load(kNumbers, tile.carry + lane));
      hn::Store(sum, kNumbers, outside + lane);
      hn::Store(hn::Zero(kNumbers), kNumbers, tile.carry + lane);
      inside = inside || !hn::AllFalse(kNumbers, hn::Gt(sum, hn::Zero(kNumbers)));
    }
    const std::int32_t there = width - x * kWide;
    coverTile(tile, outside, there < kWide ? (1u << there) - 1u : ~0u);
  }
  return x - 1;
}

// Sets the depths of a row of tiles of a group that is drawn in tiles. First all tiles are covered, and then
// depths are set: so the processor need not wait for what one tile covers before it begins with the next one.
template <typename Depths>
HWY_INLINE void resolveTiles(const GroupCover& group, std::int32_t row, const PixelRows& pixels,
                             const Depths& depths, const Gains& gains, WindingGain& gain) {
  WindingTile* tiles = group.tiles + std::ptrdiff_t{group.columns} * row;
  const TileExtent& extent = group.extents[row];
  float* squares = group.squares->ofRow(row);
  const std::int32_t last = coverRow(tiles, extent, group.range.last_column, pixels.width);
  for (std::int32_t x = extent.first; x <= last; ++x) {
    ++gain.tiles;
    std::uint32_t* covered = tiles[x].planes[0];
    gain.nearer += gainTile(pixels, x, covered, depths, gains, squares + x * (kWide / kSquare));
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kBits))) {
      hn::Store(hn::Zero(kBits), kBits, covered + lane);
    }
  }
}

// Sets the depths of a row of tiles of a group that is drawn in runs.
template <typename Depths>
HWY_INLINE void resolveRuns(const GroupCover& group, std::int32_t row, const PixelRows& pixels,
                            const Depths& depths, const Gains& gains, WindingGain& gain) {
  const TileRowRuns& runs = group.runs[row];
  float* squares = group.squares->ofRow(row);
  HWY_ALIGN std::uint32_t covered[kHigh];
  for (std::int32_t x = runs.extent.first; x <= runs.extent.last; ++x) {
    ++gain.tiles;
    const auto origin = hn::Set(kNumbers, x * kWide);
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kNumbers))) {
      hn::Store(bitsBetween(hn::Sub(hn::Load(kNumbers, runs.begin + lane), origin),
                            hn::Sub(hn::Load(kNumbers, runs.end + lane), origin)),
                kBits, covered + lane);
    }
    gain.nearer += gainTile(pixels, x, covered, depths, gains, squares + x * (kWide / kSquare));
  }
}

// Sets the depths of a group in all rows of tiles that it touches.
template <typename Depths, typename Source>
HWY_INLINE WindingGain resolveRows(const GroupCover& group, const Source& source) {
  WindingGain gain;
  for (std::int32_t row = group.range.first_row; row <= group.range.last_row; ++row) {
    const PixelRows pixels(group.target, row);
    const Depths depths(source, row);
    const Gains gains(group.needs, row);
    if (group.runs != nullptr) {
      resolveRuns(group, row, pixels, depths, gains, gain);
    } else {
      resolveTiles(group, row, pixels, depths, gains, gain);
    }
  }
  return gain;
}

WindingGain resolveFarOf(const GroupCover& group, const FarDepths& depths) {
  return resolveRows<BlockDepths>(group, depths);
}

WindingGain resolvePlaneOf(const GroupCover& group, const DepthBound& depth) {
  return resolveRows<PlaneDepths>(group, depth);
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(resolveFarOf);
HWY_EXPORT(resolvePlaneOf);
}  // namespace

WindingGain resolveFar(const GroupCover& group, const FarDepths& depths) {
  return HWY_DYNAMIC_DISPATCH(resolveFarOf)(group, depths);
}

WindingGain resolvePlane(const GroupCover& group, const DepthBound& depth) {
  return HWY_DYNAMIC_DISPATCH(resolvePlaneOf)(group, depth);
}

}  // namespace sightline::occlusion
#endif
