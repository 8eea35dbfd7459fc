#include "src/occlusion/need_map.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/need_map.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t kSquare = NeedMap::kSize;

// A lane for each pixel of a row of a square, or of a part of it.
using Pixels = hn::CappedTag<float, kSquare>;
inline constexpr Pixels kPixels;

// Whether some pixel of the target in a square and a rectangle is not before `nearest`.
HWY_INLINE bool anyBehind(const DepthTarget& target, std::int32_t square_x, const PixelRectangle& r,
                          std::int32_t y0, std::int32_t y1, float nearest) {
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(kPixels));
  for (std::int32_t x = square_x; x < square_x + kSquare; x += lanes) {
    const auto before = hn::FirstN(kPixels, static_cast<std::size_t>(std::clamp(r.x0 - x, 0, lanes))),
               to = hn::FirstN(kPixels, static_cast<std::size_t>(std::clamp(r.x1 - x, 0, lanes)));
    auto least = hn::Set(kPixels, std::numeric_limits<float>::infinity());
    const float* pixels =
        target.reciprocal_depth + std::size_t{target.stride} * static_cast<std::uint32_t>(y0) + x;
    for (std::int32_t y = y0; y < y1; ++y, pixels += target.stride) {
      least = hn::Min(least, hn::LoadU(kPixels, pixels));
    }
    if (!hn::AllFalse(kPixels, hn::And(hn::AndNot(before, to), hn::Lt(least, hn::Set(kPixels, nearest))))) {
      return true;
    }
  }
  return false;
}

bool anyNeeded(const NeedMap& map, const DepthTarget& target, const PixelRectangle& r, float nearest) {
  for (std::int32_t row = r.y0 / kSquare; row * kSquare < r.y1; ++row) {
    const float *farthest = map.farthestOf(row), *nearest_box = map.nearestOf(row);
    const std::int32_t y0 = std::max(row * kSquare, r.y0), y1 = std::min((row + 1) * kSquare, r.y1);
    for (std::int32_t column = r.x0 / kSquare; column * kSquare < r.x1; ++column) {
      if (nearest > farthest[column] && anyBehind(target, column * kSquare, r, y0, y1, nearest_box[column])) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {
HWY_EXPORT(anyNeeded);
}  // namespace

void NeedMap::clear(const DepthTarget& target) {
  const auto squares = [](std::uint32_t pixels) { return (pixels + kSize - 1) / kSize; };
  stride_ = static_cast<std::int32_t>(squares(target.width) + 1);
  const std::size_t count = std::size_t{squares(target.width) + 1} * squares(target.height);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  farthest_.assign(count, kInfinity);
  nearest_.assign(count, -kInfinity);
}

void NeedMap::add(const PixelRectangle& rectangle, float nearest) {
  const std::int32_t first = rectangle.x0 / kSize, end = (rectangle.x1 - 1) / kSize + 1;
  for (std::int32_t row = rectangle.y0 / kSize; row * kSize < rectangle.y1; ++row) {
    float *farthest = farthest_.data() + at(row), *near = nearest_.data() + at(row);
    for (std::int32_t column = first; column < end; ++column) {
      farthest[column] = std::min(farthest[column], nearest);
      near[column] = std::max(near[column], nearest);
    }
  }
}

bool NeedMap::needs(const DepthTarget& target, const PixelRectangle& rectangle, float nearest) const {
  return HWY_DYNAMIC_DISPATCH(anyNeeded)(*this, target, rectangle, nearest);
}

}  // namespace sightline::occlusion
#endif
