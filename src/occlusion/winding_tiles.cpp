#include "src/occlusion/winding_tiles.h"

#include <algorithm>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/winding_tiles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/edge_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

constexpr std::int32_t kWide = kTileWidth, kHigh = kTileHeight;
constexpr std::int32_t kMostSteps = 2 << WindingTile::kPlanes;  // no winding is known after more of them

// Converts whole numbers from 0 to 2^22.
HWY_INLINE NumbersV wholeOf(PlacesV v) {
  constexpr float kWhole = 0x1p23f;  // the last digits of so large numbers are whole ones
  const auto whole = hn::Set(kPlaces, kWhole);
  return hn::BitCast(kNumbers, hn::Xor(hn::Add(v, whole), whole));
}

// The pixels of a tile from number `from` on, a whole number.
HWY_INLINE BitsV bitsFrom(PlacesV from) {
  const auto shift = hn::Min(hn::Max(from, hn::Zero(kPlaces)), hn::Set(kPlaces, kWide - 1.0f));
  const auto bits = hn::Shl(hn::Set(kBits, ~0u), hn::BitCast(kBits, wholeOf(shift)));
  return hn::IfThenZeroElse(hn::RebindMask(kBits, hn::Gt(from, shift)), bits);
}

// Adds 1 to the windings of some pixels of a tile, or, in rows of which all bits are set in `down`, takes 1
// away. `lane` is the first of the rows.
HWY_INLINE void stepBits(WindingTile& tile, std::int32_t lane, BitsV pixels, BitsV down) {
  BitsV carry = pixels, last_carry = pixels, before = pixels;
  for (std::int32_t plane = 0; plane < WindingTile::kPlanes; ++plane) {
    std::uint32_t* row = tile.planes[plane] + lane;
    before = hn::Xor(hn::Load(kBits, row), down);
    last_carry = carry;  // what is carried into this plane, the last of which has the sign
    hn::Store(hn::Xor(hn::Load(kBits, row), carry), kBits, row);
    carry = hn::And(before, carry);
  }
  // From the largest number to the smallest one, or back.
  const auto wrapped = hn::AndNot(before, last_carry);
  hn::Store(hn::Or(hn::Load(kBits, tile.unknown + lane), wrapped), kBits, tile.unknown + lane);
}

// Draws an edge into the tiles of a range.
class TileEdge {
 public:
  HWY_INLINE TileEdge(const WindingTiles& target, const TileRange& range, const BoundaryEdge& edge,
                      std::int32_t value)
      : target_(target), range_(range), edge_(edge), size_(std::abs(value)), rises_(edge.rises(value)) {}

  HWY_INLINE void draw(bool above_inner) const {
    const EdgeRows rows(edge_, target_.end_x, rises_, above_inner);
    rows.forTileRows(range_.first_row, range_.last_row, [&](std::int32_t row, double x) HWY_ATTR {
      std::int32_t first = edge_.first_tile, last = edge_.last_tile;
      if (first + 1 < last && edge_.kind == EdgeSlope::kSteep) {
        narrow(x, first, last);
      }
      first = std::max(first, range_.first_column);
      // An edge to the left of the group counts in its first tile.
      last = std::max(std::min(last, range_.last_column), range_.first_column - 1);
      if (first > range_.last_column) {
        return;
      }
      TileExtent& extent = target_.extents[row];
      extent.first = std::min(extent.first, first);
      extent.last = std::max(extent.last, std::min(last + 1, range_.last_column));
      WindingTile* tiles = target_.tiles + std::ptrdiff_t{target_.stride} * row;
      rows.forRows(row, x,
                   [&](std::int32_t lane, PlacesV from, PlacesV to, PlacesM touched, PlacesM crossed,
                       PlacesV middle, PlacesV doubt) HWY_ATTR {
                     drawRows(tiles, first, last, lane, from, to, touched, crossed, middle, doubt);
                   });
    });
  }

 private:
  // Leaves out tiles that the edge does not touch in this row of them.
  HWY_INLINE void narrow(double x, std::int32_t& first, std::int32_t& last) const {
    constexpr double kTiles = 1.0 / (kWide * kGridStep), kRounding = 2.0, kMost = 1 << 16;
    const double end_x = x + kHigh * kGridStep * edge_.slope;
    const double low = (std::min(x, end_x) - edge_.reach - kRounding) * kTiles,
                 high = (std::max(x, end_x) + edge_.reach + kRounding) * kTiles;
    first = std::max(first, static_cast<std::int32_t>(std::min(std::max(low, -1.0), kMost)));
    last = std::min(last, static_cast<std::int32_t>(std::min(std::max(high, -1.0), kMost)));
  }

