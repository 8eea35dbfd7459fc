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

constexpr std::int32_t kLanes = 8;
constexpr double kSteepest = 256.0;  // change of x from row to row that single precision can follow, pixels
constexpr double kBeyond = 0x1p20;   // so far outside the rectangle, in 256ths of a pixel, nothing matters

// Sums up the steps of eight pixels, clears steps and doubts, and sets `covered` to -1 where the winding is
// surely positive, and to 0 elsewhere. winding: that of the pixel before, and then that of the last one.
// Returns whether some pixel is covered.
HWY_INLINE bool sumUp(std::int16_t* steps, std::int16_t* doubts, std::int16_t& winding,
                      std::int16_t* covered) {
#if HWY_TARGET == HWY_SCALAR
  bool some = false;
  for (std::int32_t i = 0; i < kLanes; ++i) {
    winding = static_cast<std::int16_t>(winding + steps[i]);
    covered[i] = winding > doubts[i] ? -1 : 0;
    some = some || covered[i] != 0;
    steps[i] = doubts[i] = 0;
  }
  return some;
#else
  const hn::FixedTag<std::int16_t, kLanes> d;
  auto sum = hn::LoadU(d, steps);
  const auto doubt = hn::LoadU(d, doubts);
  if (hn::AllTrue(d, hn::Eq(hn::Or(sum, doubt), hn::Zero(d)))) {
    hn::StoreU(hn::Set(d, winding > 0 ? -1 : 0), d, covered);
    return winding > 0;
  }
  sum = hn::Add(sum, hn::ShiftLeftLanes<1>(d, sum));
  sum = hn::Add(sum, hn::ShiftLeftLanes<2>(d, sum));
  sum = hn::Add(sum, hn::ShiftLeftLanes<4>(d, sum));
  sum = hn::Add(sum, hn::Set(d, winding));
  winding = hn::ExtractLane(sum, kLanes - 1);
  const auto mask = hn::Gt(sum, doubt);
  hn::StoreU(hn::Zero(d), d, steps);
  hn::StoreU(hn::Zero(d), d, doubts);
  hn::StoreU(hn::VecFromMask(d, mask), d, covered);
  return !hn::AllFalse(d, mask);
#endif
}

// Covers pixels of a row from `first` to `last`, and beyond while the winding is positive, eight at a time.
// depth_of(x, d): the reciprocal depths of the pixels from x on. Returns how many pixels became nearer.
template <typename DepthOf>
HWY_INLINE std::uint32_t resolveRow(std::int16_t* steps, std::int16_t* doubts, float* out, std::int32_t first,
                                    std::int32_t last, std::int32_t end, DepthOf&& depth_of) {
  const hn::CappedTag<float, kLanes> d;
  const hn::RebindToSigned<decltype(d)> d32;
  const hn::Rebind<std::int16_t, decltype(d)> d16;
  std::int16_t winding = 0, covered[kLanes];
  std::size_t nearer = 0;
  for (std::int32_t x = first & ~(kLanes - 1); x < end && (x <= last || winding > 0); x += kLanes) {
    if (!sumUp(steps + x, doubts + x, winding, covered)) {
      continue;
    }
    for (std::int32_t lane = 0; lane < kLanes; lane += static_cast<std::int32_t>(hn::Lanes(d))) {
      const auto mask = hn::MaskFromVec(hn::BitCast(d, hn::PromoteTo(d32, hn::LoadU(d16, covered + lane))));
      const auto old = hn::LoadU(d, out + x + lane);
      const auto depth = depth_of(x + lane, d);
      const auto gained = hn::And(mask, hn::Gt(depth, old));
      nearer += hn::CountTrue(d, gained);
      hn::StoreU(hn::IfThenElse(gained, depth, old), d, out + x + lane);
    }
  }
  return static_cast<std::uint32_t>(nearer);
}

std::uint32_t resolveTiles(const WindingRow& row, const float* far) {
  return resolveRow(row.steps, row.doubts, row.reciprocal_depth, row.first, row.last, row.end,
                    [far](std::int32_t x, auto d) HWY_ATTR {
                      constexpr float kMax = std::numeric_limits<float>::max();
                      return hn::Set(d, far[x / 8] <= kMax ? far[x / 8] : -kMax);
                    });
}

std::uint32_t resolvePlane(const WindingRow& row, const DepthBound& depth, float at_row) {
  return resolveRow(row.steps, row.doubts, row.reciprocal_depth, row.first, row.last, row.end,
                    [&depth, at_row](std::int32_t x, auto d) HWY_ATTR {
                      const auto column = hn::Iota(d, static_cast<float>(x));
                      const auto plane =
                          hn::Add(hn::Mul(column, hn::Set(d, depth.along_x)), hn::Set(d, at_row));
                      return hn::Max(plane, hn::Set(d, depth.floor));
                    });
}

