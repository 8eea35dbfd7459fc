#pragma once

#include <cstdint>

#include "sightline/io/image.h"

namespace sightline {

struct ImageDifference {
  std::uint64_t pixels = 0;    // that differ in any channel; all of the larger image when the sizes differ
  std::uint32_t x = 0, y = 0;  // the first of them, rows from the top; meaningless when pixels is 0
  std::uint8_t largest = 0;    // largest difference in one channel

  bool equal() const { return pixels == 0; }
};

ImageDifference compareImages(const Image& a, const Image& b);

// Where the two differ in red over a faded copy of a; of equal sizes, otherwise empty.
Image differenceImage(const Image& a, const Image& b);

// One image right of the other, top aligned, with a gap of a few pixels.
Image sideBySide(const Image& left, const Image& right);

}  // namespace sightline
