#include "src/occlusion/boxes/summed_area.h"

#include <gtest/gtest.h>

#include "tests/occlusion/synthetic_buffers.h"

namespace sightline::occlusion {
namespace {

using namespace test;

TEST(SummedArea, CountsEveryRectangleAsPixelByPixel) {
  for (const auto& size : kMapSizes) {
    for (const SyntheticMap& buffer : syntheticMaps(size[0], size[1], 1)) {
      SummedArea sums;
      sums.build(buffer.view());
      for (std::uint32_t y0 = 0; y0 < buffer.height; ++y0) {
        for (std::uint32_t y1 = y0; y1 < buffer.height; ++y1) {
          // All columns of small buffers, every seventh of large ones.
          const std::uint32_t step = buffer.width > 100 ? 7 : 1;
          for (std::uint32_t x0 = 0; x0 < buffer.width; x0 += step) {
            for (std::uint32_t x1 = x0; x1 < buffer.width; x1 += step) {
              const PixelBox rect = rectangle(x0, y0, x1, y1);
              ASSERT_EQ(sums.count(rect), coveredByCounting(buffer.view(), rect))
                  << buffer.name << ": " << x0 << " " << y0 << " to " << x1 << " " << y1;
              ASSERT_EQ(areaOf(rect), (x1 - x0 + 1) * (y1 - y0 + 1));
            }
          }
        }
      }
      EXPECT_EQ(sums.count(),
                coveredByCounting(buffer.view(), rectangle(0, 0, buffer.width - 1, buffer.height - 1)));
    }
  }
}

TEST(SummedArea, OneMapAfterAnotherOfAnySizeLeavesNothingBehind) {
  SummedArea sums;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 random(seed);
    const auto size = [&] { return static_cast<std::uint32_t>(1 + random() % 60); };
    const std::uint32_t width = size(), height = size();
    const std::vector<SyntheticMap> maps = syntheticMaps(width, height, seed);
    const SyntheticMap& buffer = maps[random() % maps.size()];
    sums.build(buffer.view());
    for (int i = 0; i < 50; ++i) {
      const PixelBox rect = randomRectangle(random, width, height);
      ASSERT_EQ(sums.count(rect), coveredByCounting(buffer.view(), rect)) << buffer.name << " seed " << seed;
    }
  }
}

TEST(SummedArea, CountsMoreThanSixteenBitsHold) {
  const SyntheticMap buffer("full", 700, 600, [](std::uint32_t, std::uint32_t) { return 1.0f; });
  SummedArea sums;
  sums.build(buffer.view());
  EXPECT_EQ(sums.count(), 420'000u);
  EXPECT_EQ(sums.count(rectangle(1, 1, 698, 598)), 698u * 598u);
}

TEST(SummedArea, BeforeTheFirstMapNothingIsCovered) {
  EXPECT_EQ(SummedArea().count(), 0u);
}

}  // namespace
}  // namespace sightline::occlusion