// How the pixels of an edge's rows are changed.
class EdgeRows {
 public:
  EdgeRows(const WindingEdges& target, GridPoint from, GridPoint to, std::int32_t value)
      : target_(target),
        low_(std::min(from.y, to.y)),
        high_(std::max(from.y, to.y)),
        size_(static_cast<std::int16_t>(std::min(std::abs(value), 16384))) {
    const double dx = to.x - from.x, dy = to.y - from.y, inwards = value < 0 ? -1.0 : 1.0;
    constexpr double kPixel = kGridStep;
    step_ = static_cast<std::int16_t>((dy < 0.0) == (value > 0) ? size_ : -size_);
    along_x_ = -dy * inwards * kPixel;
    along_y_ = dx * inwards * kPixel;
    at_origin_ = ((0.5 * kPixel - from.y) * dx - (0.5 * kPixel - from.x) * dy) * inwards;
    margin_ = static_cast<float>(WindingMap::kMargin * (std::abs(dx) + std::abs(dy) + 4.0 * kPixel));
  }

  // begin, last: pixels that the edge may touch, none if last < begin. column: the first pixel whose centre
  // is not to the left of the edge.
  HWY_INLINE void draw(std::int32_t row, std::int32_t begin, std::int32_t last, std::int32_t column) const {
    const hn::CappedTag<float, kLanes> d;
    const hn::RebindToSigned<decltype(d)> d32;
    const hn::Rebind<std::int16_t, decltype(d)> d16;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
    const std::size_t at = std::size_t{target_.stride} * static_cast<std::uint32_t>(row);
    const auto margin = hn::Set(d, margin_);
    const auto along = hn::Set(d, static_cast<float>(along_x_));
    const auto doubt = hn::Set(d32, size_);
    WindingExtent& extent = target_.rows[row];
    // Eight pixels from one base, so that the bits do not depend on the number of lanes.
    for (std::int32_t x = begin; x <= last; x += kLanes) {
      const auto base = hn::Set(d, static_cast<float>(at_origin_ + along_y_ * row + along_x_ * x));
      for (std::int32_t lane = 0; lane < kLanes && x + lane <= last; lane += lanes) {
        // The distance of the pixels' centres to the inner side of the edge, times the edge's length.
        const auto inside = hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(lane)), along), base);
        const auto valid = hn::FirstN(d, static_cast<std::size_t>(last - x - lane + 1));
        const auto some = hn::And(valid, hn::Ge(inside, hn::Neg(margin))),
                   more = hn::And(valid, hn::Le(hn::Abs(inside), margin));
        const auto weight = hn::Add(hn::IfThenElseZero(hn::RebindMask(d32, some), doubt),
                                    hn::IfThenElseZero(hn::RebindMask(d32, more), doubt));
        std::int16_t* doubts = target_.doubts + at + static_cast<std::uint32_t>(x + lane);
        hn::StoreU(hn::SaturatedAdd(hn::LoadU(d16, doubts), hn::DemoteTo(d16, weight)), d16, doubts);
      }
    }
    if (begin <= last) {
      extent.first = std::min(extent.first, begin);
      extent.last = std::max(extent.last, last);
    }
    const double middle = row * kGridStep + 0.5 * kGridStep;
    if (low_ <= middle && middle < high_ && column < target_.rectangle.x1) {
      extent.first = std::min(extent.first, column);
      extent.last = std::max(extent.last, column);
      std::int16_t& at_column = target_.steps[at + static_cast<std::uint32_t>(column)];
      at_column = static_cast<std::int16_t>(at_column + step_);
    }
  }

 private:
  const WindingEdges& target_;
  double low_, high_;
  double along_x_, along_y_, at_origin_;
  float margin_;
  std::int16_t size_, step_;
};

