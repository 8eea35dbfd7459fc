#pragma once

// A rectangle of a depth buffer's pixels.

#include <cstdint>

#include "sightline/occlusion/depth_pyramid.h"

namespace sightline::occlusion {

// The first and the last pixels of a rectangle.
struct PixelRange {
  std::uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool contains(const BufferPixel& pixel) const {
    return pixel.x >= x0 && pixel.x <= x1 && pixel.y >= y0 && pixel.y <= y1;
  }
  friend bool operator==(const PixelRange&, const PixelRange&) = default;
};

}  // namespace sightline::occlusion
