#pragma once

// A picture's pixels that are not empty, and what they look like moved by a warp.

#include <cstdint>
#include <vector>

#include "sightline/render/layer_image.h"
#include "src/render/reuse/warp.h"

namespace sightline::render {

// Sides of a picture, from the left on clockwise.
enum PictureSide : std::size_t { kLeftSide, kTopSide, kRightSide, kBottomSide, kPictureSides };
using SideFlags = std::array<bool, kPictureSides>;

// A rectangle of pixels.
struct PictureRect {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;  // up to, not with, right and bottom

  bool empty() const { return left >= right || top >= bottom; }
};

// A rectangle of a picture with one more row and column of pixels on each side, whose pixels say what is
// beyond it.
struct Sprite {
  std::int32_t left = -1, top = -1;     // of the picture, where the first pixel of the margin lies
  std::uint32_t width = 0, height = 0;  // with the margin
  std::vector<ShapedPixel> pixels;      // width * height; none: all transparent
};

// What there is in `within` of the picture (which may reach beyond it), cropped to what is not transparent.
// What lies beyond the picture is taken to go on where that side is cut, otherwise to be transparent.
void cropSprite(const LayerImage& picture, const PictureRect& within, const SideFlags& cut, Sprite& sprite);

// The sprite where `picture_from_target` looks it up, by bilinear resampling: a target pixel's centre (x +
// 0.5, y + 0.5) is mapped to the sprite's picture; where its divisor is not positive nothing is. target:
// its width and height are given, all else is written.
void drawWarped(const Sprite& sprite, const Warp& picture_from_target, LayerImage& target);

}  // namespace sightline::render