// False: the edge lies above, below or to the right of the rectangle.
HWY_INLINE bool drawEdge(const WindingEdges& target, GridPoint from, GridPoint to, std::int32_t value) {
  constexpr double kPixel = kGridStep, kMargin = WindingMap::kMargin;
  const double low = std::min(from.y, to.y), high = std::max(from.y, to.y);
  const double left = std::min(from.x, to.x) - kMargin, right = std::max(from.x, to.x) + kMargin;
  const PixelRectangle& r = target.rectangle;
  if (high + kMargin < r.y0 * kPixel || low - kMargin >= r.y1 * kPixel || left >= r.x1 * kPixel) {
    return false;
  }
  const double bottom_row = r.y0, top_row = r.y1 - 0.5;
  const auto first_row = static_cast<std::int32_t>(std::max((low - kMargin) * (1.0 / kPixel), bottom_row)),
             last_row = static_cast<std::int32_t>(std::min((high + kMargin) * (1.0 / kPixel), top_row));
  const double dy = to.y - from.y, slope = dy == 0.0 ? 0.0 : (to.x - from.x) / dy;
  const EdgeRows rows(target, from, to, value);

  // Where the edge crosses the lower and upper borders of a row, and its middle, several rows at a time.
  const hn::CappedTag<float, kLanes> d;
  const hn::RebindToSigned<decltype(d)> d32;
  const bool steep = std::abs(slope) <= kSteepest;
  const std::int32_t block = steep ? kLanes : 1;  // rows from one base, whatever the number of lanes
  // A level edge crosses no border.
  const double spread = dy == 0.0 ? 4.0 * kLargestGrid : std::abs(slope) * kMargin + 3.0 * kMargin;
  const auto clampedTo = [&](double x) HWY_ATTR {
    return static_cast<float>(std::clamp(x, r.x0 * kPixel - kBeyond, r.x1 * kPixel + kBeyond));
  };
  const auto lowest = hn::Set(d, clampedTo(left)), highest = hn::Set(d, clampedTo(right));
  const auto reach = hn::Set(d, static_cast<float>(std::min(spread, 2.0 * kBeyond + (r.x1 - r.x0) * kPixel)));
  const auto per_row = hn::Set(d, static_cast<float>(steep ? slope * kPixel : 0.0));
  const auto x0 = hn::Set(d, static_cast<float>(r.x0 * kPixel)),
             x1 = hn::Set(d, static_cast<float>(r.x1 * kPixel));
  const auto pixel = hn::Set(d, 1.0f / kGridStep);
  HWY_ALIGN std::int32_t begins[kLanes], lasts[kLanes], columns[kLanes];
  for (std::int32_t row = first_row; row <= last_row; row += block) {
    const double x = from.x + (row * kPixel - from.y) * slope;
    const auto base = hn::Set(d, clampedTo(x));
    const std::int32_t end = std::min(block, last_row - row + 1);
    for (std::int32_t lane = 0; lane < end; lane += static_cast<std::int32_t>(hn::Lanes(d))) {
      const auto below = hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(lane)), per_row), base);
      const auto above = steep ? hn::Add(below, per_row) : hn::Set(d, clampedTo(x + slope * kPixel));
      const auto from_x = hn::Max(hn::Sub(hn::Min(below, above), reach), lowest),
                 to_x = hn::Min(hn::Add(hn::Max(below, above), reach), highest);
      const auto begin = hn::Floor(hn::Mul(hn::Max(from_x, x0), pixel)),
                 last = hn::Floor(hn::Mul(hn::Min(to_x, hn::Sub(x1, hn::Set(d, 1.0f))), pixel));
      // Where the edge crosses the row's middle, as far as the edge goes. Of a flat edge the places at the
      // borders may be clamped, and what is halfway between them means nothing.
      const auto crossing = steep ? hn::Mul(hn::Add(below, above), hn::Set(d, 0.5f))
                                  : hn::Set(d, clampedTo(x + 0.5 * slope * kPixel));
      const auto middle = hn::Min(hn::Max(crossing, lowest), highest);
      const auto column = hn::Ceil(hn::Sub(hn::Mul(middle, pixel), hn::Set(d, 0.5f)));
      hn::Store(hn::ConvertTo(d32, begin), d32, begins + lane);
      hn::Store(hn::ConvertTo(d32, last), d32, lasts + lane);
      hn::Store(hn::ConvertTo(d32, hn::Max(column, hn::Set(d, static_cast<float>(r.x0)))), d32,
                columns + lane);
    }
    for (std::int32_t i = 0; i < end; ++i) {
      rows.draw(row + i, begins[i], lasts[i], columns[i]);
    }
  }
  return true;
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

