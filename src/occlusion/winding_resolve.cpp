#include "src/occlusion/winding_resolve.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/winding_resolve.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/edge_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

constexpr std::int32_t kWide = kTileWidth, kHigh = kTileHeight;
constexpr float kGain = 1.125f;  // a pixel counts as changed if it becomes nearer by this factor

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

// Sets pixels to a depth where that is nearer. Returns how many of them become nearer by kGain.
template <typename D>
HWY_INLINE std::size_t gainPixels(D d, hn::Mask<D> pixels, hn::Vec<D> depth, float* out) {
  const auto old = hn::LoadU(d, out);
  const auto nearer = hn::And(pixels, hn::Gt(depth, old));
  hn::StoreU(hn::IfThenElse(nearer, depth, old), d, out);
  return hn::CountTrue(d, hn::And(nearer, hn::Gt(depth, hn::Mul(old, hn::Set(d, kGain)))));
}

// depth_of(x, y, d): the reciprocal depths of the pixels from x on in row y, counted from the lowest one of
// the tiles. Returns how many pixels changed.
template <std::int32_t kMostLanes, typename DepthOf>
HWY_INLINE std::uint32_t resolveTilesOf(const CoveredRow& target, std::uint32_t& tiles, DepthOf&& depth_of) {
  const hn::CappedTag<float, kMostLanes> d;
  const hn::RebindToUnsigned<decltype(d)> d32;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const std::uint32_t all_lanes = ~0u >> (kWide - lanes);
  const auto lane_bits = hn::Shl(hn::Set(d32, 1u), hn::Iota(d32, 0u));
  HWY_ALIGN std::int32_t outside[kHigh] = {};
  HWY_ALIGN std::uint32_t covered[kHigh];
  std::size_t nearer = 0;
  bool inside = false;  // some pixel at the right border of the tile before may be
  const CoveredRow row = target;
  for (std::int32_t x = row.extent.first; x < row.end && (x <= row.extent.last || inside); ++x) {
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
    row.stale[x] = true;
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
        nearer += gainPixels(d, mask, depth_of(x * kWide + at, y, d), out + at);
      }
    }
  }
  return static_cast<std::uint32_t>(nearer);
}

// The same of a group that is drawn in runs.
template <std::int32_t kMostLanes, typename DepthOf>
HWY_INLINE std::uint32_t resolveRunsOf(const CoveredRow& target, std::uint32_t& tiles, DepthOf&& depth_of) {
  const TileRowRuns& runs = *target.runs;
  HWY_ALIGN std::int32_t begins[kHigh], ends[kHigh];
  for (std::int32_t lane = 0; lane < kHigh; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
    const auto pixel = hn::Set(kPlaces, 1.0f / kGridStep);
    const auto within = [&](PlacesV v) HWY_ATTR {
      const auto lowest = hn::Set(kPlaces, static_cast<float>(target.first * kWide)),
                 highest = hn::Set(kPlaces, static_cast<float>(std::min(target.end * kWide, target.width)));
      return hn::ConvertTo(kNumbers, hn::Min(hn::Max(hn::Floor(v), lowest), highest));
    };
    const auto after = hn::Mul(hn::Load(kPlaces, runs.after + lane), pixel),
               before = hn::Mul(hn::Load(kPlaces, runs.before + lane), pixel);
    const auto crossed = hn::MaskFromVec(hn::BitCast(kNumbers, hn::Load(kBits, runs.crossed + lane)));
    hn::Store(within(hn::Add(after, hn::Set(kPlaces, 1.0f))), kNumbers, begins + lane);
    hn::Store(hn::IfThenElseZero(crossed, within(before)), kNumbers, ends + lane);
  }
  const hn::CappedTag<float, kMostLanes> d;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  std::size_t nearer = 0;
  std::int32_t first = target.width, end = 0;  // pixels between which the runs lie
  for (std::int32_t y = 0; y < target.rows; ++y) {
    if (begins[y] >= ends[y]) {
      continue;
    }
    first = std::min(first, begins[y]);
    end = std::max(end, ends[y]);
    float* out = target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(y);
    for (std::int32_t x = begins[y] / lanes * lanes; x < ends[y]; x += lanes) {
      const auto to = hn::FirstN(d, static_cast<std::size_t>(std::min(ends[y] - x, lanes))),
                 before = hn::FirstN(d, static_cast<std::size_t>(std::max(begins[y] - x, 0)));
      nearer += gainPixels(d, hn::AndNot(before, to), depth_of(x, y, d), out + x);
    }
  }
  for (std::int32_t x = first / kWide; x * kWide < end; ++x) {
    target.stale[x] = true;
    ++tiles;
  }
  return static_cast<std::uint32_t>(nearer);
}

// Either of them.
template <std::int32_t kMostLanes, typename DepthOf>
HWY_INLINE WindingGain resolveRowOf(const CoveredRow& row, DepthOf&& depth_of) {
  WindingGain gain;
  gain.nearer = row.runs != nullptr ? resolveRunsOf<kMostLanes>(row, gain.tiles, depth_of)
                                    : resolveTilesOf<kMostLanes>(row, gain.tiles, depth_of);
  return gain;
}

WindingGain resolveFarOf(const CoveredRow& row, const FarDepths& depths) {
  return resolveRowOf<FarDepths::kWidth>(row, [&depths](std::int32_t x, std::int32_t y, auto d) HWY_ATTR {
    constexpr float kMax = std::numeric_limits<float>::max();
    const float depth = depths.least[depths.stride * static_cast<std::uint32_t>(y / FarDepths::kHeight) +
                                     static_cast<std::uint32_t>(x / FarDepths::kWidth)];
    return hn::Set(d, depth <= kMax ? depth : -kMax);
  });
}

WindingGain resolvePlaneOf(const CoveredRow& row, const DepthBound& depth, std::int32_t first_row) {
  return resolveRowOf<kWide>(row, [&depth, first_row](std::int32_t x, std::int32_t y, auto d) HWY_ATTR {
    const float at_row = depth.along_y * static_cast<float>(first_row + y) + depth.at_origin;
    const auto column = hn::Add(hn::Set(d, static_cast<float>(x)), hn::Iota(d, 0.0f));
    const auto plane = hn::Add(hn::Mul(column, hn::Set(d, depth.along_x)), hn::Set(d, at_row));
    return hn::Max(plane, hn::Set(d, depth.floor));
  });
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

WindingGain resolveFar(const CoveredRow& row, const FarDepths& depths) {
  return HWY_DYNAMIC_DISPATCH(resolveFarOf)(row, depths);
}

WindingGain resolvePlane(const CoveredRow& row, const DepthBound& depth, std::int32_t first_row) {
  return HWY_DYNAMIC_DISPATCH(resolvePlaneOf)(row, depth, first_row);
}

}  // namespace sightline::occlusion
#endif
