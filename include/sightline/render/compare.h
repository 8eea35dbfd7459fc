#pragma once

#include <cstdint>

#include "sightline/io/image.h"

namespace sightline {

struct ImageDifference {
  std::uint64_t pixels = 0;  // pixels that differ in any channel; all of the larger image if the sizes differ
  std::uint32_t x = 0, y = 0;  // the first of them, rows from the top; meaningless if pixels is 0
  std::uint8_t largest = 0;    // the largest difference in one channel

  bool equal() const { return pixels == 0; }
};

ImageDifference compareImages(const Image& a, const Image& b);

// A faded copy of `a` with the pixels in which the two differ in red. Empty if the sizes differ.
Image differenceImage(const Image& a, const Image& b);

// Both images beside each other, aligned at the top, with a gap of a few pixels.
Image sideBySide(const Image& left, const Image& right);

}  // namespace sightline
