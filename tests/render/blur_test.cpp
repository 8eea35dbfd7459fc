// Compares the blurs with convolution, pixel by pixel, by kernels made by sampling.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "sightline/render/depth_of_field.h"
#include "tests/render/largest_difference.h"

namespace sightline {
namespace {

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

LayerImage blank(std::uint32_t width, std::uint32_t height) {
  LayerImage image;
  image.clear(width, height);
  return image;
}

ShapedPixel& at(LayerImage& image, std::uint32_t x, std::uint32_t y) {
  return image.pixels[std::size_t{y} * image.width + x];
}
const ShapedPixel& at(const LayerImage& image, std::uint32_t x, std::uint32_t y) {
  return image.pixels[std::size_t{y} * image.width + x];
}

// Random colours in a part of the picture, transparent around it.
LayerImage randomImage(std::uint32_t seed, std::uint32_t width, std::uint32_t height, std::uint32_t margin) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  LayerImage image = blank(width, height);
  for (std::uint32_t y = margin; y + margin < height; ++y) {
    for (std::uint32_t x = margin; x + margin < width; ++x) {
      const float alpha = share(random);
      at(image, x, y) = {alpha * share(random), alpha * share(random), alpha * share(random), alpha};
    }
  }
  return image;
}

struct Sums {
  double color = 0.0, alpha = 0.0, x = 0.0, y = 0.0;  // x, y: of opacity
};
Sums sumsOf(const LayerImage& image) {
  Sums sums;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const ShapedPixel& p = at(image, x, y);
      sums.color += static_cast<double>(p.red) + static_cast<double>(p.green) + static_cast<double>(p.blue);
      sums.alpha += static_cast<double>(p.alpha);
      sums.x += static_cast<double>(p.alpha) * x;
      sums.y += static_cast<double>(p.alpha) * y;
    }
  }
  return sums;
}

// The weight of the pixel at the offset (dx, dy). Beyond the borders the outermost pixels count.
using Kernel = std::function<double(int dx, int dy)>;
LayerImage convolved(const LayerImage& image, int reach, const Kernel& weight) {
  LayerImage result = blank(image.width, image.height);
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<double, 4> sum{};
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const auto& p = at(image, static_cast<std::uint32_t>(std::clamp(x + dx, 0, width - 1)),
                             static_cast<std::uint32_t>(std::clamp(y + dy, 0, height - 1)));
          const double w = weight(dx, dy);
          sum[0] += w * static_cast<double>(p.red);
          sum[1] += w * static_cast<double>(p.green);
          sum[2] += w * static_cast<double>(p.blue);
          sum[3] += w * static_cast<double>(p.alpha);
        }
      }
      at(result, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)) = {
          static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2]),
          static_cast<float>(sum[3])};
    }
  }
  return result;
}

// The disc's kernel by sampling: the chords at many heights of a row are averaged, and what the mean chord
// covers of a pixel is its weight.
Kernel sampledDisc(double diameter) {
  return [diameter](int dx, int dy) {
    constexpr int kSamples = 4000;
    const double r = 0.5 * diameter;
    double half = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const double y = dy - 0.5 + (i + 0.5) / kSamples;
      half += std::sqrt(std::max(r * r - y * y, 0.0)) / kSamples;
    }
    const double covered = std::max(std::min(half, dx + 0.5) - std::max(-half, dx - 0.5), 0.0);
    return covered / (std::numbers::pi * r * r);
  };
}

// A table of the kernel's values, which are needed for every pixel.
Kernel tableOf(const Kernel& kernel, int reach) {
  std::vector<double> table;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      table.push_back(kernel(dx, dy));
    }
  }
  return [table = std::move(table), reach](int dx, int dy) {
    return table[static_cast<std::size_t>((dy + reach) * (2 * reach + 1) + dx + reach)];
  };
}

Kernel sampledLine(double lx, double ly) {
  return [lx, ly](int dx, int dy) {
    constexpr int kSamples = 20000;
    double weight = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const double x = ((i + 0.5) / kSamples - 0.5) * lx, y = ((i + 0.5) / kSamples - 0.5) * ly;
      weight += std::max(1.0 - std::abs(x - dx), 0.0) * std::max(1.0 - std::abs(y - dy), 0.0) / kSamples;
    }
    return weight;
  };
}

