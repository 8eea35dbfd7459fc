#include "src/culling/focus_budget.h"

#include <gtest/gtest.h>

namespace sightline::culling {
namespace {

TEST(FocusBudget, AsksForMoreObjectsWhereTheyAreCheapOrWindowsAreDear) {
  FocusBudget dear(2.0), cheap(2.0), never(0.0);
  dear.view(1000.0, 10.0);
  cheap.view(1000.0, 100.0);
  never.view(1000.0, 10.0);
  EXPECT_LT(dear.minObjects(), cheap.minObjects());
  EXPECT_GT(never.minObjects(), 1e9);
  const double before = cheap.minObjects();
  cheap.drawn(100'000.0);
  EXPECT_GT(cheap.minObjects(), before);
  EXPECT_LT(cheap.left(), 0.0);
  for (int view = 0; view < 1000; ++view) {
    cheap.view(1000.0, 100.0);
    cheap.idle();
  }
  EXPECT_NEAR(cheap.minObjects(), before, 1.0) << "what windows cost is forgotten";
  EXPECT_GT(cheap.left(), 0.0);
}

TEST(FocusBudget, GivesAWindowNoMoreThanItsObjectsAreWorthAndThanAViewCosts) {
  FocusBudget budget(1.0);
  budget.view(1000.0, 100.0);
  EXPECT_EQ(budget.left(), 1000.0);
  EXPECT_LT(budget.left(5.0), 500.0);
  EXPECT_GE(budget.left(5.0), 50.0) << "what five objects cost in the view";
  EXPECT_EQ(budget.left(10.0), 2.0 * budget.left(5.0));
  EXPECT_EQ(budget.left(1e6), 1000.0);
  budget.drawn(980.0);
  EXPECT_EQ(budget.left(), 20.0);
  EXPECT_EQ(budget.left(5.0), 20.0);
}

}  // namespace
}  // namespace sightline::culling
