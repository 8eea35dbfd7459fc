#include "src/culling/timed_budget.h"

#include <gtest/gtest.h>

namespace sightline::culling {
namespace {

// Draws as much as the budget allows for so many frames, where a unit of drawing takes unit_us and all the
// rest rest_us, and returns what the last frame took. later: the part of the work that is drawn later.
double frames(TimedBudget& budget, int count, double unit_us, double rest_us, double later = 0.0) {
  double frame_us = 0.0;
  for (int i = 0; i < count; ++i) {
    const double all = budget.work(), first = (1.0 - later) * all;
    budget.frame(first, first * unit_us, all - first, (all - first) * unit_us + rest_us);
    frame_us = all * unit_us + rest_us;
  }
  return frame_us;
}

TEST(TimedBudget, WithoutATimeNothingIsLimited) {
  EXPECT_FALSE(TimedBudget(0.0).limits());
  EXPECT_TRUE(TimedBudget(1.0).limits());
}

TEST(TimedBudget, FramesComeToTakeTheTimeThatTheyMay) {
  for (const double unit_us : {0.001, 0.02, 0.1, 3.0}) {
    TimedBudget budget(500.0);
    EXPECT_NEAR(frames(budget, 100, unit_us, 120.0), 500.0, 1.0) << unit_us;
    EXPECT_NEAR(frames(budget, 100, unit_us, 120.0, 0.6), 500.0, 1.0) << unit_us << ", most of it later";
  }
}

TEST(TimedBudget, NothingIsDrawnWhereTheRestAloneTakesTheTime) {
  TimedBudget budget(500.0);
  frames(budget, 100, 0.1, 700.0);
  EXPECT_LT(budget.work(), 1.0);
}

TEST(TimedBudget, OneFrameThatHadToWaitTakesLittleFromTheNext) {
  for (const bool while_drawing : {true, false}) {
    TimedBudget budget(500.0);
    frames(budget, 100, 0.1, 100.0);
    const double before = budget.work();
    budget.frame(before, before * 0.1 + (while_drawing ? 1e6 : 0.0), 0.0,
                 100.0 + (while_drawing ? 0.0 : 1e6));
    EXPECT_GT(budget.work(), 0.7 * before) << while_drawing;
    EXPECT_NEAR(frames(budget, 40, 0.1, 100.0), 500.0, 5.0) << while_drawing;
  }
}

TEST(TimedBudget, WhatRemainsSlowerIsFollowedWithinAFewFrames) {
  TimedBudget budget(500.0);
  frames(budget, 100, 0.1, 0.0);
  EXPECT_LT(frames(budget, 30, 1.0, 0.0), 550.0);
  EXPECT_GT(frames(budget, 60, 0.1, 0.0), 450.0);
}

TEST(TimedBudget, AFrameThatDrawsNothingLeavesTheSpeedAsItIs) {
  TimedBudget budget(500.0);
  frames(budget, 100, 0.1, 100.0);
  const double before = budget.work();
  for (int i = 0; i < 20; ++i) {
    budget.frame(0.0, 30.0, 0.0, 100.0);
  }
  EXPECT_NEAR(budget.work(), before, 1e-9 * before);
}

}  // namespace
}  // namespace sightline::culling