// At depth z, with this view and lens, the circle is |z - 1| pixels of a picture 24 high.
View unitView() {
  View view;
  view.orthographic = true;
  view.ortho_height = 24.0;
  return view;
}
constexpr Lens kUnitLens{.focus = 1.0, .aperture = 1.0};
float depthOf(double circle) {
  return static_cast<float>(1.0 + circle);
}

TEST(BlurEvenly, IsConvolutionWithADisc) {
  for (const std::uint32_t margin : {0u, 6u}) {
    const LayerImage image = randomImage(7 + margin, 31, 22, margin);
    for (const double diameter : {1.02, 1.5, 2.0, 3.0, 4.37, 7.0, 9.9}) {
      LayerImage blurred;
      blurEvenly(image, diameter, blurred);
      const int reach = 6;
      const LayerImage expected = convolved(image, reach, tableOf(sampledDisc(diameter), reach));
      EXPECT_LT(largestDifference(blurred, expected), 2e-5)
          << "diameter " << diameter << " margin " << margin;
    }
  }
}

TEST(BlurEvenly, LeavesPicturesUpToOnePixelAsTheyAre) {
  LayerImage image = randomImage(3, 9, 5, 0);
  at(image, 2, 2).red = kFloatNan;
  for (const double diameter : {0.0, 1.0, -3.0, std::numeric_limits<double>::quiet_NaN()}) {
    LayerImage blurred;
    blurEvenly(image, diameter, blurred);
    EXPECT_EQ(blurred.width, 9u);
    EXPECT_TRUE(std::isnan(at(blurred, 2, 2).red));
    EXPECT_EQ(at(blurred, 4, 3), at(image, 4, 3));
  }
}

TEST(BlurEvenly, KeepsColourOpacityAndTheirPlaceAwayFromBorders) {
  const LayerImage image = randomImage(11, 64, 48, 20);
  const Sums before = sumsOf(image);
  for (const double diameter : {1.1, 5.0, 17.3, 30.0, 38.0}) {
    LayerImage blurred;
    blurEvenly(image, diameter, blurred);
    const Sums after = sumsOf(blurred);
    EXPECT_NEAR(after.color, before.color, 1e-5 * before.color) << diameter;
    EXPECT_NEAR(after.alpha, before.alpha, 1e-5 * before.alpha) << diameter;
    EXPECT_NEAR(after.x, before.x, 1e-5 * before.x) << diameter;
    EXPECT_NEAR(after.y, before.y, 1e-5 * before.y) << diameter;
  }
}

TEST(BlurEvenly, ChangesSmoothlyWithTheDiameter) {
  LayerImage image = blank(41, 41);
  at(image, 20, 20) = {1.0f, 1.0f, 1.0f, 1.0f};
  LayerImage last = image;
  for (double diameter = 1.0; diameter < 12.0; diameter += 0.01) {
    LayerImage blurred;
    blurEvenly(image, diameter, blurred);
    // Just above 1 pixel the middle loses 2 / diameter of its weight a unit of diameter.
    EXPECT_LT(largestDifference(blurred, last), 0.025) << diameter;
    last = blurred;
  }
}

// The share of a disc of diameter 1 that lies left of x.
double discLeftOf(double x) {
  const double t = std::clamp(2.0 * x, -1.0, 1.0);
  return 1.0 - (std::acos(t) - t * std::sqrt(1.0 - t * t)) / std::numbers::pi;
}

TEST(BlurEvenly, SpreadsAnEdgeAsADiscDoes) {
  constexpr double kDiameter = 15.5;
  for (const bool turned : {false, true}) {
    LayerImage image = blank(60, 60);
    for (std::uint32_t i = 0; i < 60; ++i) {
      for (std::uint32_t j = 0; j < 30; ++j) {
        (turned ? at(image, i, j) : at(image, j, i)) = {0.5f, 0.25f, 0.0f, 1.0f};
      }
    }
    LayerImage blurred;
    blurEvenly(image, kDiameter, blurred);
    for (std::uint32_t j = 0; j < 60; ++j) {
      const ShapedPixel& p = turned ? at(blurred, 30, j) : at(blurred, j, 30);
      // Of the disc around the pixel's centre, what is left of the edge at 30.
      const double share = discLeftOf((30.0 - (j + 0.5)) / kDiameter);
      EXPECT_NEAR(p.alpha, share, 4e-3) << j;
      EXPECT_NEAR(p.red, 0.5 * share, 2e-3) << j;
    }
  }
}

