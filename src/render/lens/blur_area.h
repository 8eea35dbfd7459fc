#pragma once

// Rectangles of pixels that a blur reads and writes.

#include "sightline/render/layer_image.h"

namespace sightline::render {

// The pixels from (x0, y0) inclusive to (x1, y1) exclusive. Signed, since it may reach beyond a picture.
struct PixelArea {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

// The largest diameter of a blur, in pixels; larger ones are clamped to it.
double largestBlur(const LayerImage& image);

// Whether colour and opacity are finite.
bool isFinite(const ShapedPixel& pixel);

// The bounding rectangle of all pixels that are not transparent. Pixels that are not finite count as
// transparent.
PixelArea paintedArea(const LayerImage& image);

// The area grown by `reach` pixels on all sides and clamped to the picture.
PixelArea grown(const PixelArea& area, int reach, const LayerImage& image);

// The area grown by `reach` pixels beyond those borders of the picture that it touches: blurs continue the
// picture there.
PixelArea grownBeyondBorders(const PixelArea& area, int reach, const LayerImage& image);

// The pixel at (x, y) or, beyond the borders, the nearest one of the picture. Transparent if it is not
// finite.
ShapedPixel pixelAt(const LayerImage& image, int x, int y);

}  // namespace sightline::render
