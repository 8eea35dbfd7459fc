#include "tools/sightline/layers/layer_totals.h"

#include <gtest/gtest.h>

namespace sightline::tool {
namespace {

LayerTotals ofTimes(std::initializer_list<double> times) {
  LayerTotals totals;
  for (const double us : times) {
    totals.add(LayerOrder{}, 0.0, 0.0, us);
  }
  return totals;
}

TEST(LayerTotals, TheFirstFrameIsNotAmongTheLargestAfterIt) {
  const LayerTotals totals = ofTimes({9.0, 2.0, 4.0});
  EXPECT_EQ(totals.largest(&LayerTotals::Frame::sort_us), 9.0);
  EXPECT_EQ(totals.largestAfterFirst(&LayerTotals::Frame::sort_us), 4.0);
  EXPECT_EQ(ofTimes({9.0}).largestAfterFirst(&LayerTotals::Frame::sort_us), 9.0) << "there is no other";
}

TEST(LayerTotals, EachFrameKeepsTheFasterOfTwoRuns) {
  LayerTotals totals = ofTimes({9.0, 2.0, 4.0});
  totals.keepFaster(ofTimes({3.0, 5.0, 1.0}));
  EXPECT_EQ(totals.largest(&LayerTotals::Frame::sort_us), 3.0);
  EXPECT_EQ(totals.mean(&LayerTotals::Frame::sort_us), 2.0);
}

}  // namespace
}  // namespace sightline::tool
