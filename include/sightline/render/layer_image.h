#pragma once

// Float pictures with opacity and depth, to which layers are drawn and from which they are composited.

#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/io/image.h"
#include "sightline/layers/shaped_image.h"

namespace sightline {

// A picture in linear light, colour multiplied by opacity; rows count from the top.
struct LayerImage {
  std::uint32_t width = 0, height = 0;
  std::vector<ShapedPixel> pixels{};  // width * height
  // For each pixel the metres along the view's forward to its nearest surface, kNoDepth if there is none.
  // Empty if depths were not asked for.
  std::vector<float> depths{};

  static constexpr float kNoDepth = std::numeric_limits<float>::infinity();

  ShapedImage view() const { return {pixels.data(), width, height, width}; }
  ShapedTarget target() { return {pixels.data(), width, height, width}; }
  // Makes the picture transparent, of this size and without depths. Reuses its memory.
  void clear(std::uint32_t new_width, std::uint32_t new_height);
};

// Sets front to front over back, with the nearer one of their depths. If back has no depths (the sky has
// none), front keeps its own; if front has none, it gets none. Precondition: equal sizes.
void compositeOver(LayerImage& front, const LayerImage& back);

// Converts to eight bits for each channel, not premultiplied, with colours as square roots, as Renderer's
// pictures are. (Readers of PNG take that for sRGB, which is close.) NaN becomes 0; values out of range are
// clamped.
Image toImage(const LayerImage& image);

// How much two pictures differ, over all four channels (0 to 255) of what toImage() makes of them. Pictures
// of different sizes differ everywhere by the maximum.
struct PictureDifference {
  double mean = 0.0;  // mean of all channels' absolute differences
  double rms = 0.0;   // root of the mean of their squares
  double largest = 0.0;
  double share_beyond = 0.0;  // share of pixels in which some channel differs by more than `tolerance`
};
PictureDifference measureDifference(const LayerImage& a, const LayerImage& b, double tolerance = 4.0);

}  // namespace sightline
