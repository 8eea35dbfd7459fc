// Proofs where rounding would decide wrongly: huge and tiny triangles, nearly parallel lines, axes that are
// off by single-precision rounding.

#include <gtest/gtest.h>

#include <array>

#include "oracle/exact_visibility.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

Verdict verdictOf(const Scene& scene, const View& view, std::uint32_t object) {
  const ObjectId id(object);
  return ExactVisibility(scene.view()).decide(view, {&id, 1}, 20'000)[0].verdict;
}

bool confirms(const Scene& scene, const View& view, std::uint32_t object, const Vec3d& point) {
  return ExactVisibility(scene.view()).confirm(view, {ObjectId(object), point});
}

void addTriangle(Scene& scene, MaterialId material, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  addTriangles(scene, material, std::array<Vec3f, 3>{a, b, c});
}

TEST(ProofLimits, AHugeWallIsSeenWhoseCornersHaveNearlyNoDepth) {
  for (const auto& [z, size] : {std::pair{-1.0f, 2e9f}, std::pair{-1e-3f, 1e6f}}) {
    Scene scene;
    addWall(scene, addMaterial(scene, Opacity::kOpaque, true), z, -size, size, -size, size);
    View view = frontView();
    view.z_near = 1e-4;
    EXPECT_EQ(verdictOf(scene, view, 0), Verdict::kVisible) << size;
  }
}

TEST(ProofLimits, AContactIsSeenInASinglePointThatSliversLeave) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, material, -10, -4, 5, -3, 3);
  for (const float up : {8.0f, -8.0f}) {  // two slopes that touch the wall along y = 0
    addTriangle(scene, material, {-20, 0, -10}, {20, 0, -10}, {20, up, -5});
    addTriangle(scene, material, {-20, 0, -10}, {20, up, -5}, {-20, up, -5});
  }
  EXPECT_EQ(verdictOf(scene, frontView(), 0), Verdict::kVisible);
  for (const float end : {20.0f, -20.0f}) {  // cover that line but for the point where they touch the wall
    addTriangle(scene, material, {1, 0, -10}, {end, -1e-5f, -9}, {end, 1e-5f, -9});
  }
  EXPECT_TRUE(confirms(scene, frontView(), 0, {1, 0, -10}));
  EXPECT_EQ(verdictOf(scene, frontView(), 0), Verdict::kVisible);
  addTriangle(scene, material, {0, -1e-5f, -9}, {2, -1e-5f, -9}, {1, 1e-5f, -9});
  EXPECT_EQ(verdictOf(scene, frontView(), 0), Verdict::kHidden);
}

TEST(ProofLimits, AxesThatAreOffBySinglePrecisionMoveNoLineOfSight) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, material, -5, -4, 1, -4, 4);
  addWall(scene, material, -10, -4, 1.99999f, -1,
          1);  // its edge is behind the wall's, which hides up to x = 2
  View view = frontView();
  view.right.x = 1.0 + 4e-7;
  ASSERT_TRUE(validate(view));
  EXPECT_FALSE(confirms(scene, view, 1, {1.999989, 0.1, -10}));
  EXPECT_EQ(verdictOf(scene, view, 1), Verdict::kHidden);
}

TEST(ProofLimits, ATinyTriangleHidesATinyOne) {
  for (const float size : {1e-3f, 1e-8f, 1e-16f, 1e-20f}) {
    Scene scene;
    const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
    addTriangle(scene, material, {-size, -size, -9}, {3 * size, -size, -9}, {-size, 3 * size, -9});
    addTriangle(scene, material, {0, 0, -10}, {size, 0, -10}, {0, size, -10});
    View view;
    setOrientation(view, {0.3, 0.1, -0.9}, {0, 1, 0});
    view.tan_half_fovy = 1;
    view.aspect = 1;
    EXPECT_EQ(verdictOf(scene, view, 1), Verdict::kHidden) << size;
  }
}

