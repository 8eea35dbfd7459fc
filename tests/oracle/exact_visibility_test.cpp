#include "oracle/exact_visibility.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

struct Fixture {
  Scene scene;
  View view = frontView();

  std::vector<ObjectId> seen() const {
    const ExactVisibility oracle(scene.view());
    std::vector<ObjectId> ids;
    for (const SeenPoint& witness : oracle.visibleThroughPixels(view, 64, 64)) {
      ids.push_back(witness.object);
      EXPECT_TRUE(oracle.confirm(view, witness)) << "object " << witness.object.value;
    }
    return ids;
  }
  std::vector<ObjectId> reached(std::uint32_t samples = 16) const {
    const ExactVisibility oracle(scene.view());
    std::vector<ObjectId> all, ids;
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      all.push_back(ObjectId(o));
    }
    for (const SeenPoint& witness : oracle.visibleByAimedRays(view, all, samples)) {
      ids.push_back(witness.object);
      EXPECT_TRUE(oracle.confirm(view, witness)) << "object " << witness.object.value;
    }
    return ids;
  }
};

using Ids = std::vector<ObjectId>;
constexpr ObjectId kFirst(std::uint32_t(0)), kSecond(std::uint32_t(1)), kThird(std::uint32_t(2));

TEST(ExactVisibility, AWallHidesWhatIsBehindIt) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -4, 4, -4, 4);
  addWall(f.scene, opaque, -10, -1, 1, -1, 1);
  EXPECT_EQ(f.seen(), Ids({kFirst}));
  EXPECT_EQ(f.reached(64), Ids({kFirst}));
}

TEST(ExactVisibility, WhatLooksOutBesideAWallIsSeen) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -4, 0.25f, -4, 4);
  addWall(f.scene, opaque, -10, -1, 1, -1, 1);
  EXPECT_EQ(f.seen(), Ids({kFirst, kSecond}));
  EXPECT_EQ(f.reached(64), Ids({kFirst, kSecond}));
}

TEST(ExactVisibility, TheBackOfASingleSidedWallIsNotThere) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -4, 4, -4, 4, true);
  addWall(f.scene, opaque, -10, -1, 1, -1, 1);
  EXPECT_EQ(f.seen(), Ids({kSecond}));
  EXPECT_EQ(f.reached(), Ids({kSecond}));
}

TEST(ExactVisibility, TheBackOfADoubleSidedWallHides) {
  Fixture f;
  addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, true), -5, -4, 4, -4, 4, true);
  addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, false), -10, -1, 1, -1, 1);
  EXPECT_EQ(f.seen(), Ids({kFirst}));
  EXPECT_EQ(f.reached(64), Ids({kFirst}));
}

TEST(ExactVisibility, SeeThroughSurfacesAreSeenAndHideNothing) {
  for (const Opacity opacity : {Opacity::kBlended, Opacity::kAlphaTested}) {
    Fixture f;
    const MaterialId glass = addMaterial(f.scene, opacity, false);
    addWall(f.scene, glass, -5, -4, 4, -4, 4);
    addWall(f.scene, glass, -6, -4, 4, -4, 4);
    addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, false), -10, -1, 1, -1, 1);
    EXPECT_EQ(f.seen(), Ids({kFirst, kSecond, kThird}));
    EXPECT_EQ(f.reached(), Ids({kFirst, kSecond, kThird}));
  }
}

TEST(ExactVisibility, GlassBehindAWallOrSeenFromItsBackIsNotSeen) {
  Fixture f;
  const MaterialId glass = addMaterial(f.scene, Opacity::kBlended, false);
  addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, false), -5, -4, 4, -4, 4);
  addWall(f.scene, glass, -6, -4, 4, -4, 4);
  addWall(f.scene, glass, -4, -4, 4, -4, 4, true);
  EXPECT_EQ(f.seen(), Ids({kFirst}));
  EXPECT_EQ(f.reached(64), Ids({kFirst}));
}

TEST(ExactVisibility, WhatTheNearPlaneClipsAwayIsNotSeenAndHidesNothing) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, true);
  addWall(f.scene, opaque, -5, -8, 8, -8, 8);
  addWall(f.scene, opaque, -10, -1, 1, -1, 1);
  f.view.z_near = 5.5;
  EXPECT_EQ(f.seen(), Ids({kSecond}));
  EXPECT_EQ(f.reached(), Ids({kSecond}));
}

