// Whether bounding boxes of objects are visible, in scenes with answers that are known.

#include <gtest/gtest.h>

#include "oracle/exact_visibility.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

constexpr std::uint32_t kStepsForBoxes = 1000;

class BoxVisibility : public ::testing::Test {
 protected:
  void SetUp() override {
    opaque_ = addMaterial(scene_, Opacity::kOpaque, true);
    glass_ = addMaterial(scene_, Opacity::kBlended, true);
  }
  // One triangle whose bounding box lies between the corners.
  ObjectId addDiagonal(const Vec3f& low, const Vec3f& high) {
    const Vec3f corners[] = {low, high, {low.x, high.y, high.z}};
    return addTriangles(scene_, opaque_, corners);
  }
  Decision ofBox(ObjectId object, const View& view = frontView(),
                 std::uint32_t steps = kStepsForBoxes) const {
    return ExactVisibility(scene_.view()).decideBoxes(view, std::vector{object}, steps).front();
  }
  Verdict ofObject(ObjectId object) const {
    return ExactVisibility(scene_.view())
        .decide(frontView(), std::vector{object}, kStepsForBoxes)
        .front()
        .verdict;
  }

  Scene scene_;
  MaterialId opaque_, glass_;
};

// The wall hides x < 1 at its distance, and so x < 2 at twice that distance.
TEST_F(BoxVisibility, ABoxShowsByACornerWhoseObjectIsHidden) {
  addWall(scene_, opaque_, -5, -4, 1, -4, 4);
  const Vec3f corners[] = {{-1, -1, -10}, {1, -1, -10}, {2.5f, 1, -13}};
  const ObjectId object = addTriangles(scene_, opaque_, corners);
  EXPECT_EQ(ofObject(object), Verdict::kHidden);
  const Decision decision = ofBox(object);
  ASSERT_EQ(decision.verdict, Verdict::kVisible);
  EXPECT_EQ(decision.witness.object, object);
  EXPECT_GE(decision.witness.point.x, 2.0 * -decision.witness.point.z / 10.0 - 1e-9) << "beside the wall";
  EXPECT_LE(decision.witness.point.x, 2.5);
}

TEST_F(BoxVisibility, AWallHidesABoxUpToTheLastThousandth) {
  addWall(scene_, opaque_, -5, -1, 1, -1, 1);
  const ObjectId fits = addDiagonal({-1.999f, -1.999f, -12}, {1.999f, 1.999f, -10});
  const ObjectId looks_out = addDiagonal({-1.999f, -1.999f, -12}, {2.001f, 1.999f, -10});
  EXPECT_EQ(ofBox(fits).verdict, Verdict::kHidden);
  EXPECT_EQ(ofBox(looks_out).verdict, Verdict::kVisible);
}

TEST_F(BoxVisibility, WhatIsSeeThroughHidesNoBox) {
  addWall(scene_, glass_, -5, -4, 4, -4, 4);
  EXPECT_EQ(ofBox(addDiagonal({-1, -1, -12}, {1, 1, -10})).verdict, Verdict::kVisible);
}

TEST_F(BoxVisibility, AnObjectHidesNoneOfItsOwnBox) {
  const ObjectId object = addDiagonal({-1, -1, -12}, {1, 1, -10});
  const ObjectId inside = addDiagonal({-0.5f, -0.5f, -11.5f}, {0.5f, 0.5f, -11});
  addWall(scene_, opaque_, -10, -1, 1, -1, 1);
  EXPECT_EQ(ofBox(object).verdict, Verdict::kVisible) << "the wall touches the side of the box";
  EXPECT_EQ(ofBox(inside).verdict, Verdict::kHidden);
}