  // Tiles from `first` to `last` may be touched. See EdgeRows::forRows().
  HWY_INLINE void drawRows(WindingTile* tiles, std::int32_t first, std::int32_t last, std::int32_t lane,
                           PlacesV from_x, PlacesV to_x, PlacesM touched, PlacesM crossed, PlacesV middle,
                           PlacesV doubt) const {
    const auto set = [](float v) HWY_ATTR { return hn::Set(kPlaces, v); };
    const auto pixel = set(1.0f / kGridStep), half = set(0.5f), one = set(1.0f);
    // Pixels that the edge may touch, and those of them whose centres are too near to it.
    const auto begin = hn::Floor(hn::Mul(from_x, pixel)), end = hn::Add(hn::Floor(hn::Mul(to_x, pixel)), one);
    const auto doubt_begin = hn::Max(begin, hn::Ceil(hn::Sub(hn::Mul(hn::Sub(middle, doubt), pixel), half))),
               doubt_end = hn::Min(
                   end, hn::Add(hn::Floor(hn::Sub(hn::Mul(hn::Add(middle, doubt), pixel), half)), one));
    const auto doubts = hn::And(touched, hn::Lt(doubt_begin, doubt_end));
    const bool some_cross = !hn::AllFalse(kPlaces, crossed), some_doubt = !hn::AllFalse(kPlaces, doubts);
    // Windings change from the pixel `from` on, up to `to`: behind the edge where it crosses the middle of a
    // row, and else where centres are, or may be, on its inner side.
    const auto never = set(0x1p20f);
    const auto turn = rises_ ? end : begin;
    const auto lost_begin = rises_ ? doubt_begin : begin, lost_end = rises_ ? end : doubt_end;
    const auto from = hn::IfThenElse(touched, hn::IfThenElse(crossed, turn, lost_begin), never),
               to = hn::IfThenElse(crossed, never, lost_end);
    const auto all = hn::Set(kBits, ~0u);
    const auto down = rises_ ? hn::Not(hn::VecFromMask(kBits, hn::RebindMask(kBits, crossed))) : all;
    const auto between = [](PlacesV first_pixel, PlacesV end_pixel, PlacesV origin) HWY_ATTR {
      return hn::AndNot(bitsFrom(hn::Sub(end_pixel, origin)), bitsFrom(hn::Sub(first_pixel, origin)));
    };
    for (std::int32_t n = std::min(size_, kMostSteps); n > 0; --n) {
      for (std::int32_t x = first; x <= last; ++x) {
        const auto origin = set(static_cast<float>(x * kWide));
        stepBits(tiles[x], lane, between(from, to, origin), down);
        if (some_doubt) {
          const auto bits = between(doubt_begin, doubt_end, origin);
          stepBits(tiles[x], lane, hn::IfThenElseZero(hn::RebindMask(kBits, doubts), bits), all);
        }
      }
    }
    if (some_cross && last < range_.last_column) {
      const hn::Rebind<std::int16_t, Numbers> d16;
      std::int16_t* carry = tiles[last + 1].carry + lane;
      const auto step =
          hn::IfThenElseZero(hn::RebindMask(kNumbers, crossed), hn::Set(kNumbers, rises_ ? size_ : -size_));
      hn::StoreU(hn::Add(hn::LoadU(d16, carry), hn::DemoteTo(d16, step)), d16, carry);
    }
  }

  const WindingTiles& target_;
  const TileRange& range_;
  const BoundaryEdge& edge_;
  std::int32_t size_;
  bool rises_;
};

void drawAll(const WindingTiles& target, const TileRange& range, std::span<const BoundaryEdge> edges,
             std::span<const BoundaryChain> chains) {
  for (std::int32_t row = range.first_row; row <= range.last_row; ++row) {
    target.extents[row] = {range.last_column + 1, -1};
  }
  for (const BoundaryChain& chain : chains) {
    for (const BoundaryEdge& edge : edges.subspan(chain.first, chain.count)) {
      if (edge.touches(range.first_row, range.last_row) && edge.first_tile <= range.last_column) {
        TileEdge(target, range, edge, chain.value).draw(edge.rightwards == (chain.value > 0));
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(drawAll);
}  // namespace

void drawTiles(const WindingTiles& target, const TileRange& range, std::span<const BoundaryEdge> edges,
               std::span<const BoundaryChain> chains) {
  HWY_DYNAMIC_DISPATCH(drawAll)(target, range, edges, chains);
}

}  // namespace sightline::occlusion
#endif
