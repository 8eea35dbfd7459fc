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

constexpr std::int32_t kWide = WindingTile::kWidth, kHigh = WindingTile::kHeight;
constexpr std::int32_t kLanes = 8;   // most lanes of a vector of pixels
constexpr double kSteepest = 256.0;  // change of x from row to row that single precision can follow, pixels
constexpr double kBeyond = 0x1p20;   // so far outside the rectangle, in 256ths of a pixel, nothing matters
constexpr float kGain = 1.125f;      // a pixel counts as changed if it becomes nearer by this factor
constexpr std::int32_t kMostSteps = 2 << WindingTile::kPlanes;  // no winding is known after more of them

// One vector lane for each row of a tile, or of a part of it.
using Bits = hn::CappedTag<std::uint32_t, kHigh>;
using Places = hn::CappedTag<float, kHigh>;
using Numbers = hn::RebindToSigned<Bits>;
using BitsV = hn::Vec<Bits>;
using PlacesV = hn::Vec<Places>;
using NumbersV = hn::Vec<Numbers>;
constexpr Bits kBits;
constexpr Places kPlaces;
constexpr Numbers kNumbers;

// The pixels of a tile from number `from` on.
HWY_INLINE BitsV bitsFrom(NumbersV from) {
  const auto shift = hn::Min(hn::Max(from, hn::Zero(kNumbers)), hn::Set(kNumbers, kWide - 1));
  const auto bits = hn::Shl(hn::Set(kBits, ~0u), hn::BitCast(kBits, shift));
  return hn::IfThenZeroElse(hn::RebindMask(kBits, hn::Gt(from, hn::Set(kNumbers, kWide - 1))), bits);
}

// Adds 1 to the windings of some pixels of a tile, or takes 1 away. `lane` is the first of the rows.
template <bool kUp>
HWY_INLINE void stepBits(WindingTile& tile, std::int32_t lane, BitsV pixels) {
  BitsV carry = pixels, sign = pixels, before = pixels;
  for (std::int32_t plane = 0; plane < WindingTile::kPlanes; ++plane) {
    std::uint32_t* row = tile.planes[plane] + lane;
    before = hn::Load(kBits, row);
    sign = carry;  // what is carried into this plane, the last of which has the sign
    hn::Store(hn::Xor(before, carry), kBits, row);
    carry = kUp ? hn::And(before, carry) : hn::AndNot(before, carry);
  }
  // From the largest number to the smallest one, or back.
  const auto wrapped = kUp ? hn::AndNot(before, sign) : hn::And(before, sign);
  hn::Store(hn::Or(hn::Load(kBits, tile.unknown + lane), wrapped), kBits, tile.unknown + lane);
}

// An edge, as its rows need it.
class EdgeRows {
 public:
  // first_row, last_row: rows that it may touch.
  EdgeRows(const WindingEdges& target, GridPoint from, GridPoint to, std::int32_t value,
           std::int32_t first_row, std::int32_t last_row)
      : target_(target),
        from_(from),
        size_(std::abs(value)),
        first_row_(first_row),
        last_row_(last_row),
        left_(std::min(from.x, to.x) - WindingMap::kMargin),
        right_(std::max(from.x, to.x) + WindingMap::kMargin) {
    constexpr double kMargin = WindingMap::kMargin;
    const double dx = to.x - from.x, dy = to.y - from.y;
    const PixelRectangle& r = target.rectangle;
    slope_ = dy == 0.0 ? 0.0 : dx / dy;
    level_ = dy == 0.0;
    steep_ = !level_ && std::abs(slope_) <= kSteepest;
    // To the right of it the winding is greater; of a level edge this is a convention.
    rises_ = (dy < 0.0) == (value > 0);
    first_crossed_ = rowAfter(std::min(from.y, to.y));
    end_crossed_ = rowAfter(std::max(from.y, to.y));
    widest_ = 2.0 * kBeyond + (r.x1 - r.x0) * kPixel;
    // A level edge crosses no border of a row.
    spread_ = level_ ? 4.0 * kLargestGrid : (std::abs(slope_) + 3.0) * kMargin;
    // So near to the edge, along a row, it is unknown on which side a pixel's centre is: see "The pixel".
    doubt_ = level_
                 ? 0.0
                 : std::min(widest_, (std::abs(slope_) + 1.0 + 4.0 * kPixel / std::abs(dy)) * kMargin + 2.0);
    above_inner_ = (dx > 0.0) == (value > 0);
    level_doubt_ = level_ ? kMargin * (1.0 + 4.0 * kPixel / std::max(std::abs(dx), 1.0)) : 0.0;
  }

