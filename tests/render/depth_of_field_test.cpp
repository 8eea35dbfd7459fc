// Circles of confusion, the lens's points, and the equations for two layers of the paper's section 10.

#include "sightline/render/depth_of_field.h"
#include "tests/support/not_finite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sightline {
namespace {

using test::kInfinity;
using test::kNan;

View lookingAlong() {
  View view;
  setOrientation(view, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0});
  view.tan_half_fovy = 0.4;
  return view;
}

TEST(CircleOfConfusion, IsWhatTheLensSpreadsAPointTo) {
  const View view = lookingAlong();
  const Lens lens{.focus = 8.0, .aperture = 0.3};
  for (const double depth : {0.5, 3.0, 7.9, 8.0, 20.0, 1e6}) {
    // Rays from the lens's two ends through the point, on the plane of focus; there the picture is so high.
    const double top = 0.15 + (0.0 - 0.15) * lens.focus / depth;
    const double bottom = -top;
    const double picture_height = 2.0 * lens.focus * view.tan_half_fovy;
    const double expected = std::abs(top - bottom) / picture_height * 600.0;
    EXPECT_NEAR(circleOfConfusion(view, lens, depth, 600), expected, 1e-9 * (1.0 + expected)) << depth;
  }
  EXPECT_EQ(circleOfConfusion(view, lens, 8.0, 600), 0.0);
  EXPECT_NEAR(circleOfConfusion(view, lens, kInfinity, 600), 0.3 / (2.0 * 8.0 * 0.4) * 600.0, 1e-9);
}

TEST(CircleOfConfusion, OfParallelRaysGrowsWithTheDistanceFromTheFocus) {
  View view = lookingAlong();
  view.orthographic = true;
  view.ortho_height = 12.0;
  const Lens lens{.focus = 5.0, .aperture = 0.5};
  EXPECT_EQ(circleOfConfusion(view, lens, 5.0, 240), 0.0);
  // Directions that differ by 0.5 / 5 move a point 10 behind the focus by 1 metre of 12.
  EXPECT_NEAR(circleOfConfusion(view, lens, 15.0, 240), 20.0, 1e-9);
  EXPECT_NEAR(circleOfConfusion(view, lens, -5.0, 240), 20.0, 1e-9);
  EXPECT_EQ(circleOfConfusion(view, lens, kInfinity, 240), kInfinity);
}

TEST(CircleOfConfusion, OfAPinholeOrOfNoDepthIsNone) {
  const View view = lookingAlong();
  EXPECT_EQ(circleOfConfusion(view, {.focus = 5.0, .aperture = 0.0}, 2.0, 480), 0.0);
  EXPECT_EQ(circleOfConfusion(view, {.focus = 5.0, .aperture = kNan}, 2.0, 480), 0.0);
  EXPECT_EQ(circleOfConfusion(view, {.focus = 5.0, .aperture = -1.0}, 2.0, 480), 0.0);
  EXPECT_EQ(circleOfConfusion(view, {.focus = kNan, .aperture = 0.1}, 2.0, 480), 0.0);
  EXPECT_EQ(circleOfConfusion(view, {.focus = 0.0, .aperture = 0.1}, 2.0, 480), 0.0);
  for (const double depth : {0.0, -1.0, kNan}) {
    EXPECT_EQ(circleOfConfusion(view, {}, depth, 480), 0.0);
  }
}

TEST(DiscPoints, AreSymmetricInsideTheDiscAndEvenlySpread) {
  EXPECT_TRUE(discPoints(0).empty());
  for (const std::uint32_t count : {1u, 2u, 3u, 8u, 21u, 23u, 64u, 257u}) {
    const std::vector<DiscPoint> points = discPoints(count);
    ASSERT_EQ(points.size(), count);
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (const DiscPoint& p : points) {
      EXPECT_LE(std::hypot(p.x, p.y), 0.5);
      xx += p.x * p.x / count;
      yy += p.y * p.y / count;
      xy += p.x * p.y / count;
      EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                              [&p](const DiscPoint& q) { return q.x == -p.x && q.y == -p.y; }));
    }
    // Of a disc of diameter 1 the mean squares are 1 / 16.
    if (count >= 21) {
      EXPECT_NEAR(xx, 1.0 / 16.0, 0.08 / 16.0) << count;
      EXPECT_NEAR(yy, 1.0 / 16.0, 0.08 / 16.0) << count;
      EXPECT_NEAR(xy, 0.0, 0.1 / 16.0) << count;
    }
  }
}

TEST(DiscPoints, OfTheReferenceKeepTheirDistance) {
  const std::vector<DiscPoint> points = discPoints(21);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      // In a square grid of 21 cells on the disc it would be 0.19.
      EXPECT_GT(std::hypot(points[i].x - points[j].x, points[i].y - points[j].y), 0.12) << i << ' ' << j;
    }
  }
}

