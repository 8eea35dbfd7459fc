#pragma once

// Point sampling of convex polygons: which pixels have their centres inside.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace sightline::geometry {

// A point in an image, pixels from its lower left corner.
struct PixelPoint {
  double x = 0.0, y = 0.0;
};

// Calls body(y, first, last) for every row of an image of width x height pixels in which the convex polygon
// covers the centres of pixels first to last. A centre on the border belongs to the polygon whose inside is
// on its right or, for horizontal edges, above. Corners may turn in either direction, and lie at most some
// ten thousand pixels outside the image.
template <typename Body>
void forEachCentreSpan(std::span<const PixelPoint> corners, std::uint32_t width, std::uint32_t height,
                       Body&& body) {
  const auto [lowest, highest] = std::minmax_element(
      corners.begin(), corners.end(), [](const PixelPoint& a, const PixelPoint& b) { return a.y < b.y; });
  const double top = std::min(std::ceil(highest->y - 0.5), static_cast<double>(height));
  for (double row = std::max(std::ceil(lowest->y - 0.5), 0.0); row < top; row += 1.0) {
    const double y = row + 0.5;
    double left = static_cast<double>(width) + 1.0, right = -1.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const PixelPoint& a = corners[i];
      const PixelPoint& b = corners[i + 1 < corners.size() ? i + 1 : 0];
      if ((a.y <= y) != (b.y <= y)) {
        const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
    const double first = std::max(std::ceil(left - 0.5), 0.0);
    const double last = std::min(std::ceil(right - 0.5), static_cast<double>(width)) - 1.0;
    if (first <= last) {
      body(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(first),
           static_cast<std::uint32_t>(last));
    }
  }
}

}  // namespace sightline::geometry