  HWY_INLINE void draw() const {
    for (std::int32_t tile_row = first_row_ / kHigh; tile_row <= last_row_ / kHigh; ++tile_row) {
      drawTiles(tile_row);
    }
  }

 private:
  static constexpr double kPixel = kGridStep;

  // The first row of the rectangle whose middle is not below a point.
  std::int32_t rowAfter(double y) const {
    const PixelRectangle& r = target_.rectangle;
    const double row = std::clamp((y - 0.5 * kPixel) * (1.0 / kPixel), double(r.y0), double(r.y1));
    const auto whole = static_cast<std::int32_t>(row);
    return whole < row ? whole + 1 : whole;
  }

  float place(double x) const {
    const PixelRectangle& r = target_.rectangle;
    return static_cast<float>(std::clamp(x, r.x0 * kPixel - kBeyond, r.x1 * kPixel + kBeyond));
  }

  HWY_INLINE void drawTiles(std::int32_t tile_row) const {
    constexpr double kTile = kWide * kPixel;
    const PixelRectangle& r = target_.rectangle;
    const double x = from_.x + (tile_row * kHigh * kPixel - from_.y) * slope_,
                 end_x = x + kHigh * kPixel * slope_;
    const double low = std::max(std::min(x, end_x) - spread_, left_) - 2.0,
                 high = std::min(std::max(x, end_x) + spread_, right_) + 2.0;
    const double x0 = r.x0 * kPixel, x1 = r.x1 * kPixel;
    if (low >= x1) {
      return;
    }
    const std::int32_t first = static_cast<std::int32_t>(std::max(low, x0) * (1.0 / kTile)),
                       last = high < x0 ? r.x0 / kWide - 1
                                        : static_cast<std::int32_t>(std::min(high, x1 - 1.0) * (1.0 / kTile));
    WindingTile* tiles = target_.tiles + std::ptrdiff_t{target_.stride} * tile_row;
    WindingExtent& extent = target_.extents[tile_row];
    extent.first = std::min(extent.first, first);
    extent.last = std::max(extent.last, std::min(last + 1, r.x1 / kWide - 1));

    // Where the edge crosses the lower and upper borders of a row, and its middle.
    const std::int32_t row = tile_row * kHigh;
    if (steep_) {
      const auto base = hn::Set(kPlaces, place(x));
      const auto per_row = hn::Set(kPlaces, static_cast<float>(slope_ * kPixel));
      const auto doubt = hn::Set(kPlaces, static_cast<float>(doubt_));
      for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
        const auto below = hn::Add(hn::Mul(hn::Iota(kPlaces, static_cast<float>(lane)), per_row), base);
        const auto above = hn::Add(below, per_row);
        const auto middle = hn::Mul(hn::Add(below, above), hn::Set(kPlaces, 0.5f));
        drawRows(tiles, first, last, row, lane, below, above, middle, doubt);
      }
      return;
    }
    // The places at which a flat edge crosses the borders may be clamped, so its middle is computed by
    // itself.
    HWY_ALIGN float below[kHigh], above[kHigh], middle[kHigh], doubt[kHigh];
    for (std::int32_t i = 0; i < kHigh; ++i) {
      const double at = x + i * kPixel * slope_;
      below[i] = place(at);
      above[i] = place(at + kPixel * slope_);
      middle[i] = place(at + 0.5 * kPixel * slope_);
      doubt[i] = static_cast<float>(doubt_);
      if (level_) {
        const double height = (row + i + 0.5) * kPixel - from_.y;
        const bool inner = (height > 0.0) == above_inner_;
        middle[i] = place(inner == rises_ ? r.x0 * kPixel - kBeyond : r.x1 * kPixel + kBeyond);
        doubt[i] = std::abs(height) <= level_doubt_ ? static_cast<float>(2.0 * widest_) : 0.0f;
      }
    }
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
      drawRows(tiles, first, last, row, lane, hn::Load(kPlaces, below + lane),
               hn::Load(kPlaces, above + lane), hn::Load(kPlaces, middle + lane),
               hn::Load(kPlaces, doubt + lane));
    }
  }

  // Tiles from `first` to `last` may be touched. The vectors have a lane for each row from row + lane on.
  HWY_INLINE void drawRows(WindingTile* tiles, std::int32_t first, std::int32_t last, std::int32_t first_row,
                           std::int32_t lane, PlacesV below, PlacesV above, PlacesV middle,
                           PlacesV doubt) const {
    const PixelRectangle& r = target_.rectangle;
    const auto rows = hn::Iota(kNumbers, first_row + lane);
    const auto touched = hn::And(hn::Gt(rows, hn::Set(kNumbers, first_row_ - 1)),
                                 hn::Lt(rows, hn::Set(kNumbers, last_row_ + 1)));
    const auto crossed = hn::And(hn::Gt(rows, hn::Set(kNumbers, first_crossed_ - 1)),
                                 hn::Lt(rows, hn::Set(kNumbers, end_crossed_)));
    const auto pixel = hn::Set(kPlaces, 1.0f / kGridStep), half = hn::Set(kPlaces, 0.5f),
               reach = hn::Set(kPlaces, static_cast<float>(std::min(spread_, widest_)));
    const auto x0 = hn::Set(kPlaces, static_cast<float>(r.x0 * kPixel)),
               x1 = hn::Set(kPlaces, static_cast<float>(r.x1 * kPixel - 1.0));
    const auto from_x = hn::Max(hn::Sub(hn::Min(below, above), reach), hn::Set(kPlaces, place(left_))),
               to_x = hn::Min(hn::Add(hn::Max(below, above), reach), hn::Set(kPlaces, place(right_)));
    const auto numberOf = [](PlacesV v) HWY_ATTR { return hn::ConvertTo(kNumbers, v); };
    // Pixels that the edge may touch, and those of them whose centres are too near to it.
    const auto begin = numberOf(hn::Floor(hn::Mul(hn::Max(from_x, x0), pixel)));
    const auto end = hn::Add(numberOf(hn::Floor(hn::Mul(hn::Min(to_x, x1), pixel))), hn::Set(kNumbers, 1));
    const auto near_begin = numberOf(hn::Ceil(hn::Sub(hn::Mul(hn::Sub(middle, doubt), pixel), half))),
               near_end = hn::Add(numberOf(hn::Floor(hn::Sub(hn::Mul(hn::Add(middle, doubt), pixel), half))),
                                  hn::Set(kNumbers, 1));
    // Rows whose middle it does not cross lose windings where centres are, or may be, on its inner side.
    const auto passed = hn::AndNot(crossed, touched);
    const auto lost_begin = rises_ ? hn::Max(begin, near_begin) : begin,
               lost_end = rises_ ? end : hn::Min(end, near_end);
    const auto doubt_begin = hn::Max(begin, near_begin), doubt_end = hn::Min(end, near_end);
    const auto loses = hn::And(passed, hn::Lt(lost_begin, lost_end)),
               doubts = hn::And(touched, hn::Lt(doubt_begin, doubt_end));
    const bool some_cross = !hn::AllFalse(kNumbers, crossed), some_lose = !hn::AllFalse(kNumbers, loses),
               some_doubt = !hn::AllFalse(kNumbers, doubts);
    const auto turn = rises_ ? end : begin;
    for (std::int32_t n = std::min(size_, kMostSteps); n > 0; --n) {
      for (std::int32_t x = first; x <= last; ++x) {
        const auto origin = hn::Set(kNumbers, x * kWide);
        const auto between = [origin](NumbersV from, NumbersV to, hn::Mask<Numbers> where) HWY_ATTR {
          return hn::IfThenElseZero(
              hn::RebindMask(kBits, where),
              hn::AndNot(bitsFrom(hn::Sub(to, origin)), bitsFrom(hn::Sub(from, origin))));
        };
        if (some_cross) {
          const auto bits =
              hn::IfThenElseZero(hn::RebindMask(kBits, crossed), bitsFrom(hn::Sub(turn, origin)));
          rises_ ? stepBits<true>(tiles[x], lane, bits) : stepBits<false>(tiles[x], lane, bits);
        }
        if (some_lose) {
          stepBits<false>(tiles[x], lane, between(lost_begin, lost_end, loses));
        }
        if (some_doubt) {
          stepBits<false>(tiles[x], lane, between(doubt_begin, doubt_end, doubts));
        }
      }
    }
    if (some_cross && last + 1 < r.x1 / kWide) {
      const hn::Rebind<std::int16_t, Numbers> d16;
      std::int16_t* carry = tiles[last + 1].carry + lane;
      const auto step = hn::IfThenElseZero(crossed, hn::Set(kNumbers, rises_ ? size_ : -size_));
      hn::StoreU(hn::Add(hn::LoadU(d16, carry), hn::DemoteTo(d16, step)), d16, carry);
    }
  }

  const WindingEdges& target_;
  GridPoint from_;
  std::int32_t size_, first_row_, last_row_, first_crossed_, end_crossed_;
  double left_, right_, slope_, widest_, spread_, doubt_, level_doubt_;
  bool level_, steep_, rises_, above_inner_;
};

