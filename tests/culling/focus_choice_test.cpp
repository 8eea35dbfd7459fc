#include "src/culling/focus_choice.h"

#include <gtest/gtest.h>

#include <vector>

namespace sightline::culling {
namespace {

TEST(FocusChoice, FindsThePlacesOfTheGreatestWeightsOneAfterTheOther) {
  FocusChoice choice(320, 180, 16, 16);
  choice.begin();
  const BufferPixel few{20, 20};
  const std::vector<BufferPixel> many{{300, 170}, {301, 171}, {302, 169}};
  choice.add({&few, 1}, 100);
  choice.add(many, 300);
  occlusion::PixelRange range;
  ASSERT_EQ(choice.next(50.0, range), 300u);
  for (const BufferPixel& pixel : many) {
    EXPECT_TRUE(range.contains(pixel));
  }
  EXPECT_LT(range.x1, 320u);
  EXPECT_LT(range.y1, 180u);
  ASSERT_EQ(choice.next(50.0, range), 100u);
  EXPECT_TRUE(range.contains(few));
  EXPECT_EQ(choice.next(0.0, range), 0u) << "all weights have been taken";
  choice.begin();
  choice.add({&few, 1}, 100);
  EXPECT_EQ(choice.next(101.0, range), 0u);
  EXPECT_EQ(choice.next(100.0, range), 100u);
}

TEST(FocusChoice, StaysInBuffersOfAnySize) {
  for (const std::uint32_t width : {1u, 3u, 16u, 17u, 100u, 8192u}) {
    for (const std::uint32_t height : {1u, 5u, 16u, 90u}) {
      FocusChoice choice(width, height, 16, 16);
      choice.begin();
      const BufferPixel last{static_cast<std::uint16_t>(width - 1), static_cast<std::uint16_t>(height - 1)};
      choice.add({&last, 1}, 5);
      occlusion::PixelRange range;
      ASSERT_EQ(choice.next(5.0, range), 5u) << width << " x " << height;
      EXPECT_EQ(range.x1 + 1u, width);
      EXPECT_EQ(range.y1 + 1u, height);
      EXPECT_LE(range.x0, range.x1);
      EXPECT_LE(range.y0, range.y1);
    }
  }
}

}  // namespace
}  // namespace sightline::culling