// Rays towards the border are longer than those in the middle; the distance along `forward` must count.
TEST(ExactVisibility, TheFarPlaneIsAPlaneNotASphere) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -10, 9, 9.9f, 9, 9.9f);
  addWall(f.scene, opaque, -10.2f, -1, 1, -1, 1);
  f.view.z_far = 10.1;
  EXPECT_EQ(f.seen(), Ids({kFirst}));
  EXPECT_EQ(f.reached(), Ids({kFirst}));
}

TEST(ExactVisibility, OrthographicRaysAreParallel) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -1, 1, -1, 1);
  addWall(f.scene, opaque, -50, -0.9f, 0.9f, -0.9f, 0.9f);  // hidden; it would be hidden in perspective too
  addWall(f.scene, opaque, -90, 1.5f, 1.9f, -0.5f, 0.5f);   // beside the shadow
  addWall(f.scene, opaque, -5, 2.1f, 3, -1, 1);             // outside the volume
  f.view.orthographic = true;
  f.view.ortho_height = 4.0;
  EXPECT_EQ(f.seen(), Ids({kFirst, kThird}));
  EXPECT_EQ(f.reached(64), Ids({kFirst, kThird}));
}

// A direction is rounded to a part of the picture's size, so it hardly tells where it meets small walls in a
// high picture.
TEST(ExactVisibility, PicturesOfAnyHeightShowTheSame) {
  for (const double height : {0.1, 1e3, 1e9, 1e12, 1e14, 1e16}) {
    for (int turn = 0; turn < 20; ++turn) {
      Fixture f;
      const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, true);
      addWall(f.scene, opaque, -0.01f, -0.001f, 0.001f, -0.001f, 0.001f);
      addWall(f.scene, opaque, -0.0105f, -0.0001f, 0.0001f, -0.0001f, 0.0001f);
      f.view.orthographic = true;
      f.view.ortho_height = height;
      f.view.eye = {1e-4 * turn, 0.0023, -1e-3};
      f.view.z_near = 1e-4;
      setOrientation(f.view, {0.37 - 0.03 * turn, -0.017 * turn, -1.0}, {0, 1, 0});
      const ExactVisibility oracle(f.scene.view());
      const std::array<ObjectId, 2> both{kFirst, kSecond};
      const std::vector<Decision> decisions = oracle.decide(f.view, both, 100'000);
      EXPECT_EQ(decisions[0].verdict, Verdict::kVisible) << height << " " << turn;
      EXPECT_EQ(decisions[1].verdict, Verdict::kHidden) << height << " " << turn;
    }
  }
}

// So far away, single precision cannot follow rays.
TEST(ExactVisibility, EyesAsFarAwayAsAnyNumberSeeNothingByRays) {
  Fixture f;
  addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, true), -10, -5, 5, -5, 5);
  addWall(f.scene, addMaterial(f.scene, Opacity::kBlended, true), -9, -5, 5, -5, 5);
  for (const double far_away : {1.7e18, 1.9e18, 1e37, 1e40, 1e300}) {
    f.view.eye = {0, 0, far_away};
    f.view.z_far = 2.0 * far_away;
    const ExactVisibility oracle(f.scene.view());
    EXPECT_TRUE(oracle.visibleThroughPixels(f.view, 8, 8).empty()) << far_away;
  }
}

TEST(ExactVisibility, ObjectsWithoutTrianglesOrWithNonFiniteOnesDoNotCount) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addTriangles(f.scene, opaque, {});
  const std::array<Vec3f, 3> broken{Vec3f(-9, -9, -3), Vec3f(9, -9, -3), Vec3f(0, std::nanf(""), -3)};
  addTriangles(f.scene, opaque, broken);
  addWall(f.scene, opaque, -10, -1, 1, -1, 1);
  EXPECT_EQ(f.seen(), Ids({kThird}));
  EXPECT_EQ(f.reached(), Ids({kThird}));
}

TEST(ExactVisibility, AnEmptySceneShowsNothing) {
  const Fixture f;
  EXPECT_EQ(f.seen(), Ids());
  EXPECT_EQ(f.reached(), Ids());
}

TEST(ExactVisibility, PixelsShowingAnObjectAreAllOfThem) {
  Fixture f;
  addWall(f.scene, addMaterial(f.scene, Opacity::kOpaque, false), -10, -5, 5, -5, 5);
  const ExactVisibility oracle(f.scene.view());
  const std::vector<SeenPoint> pixels = oracle.pixelsShowing(kFirst, f.view, 40, 40);
  EXPECT_EQ(pixels.size(), 400u);
  EXPECT_EQ(pixels.front(), oracle.visibleThroughPixels(f.view, 40, 40).front());
}