TEST(BlurEvenly, AnEvenPictureStaysEven) {
  LayerImage image = blank(20, 14);
  std::fill(image.pixels.begin(), image.pixels.end(), ShapedPixel{0.2f, 0.4f, 0.6f, 1.0f});
  for (const double diameter : {2.5, 13.0, 34.0, 1e9, std::numeric_limits<double>::infinity()}) {
    LayerImage blurred;
    blurEvenly(image, diameter, blurred);
    EXPECT_LT(largestDifference(blurred, image), 1e-5) << diameter;
  }
}

TEST(BlurEvenly, PixelsThatAreNotFiniteAreTransparent) {
  LayerImage image = randomImage(5, 24, 18, 5), without = image;
  at(image, 10, 9) = {kFloatNan, 0.0f, 0.0f, 1.0f};
  at(image, 12, 9) = {0.0f, std::numeric_limits<float>::infinity(), 0.0f, 1.0f};
  at(without, 10, 9) = at(without, 12, 9) = {};
  LayerImage blurred, expected;
  blurEvenly(image, 6.0, blurred);
  blurEvenly(without, 6.0, expected);
  EXPECT_EQ(blurred.pixels, expected.pixels);
  blurAlong(image, 6.0, 2.0, blurred);
  blurAlong(without, 6.0, 2.0, expected);
  EXPECT_EQ(blurred.pixels, expected.pixels);
  image.depths.assign(image.pixels.size(), depthOf(4.0));
  without.depths = image.depths;
  blurByDepth(image, unitView(), kUnitLens, Spread::kAsItArrives, blurred);
  blurByDepth(without, unitView(), kUnitLens, Spread::kAsItArrives, expected);
  EXPECT_EQ(blurred.pixels, expected.pixels);
}

TEST(Blurs, TakePicturesWithoutPixelsOrOfOne) {
  for (const auto& [width, height] : {std::pair{0u, 0u}, {0u, 5u}, {1u, 1u}, {1u, 7u}}) {
    LayerImage image = blank(width, height), blurred;
    std::fill(image.pixels.begin(), image.pixels.end(), ShapedPixel{0.5f, 0.5f, 0.5f, 0.5f});
    image.depths.assign(image.pixels.size(), depthOf(3.0));
    blurEvenly(image, 3.0, blurred);
    EXPECT_LT(largestDifference(blurred, image), 1e-6);
    blurAlong(image, 3.0, -1.0, blurred);
    EXPECT_LT(largestDifference(blurred, image), 1e-6);
    blurByDepth(image, unitView(), kUnitLens, Spread::kAsItArrives, blurred);
    EXPECT_LT(largestDifference(blurred, image), 1e-6);
  }
}

TEST(BlurByDepth, AtOneDepthIsTheEvenBlur) {
  for (const std::uint32_t margin : {0u, 8u}) {
    LayerImage image = randomImage(13, 40, 24, margin);
    for (const double diameter : {0.0, 0.7, 3.3, 8.0, 15.2}) {
      image.depths.assign(image.pixels.size(), depthOf(diameter));
      LayerImage blurred, expected;
      blurByDepth(image, unitView(), kUnitLens, Spread::kAsItArrives, blurred);
      blurEvenly(image, static_cast<double>(image.depths[0]) - 1.0, expected);
      EXPECT_LT(largestDifference(blurred, expected), 1e-5) << diameter << " margin " << margin;
    }
  }
}