// The target's upper edge and the line where a slope crosses it are almost parallel, so that their rounded
// intersection is anywhere. A row of walls hides both.
TEST(ProofLimits, LinesThatAreNearlyParallelIntersectWhereTheyDo) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addTriangle(scene, material, {-5, -3e-15f, -10}, {5, 1e-15f, -10}, {0, -3, -10});
  addTriangle(scene, material, {-40, 0, -10}, {40, 0, -10}, {0, -30, -4});
  for (int i = -60; i < 60; ++i) {
    const float x = 0.1f * static_cast<float>(i), next = 0.1f * static_cast<float>(i + 1);
    addWall(scene, material, -9.9f, x, next, -0.01f, 0.01f);
  }
  const ExactVisibility exact(scene.view());
  for (int i = 0; i < 50; ++i) {
    View view;
    view.eye = {0.1 + 0.003 * i, 0.2 - 0.002 * i, 0.3 + 0.001 * i};
    setOrientation(view, {0.03, -0.02, -1}, {0.1, 1, 0});
    view.tan_half_fovy = 1;
    view.aspect = 1;
    const ObjectId target(0u);
    const Decision decision = exact.decide(view, {&target, 1}, 20'000)[0];
    EXPECT_EQ(decision.verdict, Verdict::kHidden) << i;
  }
}

TEST(ProofLimits, SkewedAxesOfAnOrthographicViewAreTakenInOneWay) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -1000, -1.0f, -0.9999f, -1, 1);
  View view = frontView();
  view.orthographic = true;
  view.ortho_height = 2;
  view.z_far = 3000;
  view.aspect = 1;
  view.right = {1, 0, 9e-7};
  ASSERT_TRUE(validate(view));
  EXPECT_EQ(verdictOf(scene, view, 0) == Verdict::kVisible, confirms(scene, view, 0, {-0.9999, 0, -1000}));
}

// right and up decide what lies on one line of sight, as in the picture of clipFromScene(): with a right of
// (1, 0, skew), an edge at x = 0 and a depth of 1 appears where x = 10,000 skew has a depth of 10,001.
TEST(ProofLimits, SkewedAxesOfAnOrthographicViewSeeWhatThePictureShows) {
  for (const double skew : {9e-7, -9e-7}) {
    for (const float middle : {0.004f, 0.008f, 0.01f, 0.014f, -0.004f, -0.008f, -0.01f, -0.014f}) {
      Scene scene;
      const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
      addWall(scene, material, -1, -1, 0, -1, 1);
      addWall(scene, material, -10001, middle - 0.0001f, middle + 0.0001f, -0.1f, 0.1f);
      View view = frontView();
      view.orthographic = true;
      view.ortho_height = 1;
      view.aspect = 1;
      view.z_near = 0;
      view.z_far = 2e4;
      view.right = {1, 0, skew};
      ASSERT_TRUE(validate(view));
      const bool shows = static_cast<double>(middle) > 1e4 * skew;
      EXPECT_EQ(verdictOf(scene, view, 1), shows ? Verdict::kVisible : Verdict::kHidden)
          << skew << ' ' << middle;
      EXPECT_EQ(confirms(scene, view, 1, {static_cast<double>(middle), 0, -10001}), shows)
          << skew << ' ' << middle;
    }
  }
}

TEST(ProofLimits, WhatIsMarkedNeverToOccludeHidesNothing) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, material, -5, -4, 4, -4, 4);
  addWall(scene, material, -10, -1, 1, -1, 1);
  EXPECT_EQ(verdictOf(scene, frontView(), 1), Verdict::kHidden);
  scene.objects[0].mark = OccluderMark::kNever;
  EXPECT_EQ(verdictOf(scene, frontView(), 1), Verdict::kVisible);
  EXPECT_TRUE(confirms(scene, frontView(), 1, {0.1, 0.2, -10}));
  EXPECT_EQ(ExactVisibility(scene.view()).visibleThroughPixels(frontView(), 64, 64).size(), 2u);
}

}  // namespace
}  // namespace sightline
