#include "src/occlusion/need_map.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/need_map.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SIGHTLINE_NEED_MAP_ONCE
#define SIGHTLINE_NEED_MAP_ONCE
namespace sightline::occlusion {
namespace {

// A rectangle of squares, and a bound of depth in the corner of each in which it is nearest: `first` in the
// first square, so much more for each column and each row, and never below `floor`.
struct SquareRows {
  const float* open;
  std::size_t stride, rows, count;
  float first, per_column, per_row, floor;
};

}  // namespace
}  // namespace sightline::occlusion
#endif

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t kSquare = NeedMap::kSize;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A lane for each pixel of a row of a square, or of a part of it.
using Pixels = hn::CappedTag<float, kSquare>;
inline constexpr Pixels kPixels;
// A lane for each square of a row.
using Squares = hn::CappedTag<float, NeedMap::kVector>;
inline constexpr Squares kSquares;

// The least value of the target in a square, from pixel (x, y0) on, in the rows before y1.
HWY_INLINE float leastOf(const DepthTarget& target, std::int32_t x, std::int32_t y0, std::int32_t y1) {
  auto least = hn::Set(kPixels, kInfinite);
  for (std::int32_t part = 0; part < kSquare; part += static_cast<std::int32_t>(hn::Lanes(kPixels))) {
    const float* pixels =
        target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(y0) + x + part;
    auto column = hn::Set(kPixels, kInfinite);
    for (std::int32_t y = y0; y < y1; ++y, pixels += target.stride) {
      column = hn::Min(column, hn::LoadU(kPixels, pixels));
    }
    const auto valid = hn::FirstN(
        kPixels, static_cast<std::size_t>(std::max(static_cast<std::int32_t>(target.width) - x - part, 0)));
    least = hn::IfThenElse(valid, hn::Min(least, column), least);
  }
  return hn::GetLane(hn::MinOfLanes(kPixels, least));
}

// Sets `open`, see NeedMap, in the squares of a row from the first to the last column. What is infinite stays
// so.
void lookAtSquares(const DepthTarget& target, std::int32_t row, std::int32_t first, std::int32_t last,
                   const float* nearest, float* open) {
  const std::int32_t y0 = row * kSquare,
                     y1 = std::min(y0 + kSquare, static_cast<std::int32_t>(target.height));
  for (std::int32_t column = first; column <= last; ++column) {
    if (open[column] < kInfinite) {
      const float least = leastOf(target, column * kSquare, y0, y1);
      open[column] = least < nearest[column] ? std::max(open[column], least) : kInfinite;
    }
  }
}

// The number of squares that are open for what has the bound's values. Rows may be read up to the end of a
// vector.
std::size_t openBehind(const SquareRows& squares) {
  const std::size_t lanes = hn::Lanes(kSquares);
  const auto floor = hn::Set(kSquares, squares.floor), step = hn::Set(kSquares, squares.per_column);
  std::size_t behind = 0;
  for (std::size_t row = 0; row < squares.rows; ++row) {
    const float* open = squares.open + squares.stride * row;
    const auto first = hn::Set(kSquares, squares.first + squares.per_row * static_cast<float>(row));
    for (std::size_t i = 0; i < squares.count; i += lanes) {
      const auto at = hn::Iota(kSquares, static_cast<float>(i));
      const auto depth = hn::Max(hn::Add(hn::Mul(at, step), first), floor);
      const auto valid = hn::FirstN(kSquares, std::min(squares.count - i, lanes));
      behind += hn::CountTrue(kSquares, hn::And(valid, hn::Lt(hn::LoadU(kSquares, open + i), depth)));
    }
  }
  return behind;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(lookAtSquares);
HWY_EXPORT(openBehind);

}  // namespace

void NeedMap::clear(const DepthTarget& target) {
  const auto squares = [](std::uint32_t pixels) {
    return (static_cast<std::int32_t>(pixels) + kSize - 1) / kSize;
  };
  stride_ = squares(target.width) + kVector;
  const std::size_t count = at(squares(target.height));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  farthest_.assign(count, kInfinity);
  nearest_.assign(count, -kInfinity);
  open_.assign(count, kInfinity);
}

void NeedMap::add(const PixelRectangle& rectangle, float nearest) {
  const std::int32_t first = rectangle.x0 / kSize, end = (rectangle.x1 - 1) / kSize + 1;
  for (std::int32_t row = rectangle.y0 / kSize; row * kSize < rectangle.y1; ++row) {
    float *farthest = farthest_.data() + at(row), *near = nearest_.data() + at(row),
          *open = open_.data() + at(row);
    for (std::int32_t column = first; column < end; ++column) {
      farthest[column] = open[column] = std::min(farthest[column], nearest);
      near[column] = std::max(near[column], nearest);
    }
  }
}

void NeedMap::look(const DepthTarget& target, const PixelRectangle& rectangle) {
  const std::int32_t first = rectangle.x0 / kSize, last = (rectangle.x1 - 1) / kSize;
  for (std::int32_t row = rectangle.y0 / kSize; row * kSize < rectangle.y1; ++row) {
    HWY_DYNAMIC_DISPATCH(lookAtSquares)(target, row, first, last, nearestOf(row), open_.data() + at(row));
  }
}

std::uint32_t NeedMap::pixels(const PixelRectangle& rectangle, const DepthBound& depth) const {
  if (rectangle.empty()) {
    return 0;
  }
  // In a square the bound is nearest in a corner.
  constexpr auto kLast = static_cast<float>(kSize - 1), kStep = static_cast<float>(kSize);
  const float corner = std::max(kLast * depth.along_x, 0.0f) + std::max(kLast * depth.along_y, 0.0f);
  const std::int32_t column = rectangle.x0 / kSize, row = rectangle.y0 / kSize;
  const SquareRows squares{.open = open_.data() + at(row) + column,
                           .stride = static_cast<std::size_t>(stride_),
                           .rows = static_cast<std::size_t>((rectangle.y1 - 1) / kSize + 1 - row),
                           .count = static_cast<std::size_t>((rectangle.x1 - 1) / kSize + 1 - column),
                           .first = depth.at_origin + corner +
                                    depth.along_y * (kStep * static_cast<float>(row)) +
                                    depth.along_x * (kStep * static_cast<float>(column)),
                           .per_column = kStep * depth.along_x,
                           .per_row = kStep * depth.along_y,
                           .floor = depth.floor};
  const std::size_t pixels = HWY_DYNAMIC_DISPATCH(openBehind)(squares) * kSize * kSize;
  return static_cast<std::uint32_t>(
      std::min<std::size_t>(pixels, static_cast<std::size_t>(rectangle.area())));
}

}  // namespace sightline::occlusion
#endif
