#include "src/occlusion/surfaces/square_depths.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/instruction_sets.h"
#include "tests/support/random_numbers.h"

namespace sightline::occlusion {
namespace {

// The least value of a rectangle, pixel by pixel.
float leastOf(const DepthTarget& target, const PixelRectangle& r) {
  float least = std::numeric_limits<float>::infinity();
  for (std::int32_t y = r.y0; y < r.y1; ++y) {
    for (std::int32_t x = r.x0; x < r.x1; ++x) {
      least = std::min(least, target.reciprocal_depth[static_cast<std::uint32_t>(y) * target.stride +
                                                      static_cast<std::uint32_t>(x)]);
    }
  }
  return least;
}

// In targets of any size, of which the values beyond the width are nearer or farther than all others.
TEST(SquareDepths, AreTheLeastOfTheirSquaresAndOfEachRectangle) {
  test::Random random(5);
  std::size_t nearer = 0, not_nearer = 0;
  for (int n = 0; n < 1500; ++n) {
    const std::uint32_t width = 1 + random.below(70), height = 1 + random.below(40),
                        stride = (width + 15) / 8 * 8;
    std::vector<float> values(std::size_t{stride} * height, n % 2 == 0 ? 9.0f : -9.0f);
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        values[std::size_t{stride} * y + x] =
            random.below(40) == 0 ? static_cast<float>(random.below(4)) : 4.0f;
      }
    }
    const DepthTarget target{values.data(), width, height, stride};
    const std::uint32_t x = random.below(width), y = random.below(height);
    const PixelRectangle r{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                           static_cast<std::int32_t>(x + 1 + random.below(width - x)),
                           static_cast<std::int32_t>(y + 1 + random.below(height - y))};
    const float than = static_cast<float>(random.below(5)) - 0.5f * static_cast<float>(random.below(2));
    const bool expected = leastOf(target, r) > than;
    (expected ? nearer : not_nearer) += 1;
    for (const std::int64_t set : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(set);
      SquareDepths depths;
      depths.look(target);
      EXPECT_EQ(depths.allNearer(target, r, than), expected) << n << ", " << hwy::TargetName(set);
      for (std::int32_t row = 0; row < squaresIn(height); ++row) {
        for (std::int32_t column = 0; column < squaresIn(width); ++column) {
          constexpr std::int32_t k = SquareDepths::kSize;
          const PixelRectangle square{column * k, row * k,
                                      std::min(column * k + k, static_cast<std::int32_t>(width)),
                                      std::min(row * k + k, static_cast<std::int32_t>(height))};
          EXPECT_EQ(depths.ofRow(row)[column], leastOf(target, square)) << n << ", " << hwy::TargetName(set);
        }
      }
    }
  }
  EXPECT_GT(nearer, 300u);
  EXPECT_GT(not_nearer, 300u);
}

TEST(SquareDepths, OfATargetWithOneValueAreThatValue) {
  for (const std::uint32_t width : {1u, 8u, 61u}) {
    std::vector<float> values(std::size_t{72} * 19, -3.0f);
    const DepthTarget target{values.data(), width, 19, 72};
    SquareDepths filled, looked_at;
    filled.fill(target, -3.0f);
    looked_at.look(target);
    for (std::int32_t row = 0; row < squaresIn(19); ++row) {
      for (std::int32_t column = 0; column < squaresIn(width); ++column) {
        EXPECT_EQ(filled.ofRow(row)[column], looked_at.ofRow(row)[column]);
      }
    }
  }
}

}  // namespace
}  // namespace sightline::occlusion