// False: the edge lies above, below or to the right of the rectangle.
HWY_INLINE bool drawEdge(const WindingEdges& target, GridPoint from, GridPoint to, std::int32_t value) {
  constexpr double kPixel = kGridStep, kMargin = WindingMap::kMargin;
  const double low = std::min(from.y, to.y), high = std::max(from.y, to.y);
  const double left = std::min(from.x, to.x) - kMargin;
  const PixelRectangle& r = target.rectangle;
  if (!(high + kMargin >= r.y0 * kPixel && low - kMargin < r.y1 * kPixel && left < r.x1 * kPixel)) {
    return false;
  }
  const double bottom_row = r.y0, top_row = r.y1 - 0.5;
  const auto first_row = static_cast<std::int32_t>(std::max((low - kMargin) * (1.0 / kPixel), bottom_row)),
             last_row = static_cast<std::int32_t>(std::min((high + kMargin) * (1.0 / kPixel), top_row));
  EdgeRows(target, from, to, value, first_row, last_row).draw();
  return true;
}

// Sets covered[] to the pixels of a tile in which the winding is surely positive, and clears the tile.
// outside[]: windings to the left of the tile. Returns whether there are such pixels.
HWY_INLINE bool coverTile(WindingTile& tile, const std::int32_t* outside, std::uint32_t* covered) {
  constexpr std::int32_t kPlanes = WindingTile::kPlanes, kLargest = (1 << (kPlanes - 1)) - 1;
  bool some = false;
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
    const auto positive = hn::AndNot(hn::Or(sign, hn::Load(kBits, tile.unknown + lane)), any);
    hn::Store(zero, kBits, tile.unknown + lane);
    hn::Store(positive, kBits, covered + lane);
    some = some || !hn::AllTrue(kBits, hn::Eq(positive, zero));
  }
  return some;
}

