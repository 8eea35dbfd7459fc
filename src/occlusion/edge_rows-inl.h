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

#include "src/occlusion/boundary_edge.h"

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

// Where an edge crosses the rows of some tiles. Lengths are in 256ths of a pixel.
class EdgeRows {
 public:
  // end_x: the right border of the buffer. rises: to the right of the edge the winding is greater; of a level
  // edge this is a convention. above_inner: of a level edge, the surface lies above it.
  HWY_INLINE EdgeRows(const BoundaryEdge& edge, double end_x, bool rises, bool above_inner)
      : edge_(edge), end_x_(end_x), rises_(rises), above_inner_(above_inner) {}

  // Calls use(tile_row, x) for the rows of tiles from `first` to `last` that the edge may touch. x: where its
  // line crosses their lower border.
  template <typename Use>
  HWY_INLINE void forTileRows(std::int32_t first, std::int32_t last, Use&& use) const {
    const std::int32_t origin = edge_.first_row >> kTileHeightShift;
    const std::int32_t end = std::min(last, edge_.last_row >> kTileHeightShift) + 1;
    const double step = kTileHeight * kPixel * edge_.slope;
    for (std::int32_t tile_row = std::max(first, origin); tile_row < end; ++tile_row) {
      use(tile_row, edge_.x + (tile_row - origin) * step);
    }
  }

  // Calls use(lane, from, to, touched, crossed, middle, doubt) for groups of lanes of the tiles' rows.
  // from, to: the least and the greatest place that the edge may touch, with its margin. touched, crossed:
  // rows that it may touch, and those whose middle it crosses. middle: where its line crosses the middle;
  // doubt: so near to that it is unknown on which side a pixel's centre is.
  template <typename Use>
  HWY_INLINE void forRows(std::int32_t tile_row, double x, Use&& use) const {
    if (edge_.kind == EdgeSlope::kSteep) {
      const auto step = hn::Set(kPlaces, static_cast<float>(edge_.slope * kPixel));
      const auto base = hn::Set(kPlaces, place(x)), doubt = hn::Set(kPlaces, edge_.doubt);
      forLanes([&](std::int32_t lane) HWY_ATTR {
        const auto row = hn::Add(hn::Set(kPlaces, static_cast<float>(lane)), hn::Iota(kPlaces, 0.0f));
        const auto below = hn::Add(hn::Mul(row, step), base), above = hn::Add(below, step);
        const auto middle = hn::Mul(hn::Add(below, above), hn::Set(kPlaces, 0.5f));
        useRows(tile_row, lane, below, above, middle, doubt, use);
      });
      return;
    }
    HWY_ALIGN float below[kTileHeight], above[kTileHeight], middle[kTileHeight], doubt[kTileHeight];
    for (std::int32_t i = 0; i < kTileHeight; ++i) {
      if (edge_.kind == EdgeSlope::kLevel) {
        constexpr double kFar = 2.0 * kLargestGrid;
        const double height = (tile_row * kTileHeight + i + 0.5) * kPixel - edge_.x;
        const bool inner = (height > 0.0) == above_inner_;
        below[i] = above[i] = edge_.left;
        middle[i] = place(inner == rises_ ? -kFar : kFar);
        doubt[i] = std::abs(height) <= edge_.doubt ? 2.0f * edge_.reach : 0.0f;
      } else {
        // Places at which a flat edge crosses the borders may be clamped, so its middle is computed by
        // itself.
        const double step = kPixel * edge_.slope, at = x + i * step;
        below[i] = place(at);
        above[i] = place(at + step);
        middle[i] = place(at + 0.5 * step);
        doubt[i] = edge_.doubt;
      }
    }
    forLanes([&](std::int32_t lane) HWY_ATTR {
      useRows(tile_row, lane, hn::Load(kPlaces, below + lane), hn::Load(kPlaces, above + lane),
              hn::Load(kPlaces, middle + lane), hn::Load(kPlaces, doubt + lane), use);
    });
  }

 private:
  static constexpr double kPixel = kGridStep;

  float place(double x) const {
    constexpr double kBeyond = BoundaryEdge::kBeyond;
    return static_cast<float>(std::min(std::max(x, -kBeyond), end_x_ + kBeyond));
  }

  template <typename Use>
  static HWY_INLINE void forLanes(Use&& use) {
    for (std::int32_t lane = 0; lane < kTileHeight; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
      use(lane);
    }
  }

  template <typename Use>
  HWY_INLINE void useRows(std::int32_t tile_row, std::int32_t lane, PlacesV below, PlacesV above,
                          PlacesV middle, PlacesV doubt, Use&& use) const {
    const auto rows = hn::Add(hn::Set(kNumbers, tile_row * kTileHeight + lane), hn::Iota(kNumbers, 0));
    const auto among = [rows](std::int32_t first, std::int32_t end) HWY_ATTR {
      return hn::RebindMask(
          kPlaces, hn::And(hn::Gt(rows, hn::Set(kNumbers, first - 1)), hn::Lt(rows, hn::Set(kNumbers, end))));
    };
    const auto reach = hn::Set(kPlaces, edge_.reach);
    const auto from = hn::Max(hn::Sub(hn::Min(below, above), reach), hn::Set(kPlaces, edge_.left)),
               to = hn::Min(hn::Add(hn::Max(below, above), reach), hn::Set(kPlaces, edge_.right));
    use(lane, from, to, among(edge_.first_row, edge_.last_row + 1),
        among(edge_.first_crossed, edge_.end_crossed), middle, doubt);
  }

  const BoundaryEdge& edge_;
  double end_x_;
  bool rises_, above_inner_;
};

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#endif