TEST(BlurByDepth, SpreadsEachPixelOverItsOwnDisc) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> circle(0.0, 9.0);
  LayerImage image = randomImage(19, 36, 24, 7);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.depths.push_back(depthOf(circle(random)));
  }
  // The sum of every pixel's own even blur.
  LayerImage expected = blank(36, 24);
  for (std::uint32_t y = 0; y < 24; ++y) {
    for (std::uint32_t x = 0; x < 36; ++x) {
      LayerImage one = blank(36, 24), spread;
      at(one, x, y) = at(image, x, y);
      if (at(one, x, y) == ShapedPixel{}) {
        continue;
      }
      blurEvenly(one, static_cast<double>(image.depths[std::size_t{y} * 36 + x]) - 1.0, spread);
      for (std::size_t i = 0; i < spread.pixels.size(); ++i) {
        expected.pixels[i].red += spread.pixels[i].red;
        expected.pixels[i].green += spread.pixels[i].green;
        expected.pixels[i].blue += spread.pixels[i].blue;
        expected.pixels[i].alpha += spread.pixels[i].alpha;
      }
    }
  }
  LayerImage blurred;
  blurByDepth(image, unitView(), kUnitLens, Spread::kAsItArrives, blurred);
  EXPECT_LT(largestDifference(blurred, expected), 1e-5);
  EXPECT_NEAR(sumsOf(blurred).color, sumsOf(image).color, 1e-3);

  LayerImage normalised;
  blurByDepth(image, unitView(), kUnitLens, Spread::kNormalised, normalised);
  for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
    const ShapedPixel& e = expected.pixels[i];
    if (e.alpha > 1e-3f) {
      EXPECT_NEAR(normalised.pixels[i].green, e.green / e.alpha, 1e-3);
      EXPECT_NEAR(normalised.pixels[i].alpha, 1.0, 1e-6);
    }
  }
}

TEST(BlurByDepth, LeavesPicturesWithoutDepthsAsTheyAre) {
  const LayerImage image = randomImage(23, 12, 9, 1);
  LayerImage blurred;
  blurByDepth(image, unitView(), kUnitLens, Spread::kNormalised, blurred);
  EXPECT_EQ(blurred.pixels, image.pixels);
}

TEST(BlurAlong, IsConvolutionWithALine) {
  for (const std::uint32_t margin : {0u, 6u}) {
    const LayerImage image = randomImage(29, 28, 24, margin);
    for (const auto& [dx, dy] :
         {std::pair{0.3, 0.0}, {5.0, 0.0}, {0.0, -7.25}, {4.0, 4.0}, {-3.7, 8.1}, {6.0, -2.0}}) {
      LayerImage blurred;
      blurAlong(image, dx, dy, blurred);
      const LayerImage expected = convolved(image, 6, tableOf(sampledLine(dx, dy), 6));
      EXPECT_LT(largestDifference(blurred, expected), 2e-5) << dx << ' ' << dy << " margin " << margin;
    }
  }
}

TEST(BlurAlong, KeepsColourOpacityAndTheirPlaceAwayFromBorders) {
  const LayerImage image = randomImage(31, 64, 48, 20);
  const Sums before = sumsOf(image);
  for (const auto& [dx, dy] : {std::pair{38.0, 1.0}, {-20.0, 31.0}, {0.0, 0.01}}) {
    LayerImage blurred;
    blurAlong(image, dx, dy, blurred);
    const Sums after = sumsOf(blurred);
    EXPECT_NEAR(after.color, before.color, 1e-5 * before.color);
    EXPECT_NEAR(after.alpha, before.alpha, 1e-5 * before.alpha);
    EXPECT_NEAR(after.x, before.x, 1e-5 * before.x);
    EXPECT_NEAR(after.y, before.y, 1e-5 * before.y);
  }
}

TEST(BlurAlong, TakesLinesOfNoUse) {
  const LayerImage image = randomImage(37, 16, 12, 2);
  LayerImage blurred;
  for (const double d : {0.0, std::numeric_limits<double>::infinity(), static_cast<double>(kFloatNan)}) {
    blurAlong(image, d, 0.0, blurred);
    EXPECT_EQ(blurred.pixels, image.pixels);
  }
  blurAlong(image, 1e12, -1e12, blurred);
  for (const ShapedPixel& p : blurred.pixels) {
    EXPECT_TRUE(p.alpha >= 0.0f && p.alpha <= 1.0f);
  }
}

}  // namespace
}  // namespace sightline