// depth_of(x, y, d): the reciprocal depths of the pixels from x on in row y, counted from the lowest one of
// the tiles. Returns how many pixels changed.
template <std::int32_t kMostLanes, typename DepthOf>
HWY_INLINE std::uint32_t resolveTilesOf(const WindingRow& target, std::uint64_t& tiles, DepthOf&& depth_of) {
  const hn::CappedTag<float, kMostLanes> d;
  const hn::RebindToUnsigned<decltype(d)> d32;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const std::uint32_t all_lanes = ~0u >> (kWide - lanes);
  const auto lane_bits = hn::Shl(hn::Set(d32, 1u), hn::Iota(d32, 0u));
  HWY_ALIGN std::int32_t outside[kHigh] = {};
  HWY_ALIGN std::uint32_t covered[kHigh];
  std::size_t nearer = 0;
  bool inside = false;  // some pixel at the right border of the tile before may be
  const WindingRow row = target;
  for (std::int32_t x = row.first; x < row.end && (x <= row.last || inside); ++x) {
    WindingTile& tile = row.tiles[x];
    inside = false;
    for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kNumbers))) {
      const hn::Rebind<std::int16_t, Numbers> d16;
      const auto sum = hn::Add(hn::Load(kNumbers, outside + lane),
                               hn::PromoteTo(kNumbers, hn::LoadU(d16, tile.carry + lane)));
      hn::Store(sum, kNumbers, outside + lane);
      hn::StoreU(hn::Zero(d16), d16, tile.carry + lane);
      inside = inside || !hn::AllFalse(kNumbers, hn::Gt(sum, hn::Zero(kNumbers)));
    }
    ++tiles;
    if (!coverTile(tile, outside, covered)) {
      continue;
    }
    tile.stale = true;
    const std::int32_t width = std::min(row.width - x * kWide, kWide);
    const std::uint32_t valid = width < kWide ? (1u << width) - 1u : ~0u;
    for (std::int32_t y = 0; y < row.rows; ++y) {
      const std::uint32_t bits = covered[y] & valid;
      if (bits == 0) {
        continue;
      }
      float* out = row.reciprocal_depth + std::size_t{row.stride} * static_cast<std::uint32_t>(y) + x * kWide;
      for (std::int32_t at = 0; at < kWide; at += lanes) {
        const std::uint32_t chunk = bits >> at;
        if ((chunk & all_lanes) == 0) {
          continue;
        }
        const auto mask = hn::RebindMask(d, hn::TestBit(hn::Set(d32, chunk), lane_bits));
        const auto old = hn::LoadU(d, out + at);
        const auto depth = depth_of(x * kWide + at, y, d);
        const auto gained = hn::And(mask, hn::Gt(depth, old));
        nearer += hn::CountTrue(d, hn::And(gained, hn::Gt(depth, hn::Mul(old, hn::Set(d, kGain)))));
        hn::StoreU(hn::IfThenElse(gained, depth, old), d, out + at);
      }
    }
  }
  return static_cast<std::uint32_t>(nearer);
}

