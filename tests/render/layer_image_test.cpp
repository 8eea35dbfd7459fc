#include "sightline/render/layer_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sightline {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

LayerImage imageOf(std::uint32_t width, std::uint32_t height, const std::vector<ShapedPixel>& pixels) {
  return {.width = width, .height = height, .pixels = pixels, .depths = {}};
}

TEST(LayerImage, ClearLeavesATransparentPictureWithoutDepths) {
  LayerImage image = imageOf(1, 1, {{1, 1, 1, 1}});
  image.depths = {3.0f};
  image.clear(3, 2);
  EXPECT_EQ(image.pixels, std::vector<ShapedPixel>(6));
  EXPECT_TRUE(image.depths.empty());
  EXPECT_EQ(image.view().width, 3u);
  EXPECT_EQ(image.view().stride, 3u);
  EXPECT_EQ(image.target().height, 2u);
  image.clear(0, 5);
  EXPECT_TRUE(image.pixels.empty());
}

TEST(LayerImage, OverIsPorterAndDuffsForPremultipliedColours) {
  LayerImage front =
      imageOf(4, 1, {{0.25f, 0, 0, 0.5f}, {0, 0, 0, 0}, {0.5f, 0.5f, 0.5f, 1}, {0.125f, 0, 0, 0.25f}});
  const LayerImage back =
      imageOf(4, 1, {{0, 0.5f, 0, 1}, {0, 0, 0.5f, 0.5f}, {1, 1, 1, 1}, {0, 0.25f, 0, 0.5f}});
  compositeOver(front, back);
  EXPECT_EQ(front.pixels[0], (ShapedPixel{0.25f, 0.25f, 0, 1}));
  EXPECT_EQ(front.pixels[1], back.pixels[1]);
  EXPECT_EQ(front.pixels[2], (ShapedPixel{0.5f, 0.5f, 0.5f, 1}));
  EXPECT_EQ(front.pixels[3], (ShapedPixel{0.125f, 0.1875f, 0, 0.625f}));
}

TEST(LayerImage, OverKeepsTheNearerDepth) {
  LayerImage front = imageOf(3, 1, std::vector<ShapedPixel>(3));
  LayerImage back = front;
  front.depths = {1.0f, LayerImage::kNoDepth, 5.0f};
  compositeOver(front, back);
  EXPECT_EQ(front.depths[2], 5.0f);
  back.depths = {2.0f, 3.0f, 4.0f};
  compositeOver(front, back);
  EXPECT_EQ(front.depths, (std::vector<float>{1.0f, 3.0f, 4.0f}));
}

TEST(LayerImage, PicturesOfEightBitsHoldSquareRootsOfTheColourWithoutOpacity) {
  // 0.09 of light behind an opacity of a quarter: the colour is 0.36, its root 0.6.
  const Image image = toImage(imageOf(2, 1, {{0.09f, 1.0f, 0.0f, 0.25f}, {0.25f, 0.0f, 1.0f, 1.0f}}));
  EXPECT_EQ(image.width, 2u);
  EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{153, 255, 0, 64, 128, 0, 255, 255}));
}

TEST(LayerImage, PicturesOfEightBitsTakeAnyNumber) {
  const float infinity = std::numeric_limits<float>::infinity();
  const Image image = toImage(imageOf(4, 1,
                                      {{kNaN, infinity, -1.0f, 1.0f},
                                       {1.0f, 1.0f, 1.0f, kNaN},
                                       {1.0f, 1.0f, 1.0f, 0.0f},
                                       {infinity, 0.0f, 0.0f, infinity}}));
  EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{0, 255, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255}));
  EXPECT_TRUE(toImage({}).rgba.empty());
}

TEST(LayerImage, TheMeasureIsOfTheChannelsOfEightBits) {
  const LayerImage a = imageOf(2, 1, {{0, 0, 0, 1}, {1, 1, 1, 1}});
  // Root of 0.04: 51 of 255.
  const LayerImage b = imageOf(2, 1, {{0.04f, 0, 0, 1}, {1, 1, 1, 1}});
  EXPECT_EQ(measureDifference(a, a).largest, 0.0);
  const PictureDifference difference = measureDifference(a, b);
  EXPECT_EQ(difference.largest, 51.0);
  EXPECT_DOUBLE_EQ(difference.mean, 51.0 / 8.0);
  EXPECT_DOUBLE_EQ(difference.rms, 51.0 / std::sqrt(8.0));
  EXPECT_DOUBLE_EQ(difference.share_beyond, 0.5);
  EXPECT_DOUBLE_EQ(measureDifference(a, b, 51.0).share_beyond, 0.0);
  EXPECT_DOUBLE_EQ(measureDifference(b, a, 50.9).share_beyond, 0.5);
}

TEST(LayerImage, PicturesOfDifferentSizeDifferEverywhere) {
  const LayerImage a = imageOf(2, 1, std::vector<ShapedPixel>(2)),
                   b = imageOf(1, 2, std::vector<ShapedPixel>(2));
  EXPECT_EQ(measureDifference(a, b).share_beyond, 1.0);
  EXPECT_EQ(measureDifference(a, b).largest, 255.0);
  EXPECT_EQ(measureDifference({}, {}).mean, 0.0);
}

}  // namespace
}  // namespace sightline
