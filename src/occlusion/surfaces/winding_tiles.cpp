#include "src/occlusion/surfaces/winding_tiles.h"

#include <algorithm>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/winding_tiles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/surfaces/edge_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

constexpr std::int32_t kWide = kTileWidth, kHigh = kTileHeight;
constexpr std::int32_t kNever = 1 << 20;                        // a pixel beyond all buffers
constexpr std::int32_t kMostSteps = 2 << WindingTile::kPlanes;  // no winding is known after more of them

// Adds to the windings of some pixels of a tile: 1 in those that have a bit in `odd` and not in `down`, -1 in
// those that have one in both, -2 in those that have one in `down` alone. `lane` is the first of the rows.
HWY_INLINE void addBits(WindingTile& tile, std::int32_t lane, BitsV odd, BitsV down) {
  // In two's complement the lowest bit of what is added is that of `odd`, and all others are that of `down`.
  BitsV added = odd, carry = hn::Zero(kBits), before = carry, after = carry;
  for (std::int32_t plane = 0; plane < WindingTile::kPlanes; ++plane) {
    std::uint32_t* row = tile.planes[plane] + lane;
    before = hn::Load(kBits, row);
    const auto differ = hn::Xor(before, added);
    after = hn::Xor(differ, carry);
    carry = hn::Or(hn::And(before, added), hn::And(carry, differ));
    hn::Store(after, kBits, row);
    added = down;
  }
  // Both had one sign, and the sum has the other one.
  const auto wrapped = hn::AndNot(hn::Xor(before, down), hn::Xor(before, after));
  hn::Store(hn::Or(hn::Load(kBits, tile.unknown + lane), wrapped), kBits, tile.unknown + lane);
}

// Draws an edge into the tiles of a range.
class TileEdge {
 public:
  HWY_INLINE TileEdge(const WindingTiles& target, const TileRange& range, const BoundaryEdge& edge,
                      std::int32_t value)
      : target_(target), range_(range), edge_(edge), size_(std::abs(value)), rises_(edge.rises(value)) {}

  HWY_INLINE void draw(bool above_inner) const {
    const EdgeRows rows(edge_, target_.buffer, rises_, above_inner);
    rows.forRows(range_.first_row, range_.last_row,
                 [&](std::int32_t row, std::int32_t lane, PlacesV from, PlacesV to, PlacesM touched,
                     PlacesM crossed, PlacesV middle, PlacesV doubt) HWY_ATTR {
                   std::int32_t first = edge_.first_tile, last = edge_.last_tile;
                   if (first + 1 < last && edge_.kind == EdgeSlope::kSteep) {
                     const std::int32_t origin = edge_.first_row >> kTileHeightShift;
                     narrow(edge_.x + (row - origin) * (kTileHeight * kGridStep * edge_.slope), first, last);
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
                   drawRows(tiles, first, last, lane, from, to, touched, crossed, middle, doubt);
                 });
  }

 private:
  // Leaves out tiles that the edge does not touch in this row of them.
  HWY_INLINE void narrow(double x, std::int32_t& first, std::int32_t& last) const {
    constexpr double kTiles = 1.0 / (kWide * kGridStep), kRounding = 2.0, kMost = 1 << 16;
    const double begin_x = BoundaryEdge::within(x, target_.buffer),
                 end_x = begin_x + kHigh * kGridStep * edge_.slope;
    const double low = (std::min(begin_x, end_x) - edge_.reach_left - kRounding) * kTiles,
                 high = (std::max(begin_x, end_x) + edge_.reach_right + kRounding) * kTiles;
    first = std::max(first, static_cast<std::int32_t>(std::min(std::max(low, -1.0), kMost)));
    last = std::min(last, static_cast<std::int32_t>(std::min(std::max(high, -1.0), kMost)));
  }

  // Tiles from `first` to `last` may be touched. See EdgeRows::forRows().
  HWY_INLINE void drawRows(WindingTile* tiles, std::int32_t first, std::int32_t last, std::int32_t lane,
                           PlacesV from_x, PlacesV to_x, PlacesM touched, PlacesM crossed, PlacesV middle,
                           PlacesV doubt) const {
    const auto pixel = hn::Set(kPlaces, 1.0f / kGridStep), half = hn::Set(kPlaces, 0.5f);
    // Pixels that the edge may touch, and those of them whose centres are too near to it.
    const auto low = hn::Floor(hn::Mul(from_x, pixel)),
               high = hn::Add(hn::Floor(hn::Mul(to_x, pixel)), hn::Set(kPlaces, 1.0f));
    const auto doubt_low = hn::Max(low, hn::Ceil(hn::Sub(hn::Mul(hn::Sub(middle, doubt), pixel), half))),
               doubt_high =
                   hn::Min(high, hn::Add(hn::Floor(hn::Sub(hn::Mul(hn::Add(middle, doubt), pixel), half)),
                                         hn::Set(kPlaces, 1.0f)));
    const auto begin = wholeOf(low), end = wholeOf(high), doubt_end = wholeOf(doubt_high);
    const auto rows = hn::RebindMask(kNumbers, touched), crossing = hn::RebindMask(kNumbers, crossed);
    const auto never = hn::Set(kNumbers, kNever);
    const auto doubt_begin = hn::IfThenElse(rows, wholeOf(doubt_low), never);
    // Windings change from the pixel `from` on, up to `to`: behind the edge where it crosses the middle of a
    // row, and else where centres are, or may be, on its inner side. Edges rise and fall in turn, so a branch
    // would often be predicted wrong.
    const auto rising = hn::Ne(hn::Set(kNumbers, rises_ ? 1 : 0), hn::Zero(kNumbers));
    const auto from = hn::IfThenElse(
                   rows, hn::IfThenElse(rising, hn::IfThenElse(crossing, end, doubt_begin), begin), never),
               to = hn::IfThenElse(crossing, never, hn::IfThenElse(rising, end, doubt_end));
    const auto rises_there = hn::RebindMask(kBits, hn::And(rising, crossing));
    for (std::int32_t x = first; x <= last; ++x) {
      const auto origin = hn::Set(kNumbers, x * kWide);
      const auto changed = bitsBetween(hn::Sub(from, origin), hn::Sub(to, origin)),
                 doubts = bitsBetween(hn::Sub(doubt_begin, origin), hn::Sub(doubt_end, origin));
      // Where windings rise, what is in doubt lies before that; elsewhere it is part of what falls.
      const auto down = hn::IfThenElse(rises_there, doubts, changed);
      for (std::int32_t n = std::min(size_, kMostSteps); n > 0; --n) {
        addBits(tiles[x], lane, hn::Xor(changed, doubts), down);
      }
    }
    if (last < range_.last_column) {
      std::int32_t* carry = tiles[last + 1].carry + lane;
      const auto step = hn::IfThenElseZero(crossing, hn::Set(kNumbers, rises_ ? size_ : -size_));
      hn::Store(hn::Add(hn::Load(kNumbers, carry), step), kNumbers, carry);
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
