// Where an edge of a boundary crosses the rows of a tile, a vector lane for each row. Included by sources
// that Highway compiles once for each instruction set.

#if defined(SIGHTLINE_OCCLUSION_EDGE_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_OCCLUSION_EDGE_ROWS_INL_H
#undef SIGHTLINE_OCCLUSION_EDGE_ROWS_INL_H
#else
#define SIGHTLINE_OCCLUSION_EDGE_ROWS_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "src/occlusion/surfaces/boundary_edge.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A lane for each row of a tile, or of a part of it.
using Bits = hn::CappedTag<std::uint32_t, kTileHeight>;
using Places = hn::CappedTag<float, kTileHeight>;
using Numbers = hn::RebindToSigned<Bits>;
using BitsV = hn::Vec<Bits>;
using PlacesV = hn::Vec<Places>;
using NumbersV = hn::Vec<Numbers>;
using PlacesM = hn::Mask<Places>;
inline constexpr Bits kBits;
inline constexpr Places kPlaces;
inline constexpr Numbers kNumbers;

// Converts whole numbers from -2^22 to 2^22. hn::ConvertTo() takes three times as many steps, for the sake of
// numbers that do not fit.
HWY_INLINE NumbersV wholeOf(PlacesV v) {
  // Adding this leaves no room for places after the point, so that the last bits are the number.
  const auto large = hn::Set(kPlaces, 0x1.8p23f);
  return hn::Sub(hn::BitCast(kNumbers, hn::Add(v, large)), hn::BitCast(kNumbers, large));
}

// The pixels of a row of a tile from number `from` on.
HWY_INLINE BitsV bitsFrom(NumbersV from) {
  const auto all = hn::Set(kBits, ~0u);
  const auto shift = hn::Max(from, hn::Zero(kNumbers));
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  return hn::Shl(all, hn::BitCast(kBits, shift));  // here a shift by 32 or more leaves no bits
#else
  const auto within = hn::Min(shift, hn::Set(kNumbers, kTileWidth - 1));
  const auto bits = hn::Shl(all, hn::BitCast(kBits, within));
  return hn::IfThenZeroElse(hn::RebindMask(kBits, hn::Gt(from, within)), bits);
#endif
}

// The pixels of a row of a tile from number `first` up to `end`; none if first >= end.
HWY_INLINE BitsV bitsBetween(NumbersV first, NumbersV end) {
  return hn::AndNot(bitsFrom(end), bitsFrom(first));
}

// Where an edge crosses the rows of some tiles. Lengths are in 256ths of a pixel.
class EdgeRows {
 public:
  // rises: to the right of the edge the winding is greater; of a level edge this is a convention.
  // above_inner: of a level edge, the surface lies above it.
  HWY_INLINE EdgeRows(const BoundaryEdge& edge, const EdgeBuffer& buffer, bool rises, bool above_inner)
      : edge_(edge), buffer_(buffer), rises_(rises), above_inner_(above_inner) {}

  // Calls use(tile_row, lane, from, to, touched, crossed, middle, doubt) for groups of lanes of the rows of
  // tiles from `first` to `last` that the edge may touch. from, to: the least and the greatest place that the
  // edge may touch, with its margin. touched, crossed: rows that it may touch, and those whose middle it
  // crosses. middle: where its line crosses the middle; doubt: so near to that it is unknown on which side a
  // pixel's centre is.
  template <typename Use>
  HWY_INLINE void forRows(std::int32_t first, std::int32_t last, Use&& use) const {
    if (edge_.kind == EdgeSlope::kSteep) {
      forSteepRows(first, last, use);
    } else if (edge_.kind == EdgeSlope::kFlat) {
      forFlatRows(first, last, use);
    } else {
      forLevelRows(first, last, use);
    }
  }

 private:
  static constexpr double kPixel = kGridStep, kFar = kLargestGrid;

  // Calls use(tile_row, x). x: where the edge's line crosses the lower border of the tiles.
  template <typename Use>
  HWY_INLINE void forTileRows(std::int32_t first, std::int32_t last, Use&& use) const {
    const std::int32_t origin = edge_.first_row >> kTileHeightShift;
    const std::int32_t end = std::min(last, edge_.last_row >> kTileHeightShift) + 1;
    const double step = kTileHeight * kPixel * edge_.slope;
    for (std::int32_t tile_row = std::max(first, origin); tile_row < end; ++tile_row) {
      use(tile_row, edge_.x + (tile_row - origin) * step);
    }
  }

  template <typename Use>
  HWY_INLINE void forSteepRows(std::int32_t first, std::int32_t last, Use&& use) const {
    const auto step = hn::Set(kPlaces, static_cast<float>(edge_.slope * kPixel));
    const auto doubt = hn::Set(kPlaces, edge_.doubt), end_doubt = hn::Set(kPlaces, edge_.end_doubt);
    forTileRows(first, last, [&](std::int32_t tile_row, double x) HWY_ATTR {
      const auto base = hn::Set(kPlaces, static_cast<float>(BoundaryEdge::within(x, buffer_)));
      forLanes([&](std::int32_t lane) HWY_ATTR {
        const auto row = hn::Iota(kPlaces, static_cast<float>(lane));
        const auto below = hn::Add(hn::Mul(row, step), base), above = hn::Add(below, step);
        const auto middle = hn::Mul(hn::Add(below, above), hn::Set(kPlaces, 0.5f));
        useRows(tile_row, lane, below, above, middle, doubt, end_doubt, use);
      });
    });
  }

