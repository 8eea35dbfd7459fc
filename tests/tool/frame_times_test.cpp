#include "tools/sightline/bench/frame_times.h"

#include <gtest/gtest.h>

#include <numeric>

namespace sightline::tool {
namespace {

TEST(FrameTimes, AreZeroWithoutSamples) {
  const FrameTimes times = frameTimesOf({}, 0);
  EXPECT_EQ(times.median.value, 0.0);
  EXPECT_EQ(times.mean.value, 0.0);
  EXPECT_EQ(times.p99.value, 0.0);
}

TEST(FrameTimes, MedianIsBetweenTheMiddleTwo) {
  EXPECT_EQ(medianOf({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(medianOf({4.0, 1.0, 2.0, 8.0}), 3.0);
  EXPECT_EQ(medianOf({5.0}), 5.0);
}

TEST(FrameTimes, PercentileIsTheNearestRank) {
  std::vector<double> values(200);
  std::iota(values.begin(), values.end(), 1.0);
  EXPECT_EQ(percentileOf(values, 0.99), 198.0);
  EXPECT_EQ(percentileOf(values, 1.0), 200.0);
  EXPECT_EQ(percentileOf(values, 0.0), 1.0);
  EXPECT_EQ(percentileOf({7.0}, 0.99), 7.0);
}

TEST(FrameTimes, AHitchInOneRoundWidensItsMeanAndPercentileButNotItsMedian) {
  const std::vector<double> samples{1, 2, 3, 1, 2, 30};
  const FrameTimes times = frameTimesOf(samples, 2);
  EXPECT_EQ(times.median.value, 2.0);
  EXPECT_EQ(times.median.low, 2.0);
  EXPECT_EQ(times.median.high, 2.0);
  EXPECT_EQ(times.mean.value, 6.5);
  EXPECT_EQ(times.mean.low, 2.0);
  EXPECT_EQ(times.mean.high, 11.0);
  EXPECT_EQ(times.p99.value, 30.0);
  EXPECT_EQ(times.p99.low, 3.0);
  EXPECT_EQ(times.p99.high, 30.0);
}

}  // namespace
}  // namespace sightline::tool
