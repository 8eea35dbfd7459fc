#include "src/occlusion/surfaces/square_depths.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/square_depths.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t kSquare = SquareDepths::kSize;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A lane for each pixel of a row of a square, or of a part of it. Vectors begin at multiples of their length,
// so that they end within the stride.
using Pixels = hn::CappedTag<float, kSquare>;
inline constexpr Pixels kPixels;

// The least value of a rectangle of the target's pixels.
HWY_INLINE float leastOf(const DepthTarget& target, const PixelRectangle& r) {
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(kPixels));
  const auto infinite = hn::Set(kPixels, kInfinite);
  auto least = infinite;
  for (std::int32_t x = r.x0 / lanes * lanes; x < r.x1; x += lanes) {
    const float* pixels =
        target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(r.y0) + x;
    auto column = infinite;
    for (std::int32_t y = r.y0; y < r.y1; ++y, pixels += target.stride) {
      column = hn::Min(column, hn::LoadU(kPixels, pixels));
    }
    const auto before = hn::FirstN(kPixels, static_cast<std::size_t>(std::max(r.x0 - x, 0))),
               to = hn::FirstN(kPixels, static_cast<std::size_t>(std::min(r.x1 - x, lanes)));
    least = hn::IfThenElse(hn::AndNot(before, to), hn::Min(least, column), least);
  }
  return hn::GetLane(hn::MinOfLanes(kPixels, least));
}

// The pixels of the target in a square.
HWY_INLINE PixelRectangle squareAt(const DepthTarget& target, std::int32_t column, std::int32_t row) {
  return {column * kSquare, row * kSquare,
          std::min((column + 1) * kSquare, static_cast<std::int32_t>(target.width)),
          std::min((row + 1) * kSquare, static_cast<std::int32_t>(target.height))};
}

// The least value of a whole square of the target, from this pixel on.
HWY_INLINE float leastOfSquare(const float* pixels, std::size_t stride) {
  auto least = hn::Set(kPixels, kInfinite);
  for (std::int32_t y = 0; y < kSquare; ++y, pixels += stride) {
    for (std::size_t x = 0; x < kSquare; x += hn::Lanes(kPixels)) {
      least = hn::Min(least, hn::LoadU(kPixels, pixels + x));
    }
  }
  return hn::GetLane(hn::MinOfLanes(kPixels, least));
}

void lookAtAll(const DepthTarget& target, float* least, std::int32_t stride) {
  const auto whole_rows = static_cast<std::int32_t>(target.height) / kSquare,
             whole_columns = static_cast<std::int32_t>(target.width) / kSquare;
  for (std::int32_t row = 0; row < squaresIn(target.height); ++row, least += stride) {
    const float* pixels =
        target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(row * kSquare);
    for (std::int32_t column = 0; column < squaresIn(target.width); ++column) {
      least[column] = row < whole_rows && column < whole_columns
                          ? leastOfSquare(pixels + column * kSquare, target.stride)
                          : leastOf(target, squareAt(target, column, row));
    }
  }
}

bool allNearer(const DepthTarget& target, const float* leasts, std::int32_t stride, const PixelRectangle& r,
               float than) {
  for (std::int32_t row = r.y0 / kSquare; row * kSquare < r.y1; ++row) {
    const float* least = leasts + std::ptrdiff_t{stride} * row;
    for (std::int32_t column = r.x0 / kSquare; column * kSquare < r.x1; ++column) {
      if (least[column] > than) {
        continue;
      }
      const PixelRectangle whole = squareAt(target, column, row);
      const PixelRectangle part{std::max(whole.x0, r.x0), std::max(whole.y0, r.y0), std::min(whole.x1, r.x1),
                                std::min(whole.y1, r.y1)};
      if (part.area() == whole.area() || !(leastOf(target, part) > than)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(lookAtAll);
HWY_EXPORT(allNearer);
}  // namespace

void SquareDepths::look(const DepthTarget& target) {
  stride_ = squaresIn(target.width) + kVector;
  least_.resize(at(squaresIn(target.height)));
  HWY_DYNAMIC_DISPATCH(lookAtAll)(target, least_.data(), stride_);
}

void SquareDepths::fill(const DepthTarget& target, float value) {
  stride_ = squaresIn(target.width) + kVector;
  least_.assign(at(squaresIn(target.height)), value);
}

bool SquareDepths::allNearer(const DepthTarget& target, const PixelRectangle& rectangle, float than) const {
  return HWY_DYNAMIC_DISPATCH(allNearer)(target, least_.data(), stride_, rectangle, than);
}

}  // namespace sightline::occlusion
#endif
