#include "sightline/culling/measured_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sightline {
namespace {

// What a renderer takes that needs so long for any frame, and so long for a triangle.
constexpr double kFixedUs = 500.0, kTriangleUs = 0.25;
double timeOf(std::uint64_t triangles) {
  return kFixedUs + kTriangleUs * static_cast<double>(triangles);
}

TEST(MeasuredRenderer, KnowsNothingBeforeAFrameWithTriangles) {
  MeasuredRenderer renderer;
  EXPECT_FALSE(renderer.triangleUs().has_value());
  renderer.frame(100.0, 0);
  EXPECT_FALSE(renderer.triangleUs().has_value());
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    renderer.frame(bad, 1000);
    EXPECT_FALSE(renderer.triangleUs().has_value()) << bad;
  }
}

TEST(MeasuredRenderer, TheFixedTimeOfAFrameIsNoTriangles) {
  MeasuredRenderer renderer;
  for (int frame = 0; frame < 50; ++frame) {
    renderer.frame(timeOf(20'000), 20'000);  // without culling
    renderer.frame(timeOf(3'000), 3'000);    // with it
  }
  ASSERT_TRUE(renderer.triangleUs().has_value());
  EXPECT_NEAR(*renderer.triangleUs(), kTriangleUs, 1e-6);
}

TEST(MeasuredRenderer, FramesOfEqualNumbersTellTheirShare) {
  MeasuredRenderer renderer;
  for (int frame = 0; frame < 50; ++frame) {
    renderer.frame(timeOf(1'000), 1'000);
  }
  EXPECT_NEAR(*renderer.triangleUs(), timeOf(1'000) / 1'000.0, 1e-6);
}

TEST(MeasuredRenderer, FollowsARendererThatChanges) {
  MeasuredRenderer renderer;
  for (const double factor : {1.0, 4.0}) {
    for (int frame = 0; frame < 500; ++frame) {
      const std::uint64_t triangles = frame % 2 == 0 ? 20'000 : 3'000;
      renderer.frame(factor * timeOf(triangles), triangles);
    }
    EXPECT_NEAR(*renderer.triangleUs(), factor * kTriangleUs, 1e-3);
  }
}

TEST(MeasuredRenderer, MoreTrianglesInLessTimeCostNothing) {
  MeasuredRenderer renderer;
  for (int frame = 0; frame < 50; ++frame) {
    renderer.frame(100.0, 20'000);
    renderer.frame(300.0, 3'000);
  }
  EXPECT_EQ(*renderer.triangleUs(), 0.0);
}

}  // namespace
}  // namespace sightline
