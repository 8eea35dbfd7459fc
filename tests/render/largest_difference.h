#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sightline/render/layer_image.h"

namespace sightline {

// The largest difference in any channel, opacity included, of two pictures of the same size; 1e9 if a value
// is NaN.
inline double largestDifference(const LayerImage& a, const LayerImage& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
    const ShapedPixel &p = a.pixels[i], &q = b.pixels[i];
    for (const float d : {p.red - q.red, p.green - q.green, p.blue - q.blue, p.alpha - q.alpha}) {
      largest = std::max<double>(largest, std::isfinite(d) ? std::abs(d) : 1e9f);
    }
  }
  return largest;
}

}  // namespace sightline