// far: least reciprocal depths of blocks of pixels, `stride` for each row of them.
std::uint32_t resolveFar(const WindingRow& row, std::uint64_t& tiles, const float* far,
                         std::uint32_t stride) {
  return resolveTilesOf<kFarWidth>(
      row, tiles, [far, stride](std::int32_t x, std::int32_t y, auto d) HWY_ATTR {
        constexpr float kMax = std::numeric_limits<float>::max();
        const float depth = far[stride * static_cast<std::uint32_t>(y / kFarHeight) +
                                static_cast<std::uint32_t>(x / kFarWidth)];
        return hn::Set(d, depth <= kMax ? depth : -kMax);
      });
}

// first_row: the number of the lowest row in the target.
std::uint32_t resolvePlane(const WindingRow& row, std::uint64_t& tiles, const DepthBound& depth,
                           std::int32_t first_row) {
  return resolveTilesOf<kWide>(
      row, tiles, [&depth, first_row](std::int32_t x, std::int32_t y, auto d) HWY_ATTR {
        const float at_row = depth.along_y * static_cast<float>(first_row + y) + depth.at_origin;
        const auto column = hn::Iota(d, static_cast<float>(x));
        const auto plane = hn::Add(hn::Mul(column, hn::Set(d, depth.along_x)), hn::Set(d, at_row));
        return hn::Max(plane, hn::Set(d, depth.floor));
      });
}

