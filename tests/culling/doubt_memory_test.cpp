#include "src/culling/doubt_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace sightline::culling {
namespace {

// Views until the object is looked at again.
std::uint32_t viewsOfRest(DoubtMemory& memory, ObjectId object) {
  std::uint32_t views = 0;
  for (; memory.rests(object) && views < 1000; ++views) {
    memory.beginView();
  }
  return views;
}

const ObjectId kObject(std::uint32_t{5});

TEST(DoubtMemory, LetsWhatCouldBeSeenRestLongerEachTime) {
  DoubtMemory memory(8);
  std::uint32_t last = 3, last_chance = memory.chance(kObject);
  for (int time = 0; time < 6; ++time) {
    memory.seen(kObject);
    const std::uint32_t views = viewsOfRest(memory, kObject);
    EXPECT_GT(views, last);
    EXPECT_LT(memory.chance(kObject), last_chance);
    last = views;
    last_chance = memory.chance(kObject);
  }
  for (int time = 0; time < 3; ++time) {
    memory.seen(kObject);
    EXPECT_GE(viewsOfRest(memory, kObject), 128u);
    memory.seen(kObject);
    EXPECT_LE(viewsOfRest(memory, kObject), 135u);
  }
  EXPECT_GT(memory.chance(kObject), 0u);
}

TEST(DoubtMemory, LooksAgainAtWhatWasHiddenAndSoonAtWhatItCouldSeeOnceAfterThat) {
  DoubtMemory memory(8);
  for (int time = 0; time < 6; ++time) {
    memory.seen(kObject);
  }
  memory.hidden(kObject);
  EXPECT_TRUE(memory.wasHidden(kObject));
  EXPECT_FALSE(memory.rests(kObject));
  EXPECT_EQ(memory.chance(kObject), DoubtMemory::kCertain);
  memory.seen(kObject);
  EXPECT_FALSE(memory.wasHidden(kObject));
  const std::uint32_t views = viewsOfRest(memory, kObject);
  EXPECT_GE(views, 2u);
  EXPECT_LE(views, 9u);
}

TEST(DoubtMemory, LetsWhatShowsInManyPixelsRestForTwentyViewsAlsoIfItWasHidden) {
  for (const bool was_hidden : {false, true}) {
    DoubtMemory memory(8);
    const std::uint32_t untried = memory.chance(kObject);
    if (was_hidden) {
      memory.hidden(kObject);
    }
    memory.showsClearly(kObject);
    EXPECT_FALSE(memory.wasHidden(kObject));
    EXPECT_EQ(memory.chance(kObject), untried);
    const std::uint32_t views = viewsOfRest(memory, kObject);
    EXPECT_GE(views, 20u);
    EXPECT_LE(views, 27u);
  }
}

TEST(DoubtMemory, KeepsWhatIsKnownOfAnObjectThatShowsInManyPixelsForAWhile) {
  DoubtMemory memory(8);
  memory.seen(kObject);
  memory.seen(kObject);
  const std::uint32_t chance = memory.chance(kObject);
  memory.showsClearly(kObject);
  EXPECT_EQ(memory.chance(kObject), chance);
}

TEST(DoubtMemory, LetsObjectsThatWereLookedAtTogetherReturnInDifferentViews) {
  DoubtMemory memory(8);
  for (std::uint32_t i = 0; i < 8; ++i) {
    memory.showsClearly(ObjectId(i));
  }
  std::vector<std::uint32_t> back;
  for (std::uint32_t i = 0; i < 8; ++i) {
    DoubtMemory copy = memory;
    back.push_back(viewsOfRest(copy, ObjectId(i)));
  }
  std::sort(back.begin(), back.end());
  EXPECT_EQ(std::unique(back.begin(), back.end()), back.end());
}

// After the largest number of a view comes 0.
TEST(DoubtMemory, CountsViewsBeyondTheLargestNumber) {
  for (const std::uint32_t before : {0u, 1u, 10u, 40u, 200u}) {
    DoubtMemory memory(8, std::numeric_limits<std::uint32_t>::max() - before);
    memory.seen(kObject);
    for (int view = 0; view < 400; ++view) {
      EXPECT_FALSE(memory.rests(ObjectId(std::uint32_t{1}))) << "never looked at; view " << view;
      EXPECT_EQ(memory.rests(kObject), view < 4 + 5) << "view " << view;
      memory.beginView();
    }
  }
}

TEST(DoubtMemory, WithoutObjectsTakesAllForNeverTried) {
  DoubtMemory memory(0);
  const std::uint32_t untried = DoubtMemory(1).chance(ObjectId(std::uint32_t{0}));
  const auto expectUntried = [&] {
    EXPECT_FALSE(memory.rests(kObject));
    EXPECT_FALSE(memory.wasHidden(kObject));
    EXPECT_EQ(memory.chance(kObject), untried);
  };
  memory.hidden(kObject);
  expectUntried();
  memory.seen(kObject);
  expectUntried();
  memory.showsClearly(kObject);
  expectUntried();
  memory.beginView();
  expectUntried();
}

}  // namespace
}  // namespace sightline::culling
