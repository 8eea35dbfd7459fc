#include "src/occlusion/summed_area.h"

#include <gtest/gtest.h>

#include "tests/occlusion/synthetic_maps.h"

namespace sightline::occlusion {
namespace {

using namespace test;

TEST(SummedArea, CountsEveryRectangleAsPixelByPixel) {
  for (const auto& size : kMapSizes) {
    for (const SyntheticMap& map : syntheticMaps(size[0], size[1], 1)) {
      SummedArea sums;
      sums.build(map.view());
      for (std::uint32_t y0 = 0; y0 < map.height; ++y0) {
        for (std::uint32_t y1 = y0; y1 < map.height; ++y1) {
          // All columns of small maps, every seventh of large ones.
          const std::uint32_t step = map.width > 100 ? 7 : 1;
          for (std::uint32_t x0 = 0; x0 < map.width; x0 += step) {
            for (std::uint32_t x1 = x0; x1 < map.width; x1 += step) {
              const PixelBox rect = rectangle(x0, y0, x1, y1);
              ASSERT_EQ(sums.count(rect), coveredByCounting(map.view(), rect))
                  << map.name << ": " << x0 << " " << y0 << " to " << x1 << " " << y1;
              ASSERT_EQ(areaOf(rect), (x1 - x0 + 1) * (y1 - y0 + 1));
            }
          }
        }
      }
      EXPECT_EQ(sums.count(), coveredByCounting(map.view(), rectangle(0, 0, map.width - 1, map.height - 1)));
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
    const SyntheticMap& map = maps[random() % maps.size()];
    sums.build(map.view());
    for (int i = 0; i < 50; ++i) {
      const PixelBox rect = randomRectangle(random, width, height);
      ASSERT_EQ(sums.count(rect), coveredByCounting(map.view(), rect)) << map.name << " seed " << seed;
    }
  }
}

TEST(SummedArea, CountsMoreThanSixteenBitsHold) {
  const SyntheticMap map("full", 700, 600, [](std::uint32_t, std::uint32_t) { return 1.0f; });
  SummedArea sums;
  sums.build(map.view());
  EXPECT_EQ(sums.count(), 420'000u);
  EXPECT_EQ(sums.count(rectangle(1, 1, 698, 598)), 698u * 598u);
}

TEST(SummedArea, BeforeTheFirstMapNothingIsCovered) {
  EXPECT_EQ(SummedArea().count(), 0u);
}

}  // namespace
}  // namespace sightline::occlusion
