#pragma once

// Images with opacity, and the functions that run a CompositingProgram on them.

#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/result.h"
#include "sightline/layers/compositing.h"

namespace sightline {

// A premultiplied pixel in linear light: colour times opacity, and opacity from 0 (transparent) to 1
// (opaque).
struct ShapedPixel {
  float red = 0.0f, green = 0.0f, blue = 0.0f, alpha = 0.0f;

  friend bool operator==(const ShapedPixel&, const ShapedPixel&) = default;
};
static_assert(sizeof(ShapedPixel) == 4 * sizeof(float));

// A view of width * height pixels in the caller's memory, rows from the top.
struct ShapedImage {
  const ShapedPixel* pixels = nullptr;  // null: transparent everywhere; the size is then ignored
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // pixels from one row to the next; at least width
};

// A view of width * height writable pixels in the caller's memory, rows from the top.
struct ShapedTarget {
  ShapedPixel* pixels = nullptr;
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // pixels from one row to the next; pixels between the rows are not written
};

// A good size of scratch, in pixels: small enough to stay in the L1 cache together with the images' pixels.
inline constexpr std::size_t kCompositingScratch = 512;

// Composites the images, one per layer, into target, which nothing else may overlap. All steps are run on one
// stretch of a row after the other, so each image is read from memory once. Does not allocate. Colours may
// have any finite value; a value that is not finite affects its own pixel only. The result has the same bits
// on every instruction set.
// scratch: at least 2 pixels, which hold two registers for a stretch.
// Errors: those of checkProgram(), fewer images than layers, an image of another size than target, a stride
// below the width, or too little scratch. target is then unchanged.
// Thread safety: several threads may call this with different targets (bands of rows, say) and scratch.
Result<void> evaluate(const CompositingProgram& program, std::span<const ShapedImage> images,
                      ShapedTarget target, std::span<ShapedPixel> scratch);

// Composites one pixel, with the same bits as evaluate(). layers: one pixel per layer. Precondition: the
// program passes checkProgram().
ShapedPixel evaluatePixel(const CompositingProgram& program, std::span<const ShapedPixel> layers);

}  // namespace sightline
