#pragma once

// Which pixels a blur reads and which it writes.

#include "sightline/render/layer_image.h"

namespace sightline::render {

// Pixels from (x0, y0) to before (x1, y1); signed, since it may reach beyond a picture.
struct PixelArea {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

// No blur reaches farther: pixels.
double largestBlur(const LayerImage& image);

// Colour and opacity are finite.
bool isFinite(const ShapedPixel& pixel);

// Around all pixels that are not transparent (those not finite count as such).
PixelArea paintedArea(const LayerImage& image);

// The area grown by `reach` to all sides, cut off at the picture's borders.
PixelArea grown(const PixelArea& area, int reach, const LayerImage& image);

// The area grown by `reach` beyond those borders of the picture that it touches, where the picture goes on.
PixelArea grownBeyondBorders(const PixelArea& area, int reach, const LayerImage& image);

// The pixel at (x, y) or, beyond the borders, the outermost one next to it; transparent where not finite.
ShapedPixel pixelAt(const LayerImage& image, int x, int y);

}  // namespace sightline::render
