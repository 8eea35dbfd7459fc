#include "src/render/lens/blur_area.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sightline::render {

double largestBlur(const LayerImage& image) {
  return static_cast<double>(image.width) + image.height;
}

bool isFinite(const ShapedPixel& pixel) {
  // Zero times a number is zero if the number is finite, else NaN.
  return 0.0f * pixel.red + 0.0f * pixel.green + 0.0f * pixel.blue + 0.0f * pixel.alpha == 0.0f;
}

PixelArea paintedArea(const LayerImage& image) {
  const auto painted = [](const ShapedPixel& pixel) { return pixel != ShapedPixel{} && isFinite(pixel); };
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  PixelArea area{width, height, 0, 0};
  for (int y = 0; y < height; ++y) {
    const std::span row =
        std::span(image.pixels).subspan(static_cast<std::size_t>(y) * image.width, image.width);
    const auto first = std::find_if(row.begin(), row.end(), painted);
    if (first == row.end()) {
      continue;
    }
    const auto last = std::find_if(row.rbegin(), row.rend(), painted);
    area.x0 = std::min(area.x0, static_cast<int>(first - row.begin()));
    area.x1 = std::max(area.x1, static_cast<int>(row.rend() - last));
    area.y0 = std::min(area.y0, y);
    area.y1 = y + 1;
  }
  return area.empty() ? PixelArea{} : area;
}

PixelArea grown(const PixelArea& area, int reach, const LayerImage& image) {
  return {std::max(area.x0 - reach, 0), std::max(area.y0 - reach, 0),
          std::min(area.x1 + reach, static_cast<int>(image.width)),
          std::min(area.y1 + reach, static_cast<int>(image.height))};
}

PixelArea grownBeyondBorders(const PixelArea& area, int reach, const LayerImage& image) {
  PixelArea more = area;
  more.x0 -= area.x0 == 0 ? reach : 0;
  more.y0 -= area.y0 == 0 ? reach : 0;
  more.x1 += area.x1 == static_cast<int>(image.width) ? reach : 0;
  more.y1 += area.y1 == static_cast<int>(image.height) ? reach : 0;
  return more;
}

ShapedPixel pixelAt(const LayerImage& image, int x, int y) {
  const auto column = static_cast<std::size_t>(std::clamp(x, 0, static_cast<int>(image.width) - 1));
  const auto row = static_cast<std::size_t>(std::clamp(y, 0, static_cast<int>(image.height) - 1));
  const ShapedPixel& pixel = image.pixels[row * image.width + column];
  return isFinite(pixel) ? pixel : ShapedPixel{};
}

}  // namespace sightline::render
