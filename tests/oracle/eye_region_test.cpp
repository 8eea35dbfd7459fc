#include "oracle/eye_region.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sightline {
namespace {

Vec3d randomVec(SplitMix& random, double size) {
  return {random.in(-size, size), random.in(-size, size), random.in(-size, size)};
}

TEST(EyeRegion, AllPlacesAreExactlyInTheRegion) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SplitMix random{seed};
    const Vec3d middle = randomVec(random, 1000), half = abs(randomVec(random, 3));
    EyeRegion region{middle - half, middle + half, {}};
    const Vec3d normal = normalized(randomVec(random, 1));
    const double thickness = std::pow(10.0, random.in(-6, 0)) * length(half);
    region.sides.push_back({normal, dot(normal, middle)});
    if (seed % 2 == 0) {
      region.sides.push_back({-normal, -dot(normal, middle) - thickness});
    }
    const EyePlaces places(region);
    ASSERT_FALSE(places.empty()) << "seed " << seed;
    for (std::uint32_t i = 0; i < 50; ++i) {
      EXPECT_TRUE(region.contains(places.point(random))) << "seed " << seed;
      EXPECT_TRUE(region.contains(places.corner(i % 8))) << "seed " << seed;
      EXPECT_TRUE(region.contains(places.inside(middle + randomVec(random, 5)))) << "seed " << seed;
    }
  }
}

TEST(EyeRegion, TheCornersOfABoxAreItsOwn) {
  const EyePlaces places(EyeRegion{{0.1, 0.2, 0.3}, {1.1, 1.2, 1.3}, {}});
  EXPECT_EQ(places.corner(0), Vec3d(0.1, 0.2, 0.3));
  EXPECT_EQ(places.corner(5), Vec3d(1.1, 0.2, 1.3));
  EXPECT_EQ(places.corner(7), Vec3d(1.1, 1.2, 1.3));
}

TEST(EyeRegion, SidesThatExcludeEachOtherLeaveNothing) {
  EXPECT_TRUE(EyePlaces(EyeRegion{{0, 0, 0}, {1, 1, 1}, {{{1, 0, 0}, 0.6}, {{-1, 0, 0}, -0.5}}}).empty());
  EXPECT_TRUE(EyePlaces(EyeRegion{{0, 0, 0}, {1, 1, 1}, {{{1, 0, 0}, 1.1}}}).empty());
  EXPECT_FALSE(EyePlaces(EyeRegion{{0, 0, 0}, {1, 1, 1}, {{{1, 0, 0}, 1.0}}}).empty());
}

}  // namespace
}  // namespace sightline