// Whether the reciprocal depth of all pixels of a rectangle is greater than `than`.
bool allNearer(const DepthTarget& target, const PixelRectangle& r, float than) {
  const hn::CappedTag<float, kLanes> d;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const auto limit = hn::Set(d, than);
  for (std::int32_t y = r.y0; y < r.y1; ++y) {
    const float* row = target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(y);
    for (std::int32_t x = r.x0; x < r.x1; x += lanes) {
      const auto valid = hn::FirstN(d, static_cast<std::size_t>(r.x1 - x));
      if (!hn::AllFalse(d, hn::And(valid, hn::Not(hn::Gt(hn::LoadU(d, row + x), limit))))) {
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
HWY_EXPORT(resolveTiles);
HWY_EXPORT(resolvePlane);

constexpr std::int32_t kTileWidth = 8, kTileHeight = 4;
constexpr std::uint64_t kLargestSum = 16000;  // of edges' values in a group: windings are single words
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void WindingMap::resize(const DepthTarget& target) {
  target_ = target;
  edges_ = pixels_ = 0;
  const std::size_t pixels = std::size_t{target.stride} * target.height;
  if (steps_.size() != pixels || rows_.size() != target.height) {
    steps_.assign(pixels, 0);
    doubts_.assign(pixels, 0);
    rows_.assign(target.height, {});
    tile_stride_ = target.stride / kTileWidth;
    far_.assign(std::size_t{tile_stride_} * ((target.height + kTileHeight - 1) / kTileHeight), kInfinity);
  }
}

bool WindingMap::hides(const PixelRectangle& rectangle, float nearest) const {
  return HWY_DYNAMIC_DISPATCH(allNearer)(target_, rectangle, nearest);
}

void WindingMap::begin(const PixelRectangle& rectangle) {
  sum_ = 0;
  // Whole groups of eight pixels.
  rectangle_ = {rectangle.x0 & ~7, rectangle.y0, (rectangle.x1 + 7) & ~7, rectangle.y1};
  for (std::int32_t row = rectangle.y0; row < rectangle.y1; ++row) {
    rows_[static_cast<std::size_t>(row)] = {rectangle_.x1, rectangle_.x0 - 1};
  }
}

void WindingMap::addEdges(std::span<const GridPoint> points, std::uint32_t step, std::int32_t value) {
  if (points.size() < 2) {
    return;
  }
  const WindingEdges target{steps_.data(), doubts_.data(), rows_.data(), target_.stride, rectangle_};
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
  const std::int32_t first = r.x0 / kTileWidth, end = (r.x1 - 1) / kTileWidth + 1;
  const float top = depth.along_y < 0.0f ? kTileHeight - 1 : 0.0f,
              right = depth.along_x < 0.0f ? kTileWidth - 1 : 0.0f;
  for (std::int32_t tile_y = r.y0 / kTileHeight; tile_y <= (r.y1 - 1) / kTileHeight; ++tile_y) {
    const float at_row = depth.along_y * (static_cast<float>(tile_y * kTileHeight) + top) +
                         (depth.along_x * right + depth.at_origin);
    HWY_DYNAMIC_DISPATCH(lowerTiles)
    (far_.data() + std::size_t{tile_stride_} * static_cast<std::uint32_t>(tile_y), first, end,
     depth.along_x * kTileWidth, at_row, depth.floor);
  }
}

template <typename ResolveRow>
std::uint32_t WindingMap::resolveRows(ResolveRow&& resolve_row) {
  const bool none = sum_ > kLargestSum;
  std::uint32_t nearer = 0;
  for (std::int32_t y = rectangle_.y0; y < rectangle_.y1; ++y) {
    const WindingExtent& extent = rows_[static_cast<std::size_t>(y)];
    if (extent.first > extent.last) {
      continue;
    }
    pixels_ += static_cast<std::uint32_t>(extent.last - extent.first + 1);
    const std::size_t at = std::size_t{target_.stride} * static_cast<std::uint32_t>(y);
    if (none) {
      std::fill_n(steps_.begin() + static_cast<std::ptrdiff_t>(at), target_.stride, std::int16_t{0});
      std::fill_n(doubts_.begin() + static_cast<std::ptrdiff_t>(at), target_.stride, std::int16_t{0});
      continue;
    }
    nearer +=
        resolve_row(y, WindingRow{steps_.data() + at, doubts_.data() + at, target_.reciprocal_depth + at,
                                  extent.first, extent.last, rectangle_.x1});
  }
  return nearer;
}

std::uint32_t WindingMap::resolve() {
  const std::uint32_t nearer = resolveRows([this](std::int32_t y, const WindingRow& row) {
    return HWY_DYNAMIC_DISPATCH(resolveTiles)(
        row, far_.data() + std::size_t{tile_stride_} * static_cast<std::uint32_t>(y / kTileHeight));
  });
  for (std::int32_t tile_y = rectangle_.y0 / kTileHeight; tile_y <= (rectangle_.y1 - 1) / kTileHeight;
       ++tile_y) {
    const auto row = far_.begin() + static_cast<std::ptrdiff_t>(tile_stride_) * tile_y;
    std::fill(row + rectangle_.x0 / kTileWidth, row + (rectangle_.x1 - 1) / kTileWidth + 1, kInfinity);
  }
  return nearer;
}

std::uint32_t WindingMap::resolve(const DepthBound& depth) {
  return resolveRows([&depth](std::int32_t y, const WindingRow& row) {
    return HWY_DYNAMIC_DISPATCH(resolvePlane)(row, depth,
                                              depth.along_y * static_cast<float>(y) + depth.at_origin);
  });
}

}  // namespace sightline::occlusion
#endif
