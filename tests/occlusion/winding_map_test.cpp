// Windings in a depth buffer as wide as they come: the same bits on every instruction set, and right ones.

#include "src/occlusion/winding_map.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/random_numbers.h"

namespace sightline::occlusion {
namespace {

constexpr std::uint32_t kMapWidth = 8192, kMapHeight = 8, kMapStride = kMapWidth + 8;
constexpr float kNoDepth = -std::numeric_limits<float>::max();

// What one closed polygon covers in a map.
class PolygonCover {
 public:
  PolygonCover() { map_.resize({values_.data(), kMapWidth, kMapHeight, kMapStride}); }

  const std::vector<float>& of(std::span<const GridPoint> polygon) {
    std::fill(values_.begin(), values_.end(), kNoDepth);
    map_.begin({0, 0, kMapWidth, kMapHeight});
    map_.addEdges(polygon, 1, 1);
    map_.resolve(DepthBound{.floor = 1.0f});
    for (std::uint32_t row = 0; row < kMapHeight; ++row) {
      std::fill_n(values_.begin() + kMapStride * row + kMapWidth, kMapStride - kMapWidth, kNoDepth);
    }
    return values_;
  }

 private:
  std::vector<float> values_ = std::vector<float>(std::size_t{kMapStride} * kMapHeight);
  WindingMap map_;
};

// A quad 781 pixels wide that reaches over all rows. Its right edge lies between 4096 and 8192 pixels from
// the left border, where single precision knows places to an eighth of 1/256 pixel.
std::vector<GridPoint> farQuad(std::mt19937& random) {
  const auto number = test::numbersFrom<double>(random);
  const double width = 200'000.0, right = std::nearbyint(number(0x1p20, 0x1p21)),
               lean = std::nearbyint(number(-3e5, 3e5)), low = -std::nearbyint(number(1.0, 2e4)),
               high = kMapHeight * kGridStep + std::nearbyint(number(1.0, 2e4));
  return {{right - width, low},
          {right, low},
          {right + lean, high},
          {right + lean - width, high},
          {right - width, low}};
}

// Whether a point in grid units, not on a level line through a corner, is inside a quad of farQuad().
bool isInside(const std::vector<GridPoint>& quad, std::int64_t x, std::int64_t y) {
  for (std::size_t i = 1; i < quad.size(); ++i) {
    const auto x0 = static_cast<std::int64_t>(quad[i - 1].x), y0 = static_cast<std::int64_t>(quad[i - 1].y),
               x1 = static_cast<std::int64_t>(quad[i].x), y1 = static_cast<std::int64_t>(quad[i].y);
    if ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) < 0) {
      return false;
    }
  }
  return true;
}

TEST(WindingMap, HasTheSameBitsWithEveryInstructionSetAtTheGreatestWidth) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2u);
  std::mt19937 random(7);
  PolygonCover cover;
  std::size_t covered = 0;
  for (int n = 0; n < 1500; ++n) {
    const std::vector<GridPoint> quad = farQuad(random);
    std::vector<float> first;
    for (const std::int64_t target : targets) {
      hwy::SetSupportedTargetsForTest(target);
      const std::vector<float>& values = cover.of(quad);
      hwy::SetSupportedTargetsForTest(0);
      if (first.empty()) {
        first = values;
        covered += static_cast<std::size_t>(std::ranges::count(values, 1.0f));
      }
      EXPECT_TRUE(std::ranges::equal(first, values)) << "quad " << n << ", " << hwy::TargetName(target);
    }
  }
  EXPECT_GT(covered, 1'000'000u);
}

TEST(WindingMap, CoversOnlyPixelsInsideAFarQuadAndMostOfThem) {
  std::mt19937 random(11);
  PolygonCover cover;
  for (int n = 0; n < 300; ++n) {
    const std::vector<GridPoint> quad = farQuad(random);
    const std::vector<float>& values = cover.of(quad);
    std::size_t covered = 0, inside = 0, wrong = 0;
    for (std::uint32_t row = 0; row < kMapHeight; ++row) {
      for (std::uint32_t column = 0; column < kMapWidth; ++column) {
        const std::int64_t x = kGridStep * std::int64_t{column}, y = kGridStep * std::int64_t{row};
        const bool whole = isInside(quad, x, y) && isInside(quad, x + kGridStep, y) &&
                           isInside(quad, x, y + kGridStep) && isInside(quad, x + kGridStep, y + kGridStep);
        const bool said = values[std::size_t{kMapStride} * row + column] > kNoDepth;
        covered += said ? 1 : 0;
        inside += whole ? 1 : 0;
        wrong += said && !whole ? 1 : 0;
      }
    }
    EXPECT_EQ(wrong, 0u) << "quad " << n;
    // An edge that leans by many pixels in a row leaves a few at either side open.
    EXPECT_GE(covered + std::size_t{16} * kMapHeight, inside) << "quad " << n;
  }
}

}  // namespace
}  // namespace sightline::occlusion
