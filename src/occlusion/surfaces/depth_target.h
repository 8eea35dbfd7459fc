#pragma once

// A depth buffer into which surfaces are drawn, and how far away they are in it.

#include <cstdint>

namespace sightline::occlusion {

// What is drawn into; greater values are nearer.
struct DepthTarget {
  float* reciprocal_depth = nullptr;
  std::uint32_t width = 0, height = 0, stride = 0;  // stride: a multiple of 8, 8 or more above the width
};

// Pixels of a row that may be drawn. Up to seven beyond the width have no meaning.
inline std::int32_t drawnWidth(std::int32_t width) {
  return (width + 7) & ~7;
}

struct PixelRectangle {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // first pixel, and the one after the last
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int32_t area() const { return (x1 - x0) * (y1 - y0); }
};

// A lower bound of the reciprocal depth over pixel (x, y): max(along_x x + along_y y + at_origin, floor).
struct DepthBound {
  float along_x = 0.0f, along_y = 0.0f, at_origin = 0.0f;
  float floor = 0.0f;
};

// Some of a group that is no farther away than `depth` may appear in these pixels.
struct PartDepth {
  PixelRectangle rectangle;
  DepthBound depth;
};

}  // namespace sightline::occlusion