// A small A at the left before a B that fills the picture: A at depth 3, B at depth 8.
class TwoLayers : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kWidth = 48, kHeight = 32;
  static constexpr float kDepthA = 3.0f, kDepthB = 8.0f;

  TwoLayers() {
    for (LayerImage* image : {&a_, &b_, &hidden_, &single_}) {
      image->clear(kWidth, kHeight);
      image->depths.assign(image->pixels.size(), LayerImage::kNoDepth);
    }
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        const std::size_t i = std::size_t{y} * kWidth + x;
        const bool covered = x < 20;
        const float stripe = x % 4 < 2 ? 0.9f : 0.2f;
        b_.pixels[i] = {0.1f, stripe, 0.3f, 1.0f};
        b_.depths[i] = kDepthB;
        a_.pixels[i] = covered ? ShapedPixel{0.8f, 0.1f, 0.1f, 1.0f} : ShapedPixel{};
        a_.depths[i] = covered ? kDepthA : LayerImage::kNoDepth;
        hidden_.pixels[i] = covered ? ShapedPixel{} : b_.pixels[i];  // B out A
        single_.pixels[i] = covered ? a_.pixels[i] : b_.pixels[i];
        single_.depths[i] = covered ? kDepthA : kDepthB;
      }
    }
  }

  LayerImage blurredEvenly(const LayerImage& image, float depth) const {
    LayerImage blurred;
    blurEvenly(image, circleOfConfusion(view_, lens_, static_cast<double>(depth), kHeight), blurred);
    return blurred;
  }
  LayerImage sum() const {
    LayerImage sum = blurredEvenly(a_, kDepthA);
    const LayerImage b = blurredEvenly(hidden_, kDepthB);
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
      sum.pixels[i] = {sum.pixels[i].red + b.pixels[i].red, sum.pixels[i].green + b.pixels[i].green,
                       sum.pixels[i].blue + b.pixels[i].blue, sum.pixels[i].alpha + b.pixels[i].alpha};
    }
    return sum;
  }
  static void expectNear(const ShapedPixel& p, const ShapedPixel& q, std::size_t i) {
    EXPECT_NEAR(p.red, q.red, 1e-5) << i;
    EXPECT_NEAR(p.green, q.green, 1e-5) << i;
    EXPECT_NEAR(p.blue, q.blue, 1e-5) << i;
    EXPECT_NEAR(p.alpha, q.alpha, 1e-5) << i;
  }

  View view_ = lookingAlong();
  Lens lens_{.focus = 8.0, .aperture = 1.6};  // A's circle: 13.3 pixels; B is sharp
  LayerImage a_, b_, hidden_, single_;
};

TEST_F(TwoLayers, RokitasSingleImageIsBlurAPlusBlurBOutA) {
  LayerImage blurred;
  blurByDepth(single_, view_, lens_, Spread::kAsItArrives, blurred);
  const LayerImage expected = sum();
  for (std::size_t i = 0; i < blurred.pixels.size(); ++i) {
    expectNear(blurred.pixels[i], expected.pixels[i], i);
  }
}

TEST_F(TwoLayers, PotmesilsSingleImageIsThatSumDividedByItsMatte) {
  LayerImage blurred;
  blurByDepth(single_, view_, lens_, Spread::kNormalised, blurred);
  const LayerImage expected = sum();
  for (std::size_t i = 0; i < blurred.pixels.size(); ++i) {
    const ShapedPixel& e = expected.pixels[i];
    expectNear(blurred.pixels[i], {e.red / e.alpha, e.green / e.alpha, e.blue / e.alpha, 1.0f}, i);
  }
}

// What a lens would see along a row, far from the picture's ends: A covers, of the circle around a pixel,
// the part left of its edge; B shows through the rest, sharp, also where A stands before it.
TEST_F(TwoLayers, LayersShowTheBackgroundSharpBehindTheBlurredEdge) {
  LayerImage layered = blurredEvenly(a_, kDepthA);
  const LayerImage blurred_a = layered, b = blurredEvenly(b_, kDepthB);
  compositeOver(layered, b);
  LayerImage normalised, arriving;
  blurByDepth(single_, view_, lens_, Spread::kNormalised, normalised);
  blurByDepth(single_, view_, lens_, Spread::kAsItArrives, arriving);
  double layered_error = 0.0, normalised_error = 0.0, arriving_error = 0.0;
  for (std::uint32_t x = 8; x < 34; ++x) {
    const std::size_t i = std::size_t{kHeight / 2} * kWidth + x;
    const float share = blurred_a.pixels[i].alpha;
    const float expected = share * 0.1f + (1.0f - share) * (x % 4 < 2 ? 0.9f : 0.2f);
    EXPECT_NEAR(layered.pixels[i].green, expected, 1e-5) << x;
    layered_error += std::abs(layered.pixels[i].green - expected);
    normalised_error += std::abs(normalised.pixels[i].green - expected);
    arriving_error += std::abs(arriving.pixels[i].green - expected);
  }
  EXPECT_GT(normalised_error, 0.5);
  EXPECT_GT(arriving_error, 0.5);
  EXPECT_LT(layered_error, 0.01);
  // Just inside A's edge Potmesil's picture is A alone, as sharp as before, and Rokita's is dark: no single
  // image knows B there.
  const std::size_t inside = std::size_t{kHeight / 2} * kWidth + 18;
  EXPECT_NEAR(normalised.pixels[inside].green, 0.1, 1e-5);
  EXPECT_LT(arriving.pixels[inside].alpha, 0.7f);
}

}  // namespace
}  // namespace sightline
