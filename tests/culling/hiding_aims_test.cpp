#include "src/culling/hiding_aims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sightline::culling {
namespace {

constexpr std::size_t kObjects = 200;

// The box of an object has its number as its least x.
std::vector<Box> numberedBoxes() {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < kObjects; ++i) {
    const auto x = static_cast<float>(i);
    boxes.push_back({Vec3f(x, 0, 0), Vec3f(x + 1, 1, 1)});
  }
  return boxes;
}
std::vector<ObjectId> numbers(std::size_t first, std::size_t end) {
  std::vector<ObjectId> objects;
  for (std::size_t i = first; i < end; ++i) {
    objects.push_back(ObjectId(i));
  }
  return objects;
}
std::vector<ObjectId> objectsOf(std::span<const Box> boxes) {
  std::vector<ObjectId> objects;
  for (const Box& box : boxes) {
    objects.push_back(ObjectId(static_cast<std::size_t>(box.min.x)));
  }
  std::ranges::sort(objects);
  return objects;
}

class HidingAimsTest : public testing::Test {
 protected:
  HidingAimsTest() : bounds_(numberedBoxes()), aims_(kObjects) {}

  // A view that shows these objects and hides none of them.
  std::uint32_t view(const std::vector<ObjectId>& shown, const std::vector<ObjectId>& news, double drawn,
                     std::uint32_t left = 60000) {
    aims_.beginView(false);
    const std::uint32_t work =
        aims_.aimAtShown(shown, news, drawn, left, [this](ObjectId object) { return bounds_[object.value]; });
    aimed_at_ = objectsOf(aims_.boxes());
    aims_.endView(shown, news);
    return work;
  }

  std::vector<Box> bounds_;
  HidingAims<ObjectId> aims_;
  std::vector<ObjectId> aimed_at_;
};

TEST_F(HidingAimsTest, FirstComesWhatTheLastViewHid) {
  aims_.beginView(false);
  EXPECT_TRUE(aims_.boxes().empty());
  const Box box{Vec3f(50, 0, 0), Vec3f(60, 1, 1)};
  aims_.aimAtHidden({&box, 1}, numbers(3, 5), [this](ObjectId object) { return bounds_[object.value]; });
  EXPECT_EQ(objectsOf(aims_.boxes()), (std::vector{ObjectId(3u), ObjectId(4u), ObjectId(50u)}));
  aims_.beginView(false);
  EXPECT_TRUE(aims_.boxes().empty());
}

TEST_F(HidingAimsTest, WhatIsNewIsAimedAtAtOnceWhereLittleWasDrawn) {
  EXPECT_GT(view(numbers(0, 20), numbers(5, 8), 10.0), 0u);
  const std::vector<ObjectId> news = numbers(5, 8);
  EXPECT_TRUE(std::ranges::includes(aimed_at_, news));
  view(numbers(0, 1), {}, 1e6);
  EXPECT_TRUE(aimed_at_.empty()) << "and not in the next view";
}

TEST_F(HidingAimsTest, NoMoreIsSpentThanIsLeft) {
  EXPECT_EQ(view(numbers(0, 20), numbers(0, 20), 10.0, 0), 0u);
  EXPECT_EQ(view(numbers(0, 20), numbers(0, 20), 10.0, 7), 7u);
}

TEST_F(HidingAimsTest, WhatWasDrawnPutsOffWhatIsWorthLess) {
  // A single new object is worth less than a tenth of this.
  constexpr double kDrawn = 1500.0;
  int views = 1;
  while (view(numbers(0, 1), numbers(0, 1), kDrawn) == 0) {
    ASSERT_LT(++views, 1000);
  }
  EXPECT_GT(views, 10);
}

TEST_F(HidingAimsTest, WorkThatIsTooMuchForOneViewIsLeftToLaterOnes) {
  // Where little was drawn, and where much was.
  for (const double drawn : {100.0, 1200.0}) {
    aims_ = HidingAims<ObjectId>(kObjects);
    const std::uint32_t first = view(numbers(0, kObjects), numbers(0, kObjects / 2), drawn);
    EXPECT_GT(first, drawn);
    EXPECT_LE(first, std::max(2.0 * drawn, 2000.0));
    EXPECT_GT(view(numbers(0, kObjects), numbers(0, 1), drawn), 0.9 * first) << "one alone is worth less";
  }
}

TEST_F(HidingAimsTest, WhereMostIsNewAllThatIsLeftMayBeSpentAtOnce) {
  constexpr double kDrawn = 100.0;
  const std::size_t half = kObjects / 2;
  const std::uint32_t usual = view(numbers(0, kObjects), numbers(0, half), kDrawn);
  aims_ = HidingAims<ObjectId>(kObjects);
  EXPECT_GT(view(numbers(0, kObjects), numbers(0, half + 1), kDrawn), 2 * usual);
  aims_ = HidingAims<ObjectId>(kObjects);
  EXPECT_EQ(view(numbers(0, kObjects), numbers(0, half + 1), kDrawn, 2 * usual), 2 * usual);
}

TEST_F(HidingAimsTest, NotMuchIsSavedUp) {
  for (int i = 0; i < 200; ++i) {
    view(numbers(0, kObjects), numbers(0, kObjects), 500.0);
  }
  int views = 0;
  while (view(numbers(0, 1), numbers(0, 1), 500.0) > 0) {
    ASSERT_LT(++views, 4);
  }
}

TEST_F(HidingAimsTest, AfterAJumpKeptObjectsAreAimedAtInTheNextView) {
  for (int views_before = 0; views_before < 8; ++views_before) {
    aims_ = HidingAims<ObjectId>(kObjects);
    for (int i = 0; i < views_before; ++i) {
      view({}, {}, 1.0);
    }
    aims_.beginView(true);
    aims_.endView(numbers(0, 10), numbers(0, 10));
    EXPECT_GT(view(numbers(0, 10), {}, 1.0), 0u);
    EXPECT_EQ(aimed_at_, numbers(0, 10));
  }
}

TEST_F(HidingAimsTest, AJumpForgetsWhatWasSavedUp) {
  view(numbers(0, 20), numbers(0, 20), 10000.0);
  aims_.beginView(true);
  aims_.endView({}, {});
  EXPECT_EQ(view(numbers(0, 1), numbers(0, 1), 600.0), 0u);
}

TEST_F(HidingAimsTest, KeptObjectsAreAimedAtLessAndLessOften) {
  int early = 0, late = 0;
  for (int i = 0; i < 400; ++i) {
    const bool aims = view(numbers(0, 1), {}, 1.0) > 0;
    (i < 40 ? early : late) += aims ? 1 : 0;
  }
  EXPECT_GT(early, 2);
  EXPECT_GT(late, 0) << "they are not forgotten";
  EXPECT_LT(late, 9 * early) << "in nine times as many views";
}

TEST_F(HidingAimsTest, AnObjectThatComesBackIsNew) {
  for (int i = 0; i < 100; ++i) {
    view(numbers(0, 1), {}, 1.0);
  }
  EXPECT_GT(view(numbers(0, 1), numbers(0, 1), 1.0), 0u);
  EXPECT_EQ(aimed_at_, numbers(0, 1));
  // After that it rests for a short time alone.
  int views = 1;
  while (view(numbers(0, 1), {}, 1.0) == 0) {
    ASSERT_LT(++views, 20);
  }
}

}  // namespace
}  // namespace sightline::culling
