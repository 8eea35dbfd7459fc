#include "sightline/render/compare.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

Image grey(std::uint32_t width, std::uint32_t height) {
  Image image{.width = width, .height = height, .rgba = {}};
  image.rgba.assign(std::size_t{4} * width * height, 128);
  return image;
}

TEST(CompareImages, EqualImagesHaveNoDifference) {
  EXPECT_TRUE(compareImages(grey(7, 5), grey(7, 5)).equal());
  EXPECT_TRUE(compareImages({}, {}).equal());
}

TEST(CompareImages, CountsPixelsAndNamesTheFirst) {
  Image changed = grey(7, 5);
  changed.rgba[4 * (2 * 7 + 3) + 1] = 129;
  changed.rgba[4 * (4 * 7 + 6) + 0] = 100;
  changed.rgba[4 * (4 * 7 + 6) + 2] = 130;
  const ImageDifference difference = compareImages(grey(7, 5), changed);
  EXPECT_EQ(difference.pixels, 2u);
  EXPECT_EQ(difference.x, 3u);
  EXPECT_EQ(difference.y, 2u);
  EXPECT_EQ(difference.largest, 28);
}

TEST(CompareImages, ImagesOfDifferentSizesDifferEverywhere) {
  EXPECT_EQ(compareImages(grey(2, 2), grey(4, 3)).pixels, 12u);
}

TEST(DifferenceImage, MarksWhatDiffersInRed) {
  Image changed = grey(2, 1);
  changed.rgba[4] = 0;
  const Image marked = differenceImage(grey(2, 1), changed);
  EXPECT_EQ(marked.rgba[0], 191 + 32);
  EXPECT_EQ(marked.rgba[4], 220);
  EXPECT_EQ(marked.rgba[5], 0);
  EXPECT_TRUE(differenceImage(grey(2, 1), grey(1, 1)).rgba.empty());
}

TEST(SideBySide, KeepsBothImages) {
  Image dark = grey(3, 2);
  dark.rgba.assign(dark.rgba.size(), 10);
  const Image both = sideBySide(grey(2, 4), dark);
  EXPECT_EQ(both.width, 2u + 8u + 3u);
  EXPECT_EQ(both.height, 4u);
  EXPECT_EQ(both.rgba[0], 128);
  EXPECT_EQ(both.rgba[4 * 10], 10);
  EXPECT_EQ(both.rgba[4 * (3 * 13 + 10)], 255);
}

}  // namespace
}  // namespace sightline
