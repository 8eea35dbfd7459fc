#pragma once

// Crops a picture to the pixels that are not transparent, and resamples them through a warp.

#include <cstdint>
#include <vector>

#include "sightline/render/layer_image.h"
#include "src/render/reuse/warp.h"

namespace sightline::render {

// The sides of a picture, clockwise from the left.
enum PictureSide : std::size_t { kLeftSide, kTopSide, kRightSide, kBottomSide, kPictureSides };
using SideFlags = std::array<bool, kPictureSides>;

// A rectangle of pixels.
struct PictureRect {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;  // up to, not with, right and bottom

  bool empty() const { return left >= right || top >= bottom; }
};

// A rectangle of a picture with a margin of one pixel on each side. The margin holds what lies beyond the
// rectangle.
struct Sprite {
  std::int32_t left = -1, top = -1;     // of the picture, where the first pixel of the margin lies
  std::uint32_t width = 0, height = 0;  // with the margin
  std::vector<ShapedPixel> pixels;      // width * height; none: all transparent
};

// Crops the picture to the pixels within `within` that are not transparent; `within` may reach beyond the
// picture. Beyond a side in `cut` the picture is continued by its outermost pixels; beyond the other sides it
// is transparent.
void cropSprite(const LayerImage& picture, const PictureRect& within, const SideFlags& cut, Sprite& sprite);

// Draws the sprite through a warp, by bilinear resampling: each target pixel's centre (x + 0.5, y + 0.5) is
// mapped to the sprite's picture. Pixels where the warp's divisor is not positive become transparent. target
// has its width and height set; its pixels are overwritten.
void drawWarped(const Sprite& sprite, const Warp& picture_from_target, LayerImage& target);

}  // namespace sightline::render
