#include "src/occlusion/surfaces/need_map.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/need_map.cpp"
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

constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A lane for each square of a row.
using Squares = hn::CappedTag<float, SquareDepths::kVector>;
inline constexpr Squares kSquares;

// Sets `open`, see NeedMap, in so many squares of a row, up to the end of a vector. What is infinite stays
// so.
void lookAtRow(const float* least, const float* nearest, std::size_t count, float* open) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(kSquares)) {
    const auto farthest_pixel = hn::LoadU(kSquares, least + i);
    const auto hides_all = hn::Ge(farthest_pixel, hn::LoadU(kSquares, nearest + i));
    hn::StoreU(hn::IfThenElse(hides_all, hn::Set(kSquares, kInfinite),
                              hn::Max(hn::LoadU(kSquares, open + i), farthest_pixel)),
               kSquares, open + i);
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
HWY_EXPORT(lookAtRow);
HWY_EXPORT(openBehind);

constexpr std::int32_t kSquare = SquareDepths::kSize;

}  // namespace

void NeedMap::clear(const DepthTarget& target) {
  columns_ = squaresIn(target.width);
  rows_ = squaresIn(target.height);
  stride_ = columns_ + SquareDepths::kVector;
  const std::size_t count = at(rows_);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  farthest_.assign(count, kInfinity);
  nearest_.assign(count, -kInfinity);
  open_.assign(count, kInfinity);
}

void NeedMap::add(const PixelRectangle& rectangle, float nearest) {
  const std::int32_t first = rectangle.x0 / kSquare, end = (rectangle.x1 - 1) / kSquare + 1;
  for (std::int32_t row = rectangle.y0 / kSquare; row * kSquare < rectangle.y1; ++row) {
    float *farthest = farthest_.data() + at(row), *near = nearest_.data() + at(row),
          *open = open_.data() + at(row);
    for (std::int32_t column = first; column < end; ++column) {
      farthest[column] = open[column] = std::min(farthest[column], nearest);
      near[column] = std::max(near[column], nearest);
    }
  }
}

void NeedMap::look(const SquareDepths& target) {
  look(target, {0, 0, columns_ * kSquare, rows_ * kSquare});
}

void NeedMap::look(const SquareDepths& target, const PixelRectangle& where) {
  const std::int32_t first = where.x0 / kSquare, end_row = (where.y1 - 1) / kSquare + 1;
  const auto columns = static_cast<std::size_t>((where.x1 - 1) / kSquare + 1 - first);
  for (std::int32_t row = where.y0 / kSquare; row < end_row && !where.empty(); ++row) {
    HWY_DYNAMIC_DISPATCH(lookAtRow)
    (target.ofRow(row) + first, nearestOf(row) + first, columns, open_.data() + at(row) + first);
  }
}

std::uint32_t NeedMap::pixels(const PixelRectangle& rectangle, const DepthBound& depth) const {
  if (rectangle.empty()) {
    return 0;
  }
  // In a square the bound is nearest in a corner.
  constexpr auto kLast = static_cast<float>(kSquare - 1), kStep = static_cast<float>(kSquare);
  const float corner = std::max(kLast * depth.along_x, 0.0f) + std::max(kLast * depth.along_y, 0.0f);
  const std::int32_t column = rectangle.x0 / kSquare, row = rectangle.y0 / kSquare;
  const SquareRows squares{.open = open_.data() + at(row) + column,
                           .stride = static_cast<std::size_t>(stride_),
                           .rows = static_cast<std::size_t>((rectangle.y1 - 1) / kSquare + 1 - row),
                           .count = static_cast<std::size_t>((rectangle.x1 - 1) / kSquare + 1 - column),
                           .first = depth.at_origin + corner +
                                    depth.along_y * (kStep * static_cast<float>(row)) +
                                    depth.along_x * (kStep * static_cast<float>(column)),
                           .per_column = kStep * depth.along_x,
                           .per_row = kStep * depth.along_y,
                           .floor = depth.floor};
  const std::size_t pixels = HWY_DYNAMIC_DISPATCH(openBehind)(squares) * kSquare * kSquare;
  return static_cast<std::uint32_t>(
      std::min<std::size_t>(pixels, static_cast<std::size_t>(rectangle.area())));
}

}  // namespace sightline::occlusion
#endif