TEST_F(BoxVisibility, FlatBoxesAreDecidedToo) {
  addWall(scene_, opaque_, -5, -1, 1, -1, 1);
  EXPECT_EQ(ofBox(addWall(scene_, opaque_, -10, -1.9f, 1.9f, -1.9f, 1.9f)).verdict, Verdict::kHidden);
  EXPECT_EQ(ofBox(addWall(scene_, opaque_, -10, -1.9f, 2.1f, -1.9f, 1.9f)).verdict, Verdict::kVisible);
  const Vec3f across[] = {{1.5f, -1, -20}, {1.5f, 1, -10}, {1.5f, 1, -20}};
  EXPECT_EQ(ofBox(addTriangles(scene_, opaque_, across)).verdict, Verdict::kHidden) << "seen from one side";
  const Vec3f in_plane_of_eye[] = {{0, -20, -20}, {0, 20, -10}, {0, 20, -20}};
  EXPECT_EQ(ofBox(addTriangles(scene_, opaque_, in_plane_of_eye)).verdict, Verdict::kHidden) << "edge on";
}

TEST_F(BoxVisibility, ABoxAroundTheEyeIsVisibleBehindAnyWall) {
  addWall(scene_, opaque_, -0.5f, -4, 4, -4, 4);
  const Vec3f around[] = {{-9, -9, 9}, {9, 9, -9}, {-9, 9, -9}};
  const ObjectId object = addTriangles(scene_, opaque_, around);
  EXPECT_EQ(ofBox(object).verdict, Verdict::kVisible);
  View view = frontView();
  for (const double near : {0.0, 0.25, 0.499}) {
    view.z_near = near;
    EXPECT_EQ(ofBox(object, view).verdict, Verdict::kVisible) << near;
  }
  view.orthographic = true;
  EXPECT_EQ(ofBox(object, view).verdict, Verdict::kVisible);
}

// Both boxes cross the plane of the near plane. One of them does so inside the picture, the other one beside
// it and is seen, if at all, farther away.
TEST_F(BoxVisibility, ABoxOnTheNearPlaneIsVisibleOnlyWithinThePicture) {
  addWall(scene_, opaque_, -2, -9, 9, -9, 9);
  View view = frontView();
  view.z_near = 1.0;
  const ObjectId inside = addDiagonal({0.5f, -1, -9}, {0.75f, 1, 0.5f}),
                 beside = addDiagonal({2.5f, -1, -9}, {2.75f, 1, 0.5f});
  EXPECT_EQ(ofBox(inside, view).verdict, Verdict::kVisible);
  EXPECT_EQ(ofBox(beside, view).verdict, Verdict::kHidden);
  EXPECT_EQ(ofBox(addDiagonal({1.5f, -1, -9}, {2.5f, 1, 0.5f}), view).verdict, Verdict::kVisible)
      << "before the wall, where the picture is wider";
}

TEST_F(BoxVisibility, OutsideTheViewABoxIsHidden) {
  EXPECT_EQ(ofBox(addDiagonal({11, -1, -10}, {13, 1, -9})).verdict, Verdict::kHidden) << "beside";
  EXPECT_EQ(ofBox(addDiagonal({-1, -1, 2}, {1, 1, 3})).verdict, Verdict::kHidden) << "behind";
  EXPECT_EQ(ofBox(addDiagonal({-1, -1, -150}, {1, 1, -101})).verdict, Verdict::kHidden) << "beyond far";
  EXPECT_EQ(ofBox(addDiagonal({-1, -1, -150}, {1, 1, -99})).verdict, Verdict::kVisible);
}

TEST_F(BoxVisibility, WithoutStepsNothingIsDecidedThatNeedsOne) {
  const ObjectId object = addDiagonal({-1, -1, -12}, {1, 1, -10});
  EXPECT_EQ(ofBox(object, frontView(), 0).verdict, Verdict::kUndecided);
}

TEST_F(BoxVisibility, ABoxThatIsNotFiniteIsVisibleUnlessItHoldsNothing) {
  const ObjectId object = addDiagonal({-1, -1, 2}, {1, 1, 3});
  scene_.objects[object.value].bounds.max.x = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ofBox(object).verdict, Verdict::kVisible);
  EXPECT_EQ(ofBox(addTriangles(scene_, opaque_, {})).verdict, Verdict::kHidden);
}

}  // namespace
}  // namespace sightline
