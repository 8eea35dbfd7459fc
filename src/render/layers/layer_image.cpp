#include "sightline/render/layer_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sightline {

namespace {

// Maps 0...1 to 0...255, clamped; NaN becomes 0.
std::uint8_t toByte(float value) {
  return value > 0.0f ? static_cast<std::uint8_t>(std::lround(std::min(value, 1.0f) * 255.0f))
                      : std::uint8_t{0};
}

std::uint8_t colorByte(float premultiplied, float alpha) {
  const float linear = alpha > 0.0f ? premultiplied / alpha : 0.0f;
  return linear > 0.0f ? toByte(std::sqrt(linear)) : std::uint8_t{0};
}

}  // namespace

void LayerImage::clear(std::uint32_t new_width, std::uint32_t new_height) {
  width = new_width;
  height = new_height;
  pixels.assign(std::size_t{width} * height, ShapedPixel{});
  depths.clear();
}

void compositeOver(LayerImage& front, const LayerImage& back) {
  for (std::size_t i = 0; i < front.pixels.size(); ++i) {
    ShapedPixel& f = front.pixels[i];
    const ShapedPixel& b = back.pixels[i];
    const float through = 1.0f - f.alpha;
    f = {f.red + b.red * through, f.green + b.green * through, f.blue + b.blue * through,
         f.alpha + b.alpha * through};
  }
  if (back.depths.size() == front.depths.size()) {
    for (std::size_t i = 0; i < front.depths.size(); ++i) {
      front.depths[i] = std::min(front.depths[i], back.depths[i]);
    }
  }
}

Image toImage(const LayerImage& image) {
  Image result{.width = image.width, .height = image.height, .rgba = {}};
  result.rgba.reserve(4 * image.pixels.size());
  for (const ShapedPixel& p : image.pixels) {
    for (const float color : {p.red, p.green, p.blue}) {
      result.rgba.push_back(colorByte(color, p.alpha));
    }
    result.rgba.push_back(toByte(p.alpha));
  }
  return result;
}

PictureDifference measureDifference(const LayerImage& a, const LayerImage& b, double tolerance) {
  PictureDifference difference;
  if (a.width != b.width || a.height != b.height) {
    return {.mean = 255.0, .rms = 255.0, .largest = 255.0, .share_beyond = 1.0};
  }
  const Image first = toImage(a), second = toImage(b);
  if (first.rgba.empty()) {
    return difference;
  }
  double sum = 0.0, squares = 0.0;
  std::size_t beyond = 0;
  for (std::size_t p = 0; p < first.rgba.size(); p += 4) {
    double worst = 0.0;
    for (std::size_t c = p; c < p + 4; ++c) {
      const double amount = std::abs(int{first.rgba[c]} - int{second.rgba[c]});
      sum += amount;
      squares += amount * amount;
      worst = std::max(worst, amount);
    }
    difference.largest = std::max(difference.largest, worst);
    beyond += worst > tolerance ? 1 : 0;
  }
  const std::size_t pixels = first.rgba.size() / 4;
  const auto channels = static_cast<double>(first.rgba.size());
  difference.mean = sum / channels;
  difference.rms = std::sqrt(squares / channels);
  difference.share_beyond = static_cast<double>(beyond) / static_cast<double>(pixels);
  return difference;
}

}  // namespace sightline
