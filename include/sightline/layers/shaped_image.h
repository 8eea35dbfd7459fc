#pragma once

// Images with opacity, and what runs a CompositingProgram on them.

#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/result.h"
#include "sightline/layers/compositing.h"

namespace sightline {

// Colour times opacity, and opacity (0 nothing, 1 opaque). Linear light; four floats without padding.
struct ShapedPixel {
  float red = 0.0f, green = 0.0f, blue = 0.0f, alpha = 0.0f;

  friend bool operator==(const ShapedPixel&, const ShapedPixel&) = default;
};
static_assert(sizeof(ShapedPixel) == 4 * sizeof(float));

// Pixels in the caller's memory, width * height, rows from the top.
struct ShapedImage {
  const ShapedPixel* pixels = nullptr;  // none: transparent everywhere, and its size does not matter
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // pixels from one row to the next; at least width
};

struct ShapedTarget {
  ShapedPixel* pixels = nullptr;
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // pixels; what lies between the rows is left as it is
};

// As many pixels of scratch as stay in the nearest cache with what they are combined with.
inline constexpr std::size_t kCompositingScratch = 512;

// Composites the images (one a layer, by number) into target. It goes over the pixels once, a stretch of a
// row at a time with all steps, so that each image is read from memory once however often the program names
// it. scratch: two registers for a stretch, any size from 2 on. Nothing may overlap target. No allocation.
// Colours may be anything finite; one not finite stays in its own pixel. The same bits on every instruction
// set. Safe to call from several threads with different targets (bands of rows, say) and scratch.
// Errors: checkProgram's, fewer images than the program has layers, an image of another size than target, a
// stride below the width, or less than 2 pixels of scratch. Then target is as it was.
Status evaluate(const CompositingProgram& program, std::span<const ShapedImage> images, ShapedTarget target,
                std::span<ShapedPixel> scratch);

// The same bits for one pixel. Precondition: checkProgram().
ShapedPixel evaluatePixel(const CompositingProgram& program, std::span<const ShapedPixel> layers);

}  // namespace sightline
