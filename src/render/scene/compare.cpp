#include "sightline/render/compare.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace sightline {

ImageDifference compareImages(const Image& a, const Image& b) {
  ImageDifference difference;
  if (a.width != b.width || a.height != b.height) {
    difference.pixels = std::max(std::uint64_t{a.width} * a.height, std::uint64_t{b.width} * b.height);
    difference.largest = 255;
    return difference;
  }
  for (std::size_t p = 0; p < a.rgba.size(); p += 4) {
    if (std::memcmp(&a.rgba[p], &b.rgba[p], 4) == 0) {
      continue;
    }
    if (difference.pixels++ == 0) {
      difference.x = static_cast<std::uint32_t>(p / 4 % a.width);
      difference.y = static_cast<std::uint32_t>(p / 4 / a.width);
    }
    for (std::size_t c = 0; c < 4; ++c) {
      const auto amount = static_cast<std::uint8_t>(std::abs(a.rgba[p + c] - b.rgba[p + c]));
      difference.largest = std::max(difference.largest, amount);
    }
  }
  return difference;
}

Image differenceImage(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    return {};
  }
  Image result = a;
  for (std::size_t p = 0; p < a.rgba.size(); p += 4) {
    if (std::memcmp(&a.rgba[p], &b.rgba[p], 4) != 0) {
      const std::uint8_t red[4] = {220, 0, 0, 255};
      std::copy_n(red, 4, &result.rgba[p]);
    } else {
      for (std::size_t c = 0; c < 3; ++c) {
        result.rgba[p + c] = static_cast<std::uint8_t>(191 + a.rgba[p + c] / 4);
      }
    }
  }
  return result;
}

Image sideBySide(const Image& left, const Image& right) {
  constexpr std::uint32_t kGap = 8;
  Image result{
      .width = left.width + kGap + right.width, .height = std::max(left.height, right.height), .rgba = {}};
  result.rgba.assign(std::size_t{4} * result.width * result.height, 255);
  const auto paste = [&result](const Image& image, std::size_t x) {
    const std::size_t row = std::size_t{4} * image.width;
    for (std::size_t y = 0; y < image.height; ++y) {
      std::copy_n(image.rgba.data() + y * row, row, result.rgba.data() + 4 * (y * result.width + x));
    }
  };
  paste(left, 0);
  paste(right, left.width + kGap);
  return result;
}

}  // namespace sightline