// Draws the edges from each point to the next one, or only every second of them (step 2). Returns how many
// may touch the rectangle.
std::uint32_t drawEdges(const WindingEdges& target, std::span<const GridPoint> points, std::uint32_t step,
                        std::int32_t value) {
  std::uint32_t drawn = 0;
  for (std::size_t i = 1; i < points.size(); i += step) {
    drawn += drawEdge(target, points[i - 1], points[i], value) ? 1 : 0;
  }
  return drawn;
}

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

// Whether all pixels of a rectangle have a greater value than this.
bool allNearer(const DepthTarget& target, WindingTile* tiles, std::int32_t stride, const PixelRectangle& r,
               float than) {
  const auto width = static_cast<std::int32_t>(target.width),
             height = static_cast<std::int32_t>(target.height);
  for (std::int32_t tile_y = r.y0 / kHigh; tile_y * kHigh < r.y1; ++tile_y) {
    for (std::int32_t tile_x = r.x0 / kWide; tile_x * kWide < r.x1; ++tile_x) {
      WindingTile& tile = tiles[std::ptrdiff_t{stride} * tile_y + tile_x];
      if (tile.least > than) {
        continue;
      }
      const PixelRectangle whole{tile_x * kWide, tile_y * kHigh, std::min(tile_x * kWide + kWide, width),
                                 std::min(tile_y * kHigh + kHigh, height)};
      if (tile.stale) {
        tile.stale = false;
        tile.least = leastOf(target, whole);
        if (tile.least > than) {
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
    const auto x = hn::Iota(tag, static_cast<float>(tile));
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
HWY_EXPORT(drawEdges);
HWY_EXPORT(lowerTiles);
HWY_EXPORT(resolveFar);
HWY_EXPORT(resolvePlane);

constexpr std::uint64_t kLargestSum = 16000;  // of edges' values in a group: WindingTile::carry is a word
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void WindingMap::resize(const DepthTarget& target) {
  target_ = target;
  edges_ = pixels_ = 0;
  const auto wholes = [](std::uint32_t pixels, std::int32_t size) {
    return (static_cast<std::int32_t>(pixels) + size - 1) / size;
  };
  const std::int32_t columns = wholes(target.width, WindingTile::kWidth),
                     rows = wholes(target.height, WindingTile::kHeight);
  if (columns != columns_ || extents_.size() != static_cast<std::size_t>(rows)) {
    columns_ = columns;
    tiles_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), {});
    extents_.assign(static_cast<std::size_t>(rows), {});
    far_stride_ = static_cast<std::uint32_t>(columns) * (WindingTile::kWidth / kFarWidth);
    far_.assign(
        std::size_t{far_stride_} * static_cast<std::size_t>(rows) * (WindingTile::kHeight / kFarHeight),
        kInfinity);
  }
  for (WindingTile& tile : tiles_) {
    tile.stale = true;
    tile.least = -kInfinity;
  }
}

bool WindingMap::hides(const PixelRectangle& rectangle, float nearest) {
  return HWY_DYNAMIC_DISPATCH(allNearer)(target_, tiles_.data(), columns_, rectangle, nearest);
}

void WindingMap::begin(const PixelRectangle& rectangle) {
  constexpr std::int32_t kWidth = WindingTile::kWidth, kHeight = WindingTile::kHeight;
  sum_ = 0;
  rectangle_ = {rectangle.x0 / kWidth * kWidth, rectangle.y0 / kHeight * kHeight,
                (rectangle.x1 + kWidth - 1) / kWidth * kWidth,
                (rectangle.y1 + kHeight - 1) / kHeight * kHeight};
  for (std::int32_t row = rectangle_.y0 / kHeight; row < rectangle_.y1 / kHeight; ++row) {
    extents_[static_cast<std::size_t>(row)] = {columns_, -1};
  }
}

void WindingMap::addEdges(std::span<const GridPoint> points, std::uint32_t step, std::int32_t value) {
  if (points.size() < 2) {
    return;
  }
  const WindingEdges target{tiles_.data(), extents_.data(), columns_, rectangle_};
  const std::uint32_t drawn = HWY_DYNAMIC_DISPATCH(drawEdges)(target, points, step, value);
  edges_ += drawn;
  sum_ += std::uint64_t{drawn} * static_cast<std::uint32_t>(std::abs(value));
}

void WindingMap::addDepth(const PixelRectangle& rectangle, const DepthBound& depth) {
  const PixelRectangle r{std::max(rectangle.x0, rectangle_.x0), std::max(rectangle.y0, rectangle_.y0),
                         std::min(rectangle.x1, rectangle_.x1), std::min(rectangle.y1, rectangle_.y1)};
  if (r.empty()) {
    return;
  }
  const std::int32_t first = r.x0 / kFarWidth, end = (r.x1 - 1) / kFarWidth + 1;
  const float top = depth.along_y < 0.0f ? kFarHeight - 1 : 0.0f,
              right = depth.along_x < 0.0f ? kFarWidth - 1 : 0.0f;
  for (std::int32_t tile_y = r.y0 / kFarHeight; tile_y <= (r.y1 - 1) / kFarHeight; ++tile_y) {
    const float at_row = depth.along_y * (static_cast<float>(tile_y * kFarHeight) + top) +
                         (depth.along_x * right + depth.at_origin);
    HWY_DYNAMIC_DISPATCH(lowerTiles)
    (far_.data() + std::size_t{far_stride_} * static_cast<std::uint32_t>(tile_y), first, end,
     depth.along_x * kFarWidth, at_row, depth.floor);
  }
}

template <typename ResolveRow>
std::uint32_t WindingMap::resolveRows(ResolveRow&& resolve_row) {
  constexpr std::int32_t kHeight = WindingTile::kHeight;
  std::uint32_t nearer = 0;
  std::uint64_t tiles = 0;
  for (std::int32_t row = rectangle_.y0 / kHeight; row < rectangle_.y1 / kHeight; ++row) {
    const WindingExtent& extent = extents_[static_cast<std::size_t>(row)];
    if (extent.first > extent.last) {
      continue;
    }
    WindingTile* tile_row = tiles_.data() + std::ptrdiff_t{columns_} * row;
    if (sum_ > kLargestSum) {
      for (std::int32_t x = extent.first; x <= extent.last; ++x) {
        tile_row[x].clear();
      }
      continue;
    }
    const std::int32_t y = row * kHeight;
    nearer += resolve_row(
        y,
        WindingRow{tile_row, extent.first, extent.last, rectangle_.x1 / WindingTile::kWidth,
                   target_.reciprocal_depth + std::size_t{target_.stride} * static_cast<std::uint32_t>(y),
                   target_.stride, (static_cast<std::int32_t>(target_.width) + 7) & ~7,
                   std::min(kHeight, static_cast<std::int32_t>(target_.height) - y)},
        tiles);
  }
  pixels_ += tiles * (WindingTile::kWidth * WindingTile::kHeight);
  return nearer;
}

std::uint32_t WindingMap::resolve() {
  const std::uint32_t nearer =
      resolveRows([this](std::int32_t y, const WindingRow& row, std::uint64_t& tiles) {
        return HWY_DYNAMIC_DISPATCH(resolveFar)(
            row, tiles, far_.data() + std::size_t{far_stride_} * static_cast<std::uint32_t>(y / kFarHeight),
            far_stride_);
      });
  for (std::int32_t y = rectangle_.y0 / kFarHeight; y < rectangle_.y1 / kFarHeight; ++y) {
    const auto row = far_.begin() + static_cast<std::ptrdiff_t>(far_stride_) * y;
    std::fill(row + rectangle_.x0 / kFarWidth, row + rectangle_.x1 / kFarWidth, kInfinity);
  }
  return nearer;
}

std::uint32_t WindingMap::resolve(const DepthBound& depth) {
  return resolveRows([&depth](std::int32_t y, const WindingRow& row, std::uint64_t& tiles) {
    return HWY_DYNAMIC_DISPATCH(resolvePlane)(row, tiles, depth, y);
  });
}

}  // namespace sightline::occlusion
#endif
