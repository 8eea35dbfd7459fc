#include "src/render/reuse/warp_image.h"

#include <algorithm>
#include <cmath>

namespace sightline::render {
namespace {

bool isTransparent(const ShapedPixel& p) {
  return p == ShapedPixel{};
}

// The bounding rectangle of the pixels within `within` that are not transparent.
PictureRect coveredIn(const LayerImage& picture, const PictureRect& within) {
  PictureRect covered{within.right, within.bottom, within.left, within.top};
  for (std::uint32_t y = within.top; y < within.bottom; ++y) {
    const ShapedPixel* row = &picture.pixels[std::size_t{y} * picture.width];
    const ShapedPixel *begin = row + within.left, *end = row + within.right;
    const ShapedPixel* first = std::find_if_not(begin, end, isTransparent);
    if (first == end) {
      continue;
    }
    const ShapedPixel* last = end - 1;
    while (isTransparent(*last)) {
      --last;
    }
    covered.left = std::min(covered.left, static_cast<std::uint32_t>(first - row));
    covered.right = std::max(covered.right, static_cast<std::uint32_t>(last - row) + 1);
    covered.top = std::min(covered.top, y);
    covered.bottom = y + 1;
  }
  return covered;
}

// The pixel at (x, y): beyond sides that are cut the picture's outermost one, beyond the others transparent.
ShapedPixel pixelBeyond(const LayerImage& picture, const SideFlags& cut, std::int64_t x, std::int64_t y) {
  const std::int64_t right = std::int64_t{picture.width} - 1, bottom = std::int64_t{picture.height} - 1;
  if ((x < 0 && !cut[kLeftSide]) || (x > right && !cut[kRightSide]) || (y < 0 && !cut[kTopSide]) ||
      (y > bottom && !cut[kBottomSide])) {
    return {};
  }
  const auto column = static_cast<std::size_t>(std::clamp<std::int64_t>(x, 0, right));
  const auto row = static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, bottom));
  return picture.pixels[row * picture.width + column];
}

ShapedPixel mix(const ShapedPixel& a, const ShapedPixel& b, float t) {
  const float s = 1.0f - t;
  return {a.red * s + b.red * t, a.green * s + b.green * t, a.blue * s + b.blue * t,
          a.alpha * s + b.alpha * t};
}

// Samples the sprite in coordinates in which its pixel (i, j) has its centre at (i, j).
ShapedPixel bilinear(const Sprite& sprite, double x, double y) {
  // The comparisons are also false for NaN.
  if (!(x >= 0.0 && y >= 0.0 && x <= sprite.width - 1.0 && y <= sprite.height - 1.0)) {
    return {};
  }
  const std::size_t i = std::min(static_cast<std::size_t>(x), std::size_t{sprite.width} - 2);
  const std::size_t j = std::min(static_cast<std::size_t>(y), std::size_t{sprite.height} - 2);
  const ShapedPixel* upper = &sprite.pixels[j * sprite.width + i];
  const ShapedPixel* lower = upper + sprite.width;
  const auto tx = static_cast<float>(x - static_cast<double>(i));
  const auto ty = static_cast<float>(y - static_cast<double>(j));
  return mix(mix(upper[0], upper[1], tx), mix(lower[0], lower[1], tx), ty);
}

// The pixels of the target that the sprite may touch: all of them if the warp is not defined all over the
// sprite.
PictureRect touchedBy(const Sprite& sprite, const Warp& picture_from_target, const LayerImage& target) {
  const PictureRect all{0, 0, target.width, target.height};
  const std::optional<Warp> target_from_picture = inverseOf(picture_from_target);
  if (!target_from_picture) {
    return all;
  }
  double left = 1e300, top = 1e300, right = -1e300, bottom = -1e300;
  for (const std::uint32_t corner : {0u, 1u, 2u, 3u}) {
    const PicturePoint at{sprite.left + (corner & 1u ? static_cast<double>(sprite.width) : 0.0),
                          sprite.top + (corner & 2u ? static_cast<double>(sprite.height) : 0.0)};
    const PicturePoint p = (*target_from_picture)(at);
    if (!(target_from_picture->divisor(at) > 0.0) || !std::isfinite(p.x) || !std::isfinite(p.y)) {
      return all;
    }
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const auto clamped = [](double v, std::uint32_t end) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.0, static_cast<double>(end)));
  };
  return {clamped(std::floor(left) - 1.0, all.right), clamped(std::floor(top) - 1.0, all.bottom),
          clamped(std::ceil(right) + 1.0, all.right), clamped(std::ceil(bottom) + 1.0, all.bottom)};
}

}  // namespace

void cropSprite(const LayerImage& picture, const PictureRect& within, const SideFlags& cut, Sprite& sprite) {
  const PictureRect inside{within.left, within.top, std::min(within.right, picture.width),
                           std::min(within.bottom, picture.height)};
  const PictureRect covered = inside.empty() ? PictureRect{} : coveredIn(picture, inside);
  sprite = {};
  if (covered.empty()) {
    return;
  }
  sprite.left = static_cast<std::int32_t>(covered.left) - 1;
  sprite.top = static_cast<std::int32_t>(covered.top) - 1;
  sprite.width = covered.right - covered.left + 2;
  sprite.height = covered.bottom - covered.top + 2;
  sprite.pixels.reserve(std::size_t{sprite.width} * sprite.height);
  for (std::uint32_t j = 0; j < sprite.height; ++j) {
    for (std::uint32_t i = 0; i < sprite.width; ++i) {
      sprite.pixels.push_back(
          pixelBeyond(picture, cut, std::int64_t{sprite.left} + i, std::int64_t{sprite.top} + j));
    }
  }
}

void drawWarped(const Sprite& sprite, const Warp& picture_from_target, LayerImage& target) {
  target.clear(target.width, target.height);
  if (sprite.pixels.empty()) {
    return;
  }
  const PictureRect touched = touchedBy(sprite, picture_from_target, target);
  for (std::uint32_t y = touched.top; y < touched.bottom; ++y) {
    for (std::uint32_t x = touched.left; x < touched.right; ++x) {
      const PicturePoint centre{x + 0.5, y + 0.5};
      if (picture_from_target.divisor(centre) > 0.0) {
        const PicturePoint at = picture_from_target(centre);
        target.pixels[std::size_t{y} * target.width + x] =
            bilinear(sprite, at.x - 0.5 - sprite.left, at.y - 0.5 - sprite.top);
      }
    }
  }
}

}  // namespace sightline::render