// A wall of two triangles: a point far behind it, on the ray through the diagonal, must never be reported as
// visible.
TEST(ExactVisibility, AnEdgeSharedByTrianglesIsNoGapForConfirm) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -3, -1.1f, 1.3f, -1.7f, 1.9f);
  addWall(f.scene, opaque, -50, -5, 5, -5, 5);
  const ExactVisibility oracle(f.scene.view());
  for (int i = 1; i < 1000; ++i) {
    const float s = static_cast<float>(i) / 1000.0f;
    const Vec3d on_diagonal(-1.1f + s * 2.4f, -1.7f + s * 3.6f, -3.0);
    const SeenPoint behind{kSecond, on_diagonal * (50.0 / 3.0)};
    EXPECT_FALSE(oracle.confirm(f.view, behind)) << i;
  }
}

TEST(ExactVisibility, ConfirmRefusesWhatIsHiddenByAHairAndAllowsTies) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -4, 4, -4, 4);
  addWall(f.scene, opaque, std::nextafter(-5.0f, -6.0f), -1, 1, -1, 1);
  addWall(f.scene, opaque, -5, -1, 1, -1, 1);
  const ExactVisibility oracle(f.scene.view());
  EXPECT_FALSE(oracle.confirm(f.view, {kSecond, {0.1, 0.2, -5.0}}));
  EXPECT_TRUE(oracle.confirm(f.view, {kThird, {0.1, 0.2, -5.0}}));
  EXPECT_TRUE(oracle.confirm(f.view, {kFirst, {0.1, 0.2, -5.0}}));
  EXPECT_FALSE(oracle.confirm(f.view, {kFirst, {0.1, 0.2, 5.0}})) << "behind the eye";
  EXPECT_FALSE(oracle.confirm(f.view, {kThird, {3.1, 0.2, -5.0}})) << "beside the object";
}

// A slit of a thousandth of a pixel: no pixel's ray passes through, but it is a real gap.
TEST(ExactVisibility, ConfirmSeesThroughAGapThatPixelsMiss) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false);
  addWall(f.scene, opaque, -5, -6, 0.001f, -6, 6);
  addWall(f.scene, opaque, -5, 0.00105f, 6, -6, 6);
  addWall(f.scene, opaque, -50, -9, 9, -9, 9);
  EXPECT_EQ(f.seen(), Ids({kFirst, kSecond}));
  const ExactVisibility oracle(f.scene.view());
  EXPECT_TRUE(oracle.confirm(f.view, {kThird, {0.010250001, 1.0, -50.0}}));
}

void fourThreads(std::uint32_t count, const RangeBody& body) {
  std::vector<std::thread> threads;
  const std::uint32_t step = count / 4 + 1;
  for (std::uint32_t begin = 0; begin < count; begin += step) {
    threads.emplace_back([&body, begin, end = std::min(count, begin + step)] { body(begin, end); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST(ExactVisibility, TheNumberOfThreadsChangesNothing) {
  Fixture f;
  const MaterialId opaque = addMaterial(f.scene, Opacity::kOpaque, false),
                   glass = addMaterial(f.scene, Opacity::kBlended, true);
  std::vector<ObjectId> all;
  for (int i = 0; i < 60; ++i) {
    const auto x = static_cast<float>((i * 37) % 41 - 20), y = static_cast<float>((i * 23) % 31 - 15);
    all.push_back(addWall(f.scene, i % 3 == 0 ? glass : opaque, -10.0f - static_cast<float>(i % 17), x, x + 5,
                          y, y + 4));
  }
  const ExactVisibility oracle(f.scene.view());
  EXPECT_EQ(oracle.visibleThroughPixels(f.view, 111, 77),
            oracle.visibleThroughPixels(f.view, 111, 77, fourThreads));
  EXPECT_EQ(oracle.visibleByAimedRays(f.view, all, 20),
            oracle.visibleByAimedRays(f.view, all, 20, fourThreads));
  EXPECT_EQ(oracle.pixelsShowing(kThird, f.view, 111, 77),
            oracle.pixelsShowing(kThird, f.view, 111, 77, fourThreads));
}

}  // namespace
}  // namespace sightline
