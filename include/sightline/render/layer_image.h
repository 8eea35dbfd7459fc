#pragma once

// Float pictures with opacity and depth: what layers are drawn to and composited from.

#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/io/image.h"
#include "sightline/layers/shaped_image.h"

namespace sightline {

// Linear light, colour times opacity, rows from the top.
struct LayerImage {
  std::uint32_t width = 0, height = 0;
  std::vector<ShapedPixel> pixels{};  // width * height
  // Metres along the view's forward to the nearest surface of the pixel; kNoDepth where there is none. As
  // many as pixels, or none where depth was not asked for.
  std::vector<float> depths{};

  static constexpr float kNoDepth = std::numeric_limits<float>::infinity();

  ShapedImage view() const { return {pixels.data(), width, height, width}; }
  ShapedTarget target() { return {pixels.data(), width, height, width}; }
  // Transparent, of this size, without depths; keeps its memory.
  void clear(std::uint32_t new_width, std::uint32_t new_height);
};

// front = front over back; its depths are the nearer ones. Where back has no depths (as the sky), front's
// stay as they are; where front has none, there are none. Precondition: equal sizes.
void compositeOver(LayerImage& front, const LayerImage& back);

// Eight bits a channel, not premultiplied, colours as square roots, as Renderer's pictures are. (A PNG's
// readers take that for sRGB, which is near.) What is no number counts as 0; what is out of range is clamped.
Image toImage(const LayerImage& image);

// The stated measure of two pictures: of all four channels of what toImage() makes of them (0 to 255).
// Pictures of different sizes differ everywhere and as much as can be.
struct PictureDifference {
  double mean = 0.0;  // of all channels' absolute differences
  double rms = 0.0;   // root of the mean square
  double largest = 0.0;
  double share_beyond = 0.0;  // of pixels in which some channel differs by more than `tolerance`
};
PictureDifference measureDifference(const LayerImage& a, const LayerImage& b, double tolerance = 4.0);

}  // namespace sightline
