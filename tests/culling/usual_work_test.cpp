#include "src/culling/usual_work.h"

#include <gtest/gtest.h>

namespace sightline::culling {
namespace {

TEST(UsualWork, TheFirstViewIsNotLimitedBecauseNothingIsUsualYet) {
  const UsualWork usual;
  for (const bool jumped : {false, true}) {
    const SurfaceLimits asked{.pixels_per_edge = 4.0, .budget = 60000};
    EXPECT_EQ(usual.limited(asked, jumped).budget, asked.budget);
    EXPECT_EQ(usual.limited(asked, jumped).pixels_per_edge, asked.pixels_per_edge);
  }
}

TEST(UsualWork, AViewMayDoManyTimesWhatIsUsualAndNoMoreThanIsAsked) {
  UsualWork usual;
  usual.frame(1000.0);
  const std::uint32_t limit = usual.limited({.budget = 4000000000}, false).budget;
  EXPECT_GT(limit, 1000u);
  EXPECT_LT(limit, 4000000000u);
  EXPECT_EQ(usual.limited({.budget = limit - 1}, false).budget, limit - 1);
}

TEST(UsualWork, TheLimitFollowsTheWorkOfTheLastViewsAndIsNeverTiny) {
  UsualWork usual;
  usual.frame(1.0);
  const std::uint32_t least = usual.limited({.budget = 4000000000}, false).budget;
  EXPECT_GE(least, 1000u);
  std::uint32_t last = least;
  for (int view = 0; view < 100; ++view) {
    usual.frame(50000.0);
    const std::uint32_t now = usual.limited({.budget = 4000000000}, false).budget;
    EXPECT_GE(now, last);
    last = now;
  }
  EXPECT_GT(last, 50000u);
  for (int view = 0; view < 1000; ++view) {
    usual.frame(0.0);
  }
  EXPECT_EQ(usual.limited({.budget = 4000000000}, false).budget, least);
}

TEST(UsualWork, AfterAJumpOnlySurfacesWithFewEdgesForTheirSizeAreDrawn) {
  UsualWork usual;
  usual.frame(1000.0);
  const SurfaceLimits asked{.pixels_per_edge = 4.0};
  EXPECT_EQ(usual.limited(asked, false).pixels_per_edge, asked.pixels_per_edge);
  EXPECT_GT(usual.limited(asked, true).pixels_per_edge, asked.pixels_per_edge);
  EXPECT_EQ(usual.limited(asked, true).budget, usual.limited(asked, false).budget);
}

}  // namespace
}  // namespace sightline::culling