  // Places at which a flat edge crosses the borders of rows may be clamped, so its middle is computed by
  // itself.
  template <typename Use>
  HWY_INLINE void forFlatRows(std::int32_t first, std::int32_t last, Use&& use) const {
    const hn::CappedTag<double, kTileHeight> d;
    const hn::Rebind<float, decltype(d)> single;
    HWY_ALIGN float below[kTileHeight], above[kTileHeight], middle[kTileHeight];
    const auto step = hn::Set(d, kPixel * edge_.slope);
    const double least = BoundaryEdge::within(-kFar, buffer_), most = BoundaryEdge::within(kFar, buffer_);
    const auto place = [&](hn::Vec<decltype(d)> v) HWY_ATTR {
      return hn::DemoteTo(single, hn::Min(hn::Max(v, hn::Set(d, least)), hn::Set(d, most)));
    };
    forTileRows(first, last, [&](std::int32_t tile_row, double x) HWY_ATTR {
      for (std::int32_t i = 0; i < kTileHeight; i += static_cast<std::int32_t>(hn::Lanes(d))) {
        const auto at = hn::Add(hn::Set(d, x), hn::Mul(hn::Iota(d, static_cast<double>(i)), step));
        hn::Store(place(at), single, below + i);
        hn::Store(place(hn::Add(at, step)), single, above + i);
        hn::Store(place(hn::Add(at, hn::Mul(hn::Set(d, 0.5), step))), single, middle + i);
      }
      forLanes([&](std::int32_t lane) HWY_ATTR {
        useRows(tile_row, lane, hn::Load(kPlaces, below + lane), hn::Load(kPlaces, above + lane),
                hn::Load(kPlaces, middle + lane), hn::Set(kPlaces, edge_.doubt),
                hn::Set(kPlaces, edge_.end_doubt), use);
      });
    });
  }

  template <typename Use>
  HWY_INLINE void forLevelRows(std::int32_t first, std::int32_t last, Use&& use) const {
    // Heights in a buffer are whole numbers below 2^22, so that single precision is exact.
    const auto at = hn::Set(kPlaces, static_cast<float>(edge_.x)), left = hn::Set(kPlaces, edge_.left);
    const auto before = static_cast<float>(BoundaryEdge::within(-kFar, buffer_)),
               behind = static_cast<float>(BoundaryEdge::within(kFar, buffer_));
    const bool inner_before = above_inner_ == rises_;
    const auto above = hn::Set(kPlaces, inner_before ? before : behind),
               below = hn::Set(kPlaces, inner_before ? behind : before);
    forTileRows(first, last, [&](std::int32_t tile_row, double) HWY_ATTR {
      forLanes([&](std::int32_t lane) HWY_ATTR {
        const auto row = hn::Iota(kPlaces, static_cast<float>(tile_row * kTileHeight + lane) + 0.5f);
        const auto height = hn::Sub(hn::Mul(row, hn::Set(kPlaces, kGridStep)), at);
        const auto middle = hn::IfThenElse(hn::Gt(height, hn::Zero(kPlaces)), above, below);
        const auto near = hn::Le(hn::Abs(height), hn::Set(kPlaces, edge_.end_doubt));
        const auto doubt = hn::IfThenElseZero(near, hn::Set(kPlaces, 2.0f * edge_.reach_right));
        useRows(tile_row, lane, left, left, middle, doubt, doubt, use);
      });
    });
  }

  template <typename Use>
  static HWY_INLINE void forLanes(Use&& use) {
    for (std::int32_t lane = 0; lane < kTileHeight; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
      use(lane);
    }
  }

  template <typename Use>
  HWY_INLINE void useRows(std::int32_t tile_row, std::int32_t lane, PlacesV below, PlacesV above,
                          PlacesV middle, PlacesV doubt, PlacesV end_doubt, Use&& use) const {
    const auto rows = hn::Add(hn::Set(kNumbers, tile_row * kTileHeight + lane), hn::Iota(kNumbers, 0));
    const auto among = [rows](std::int32_t first, std::int32_t end) HWY_ATTR {
      return hn::RebindMask(
          kPlaces, hn::And(hn::Gt(rows, hn::Set(kNumbers, first - 1)), hn::Lt(rows, hn::Set(kNumbers, end))));
    };
    const auto from = hn::Max(hn::Sub(hn::Min(below, above), hn::Set(kPlaces, edge_.reach_left)),
                              hn::Set(kPlaces, edge_.left)),
               to = hn::Min(hn::Add(hn::Max(below, above), hn::Set(kPlaces, edge_.reach_right)),
                            hn::Set(kPlaces, edge_.right));
    const auto in_doubt = hn::IfThenElse(among(edge_.first_whole, edge_.end_whole), doubt, end_doubt);
    use(tile_row, lane, from, to, among(edge_.first_row, edge_.last_row + 1),
        among(edge_.first_crossed, edge_.end_crossed), middle, in_doubt);
  }

  const BoundaryEdge& edge_;
  const EdgeBuffer& buffer_;
  bool rises_, above_inner_;
};

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#endif
