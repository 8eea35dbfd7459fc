#include "oracle/region_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

// Viewers are in a box of two metres before the walls; what they look for is behind, towards -z.
struct Claim {
  Scene scene;
  MaterialId opaque = addMaterial(scene, Opacity::kOpaque, true);
  EyeRegion region{{-1, -1, 0}, {1, 1, 2}, {}};
  ObjectId object;

  // A wall with an opening.
  void addWallWithHole(float z, float x0, float x1, float y0, float y1) {
    addWall(scene, opaque, z, -100, x0, -100, 100);
    addWall(scene, opaque, z, x1, 100, -100, 100);
    addWall(scene, opaque, z, x0, x1, -100, y0);
    addWall(scene, opaque, z, x0, x1, y1, 100);
  }
  void addObject(float z, float x0, float x1, float y0, float y1) {
    object = addWall(scene, opaque, z, x0, x1, y0, y1);
  }
  RegionAnswer search(const RegionSearchSettings& settings, std::uint64_t seed) const {
    return RegionSearch(scene.view()).contradict(region, object, settings, seed);
  }
};

// Tries as many random lines as the search may try lines in all, and nothing else.
RegionSearchSettings raysAlone() {
  const RegionSearchSettings all;
  return {.lines = all.lines + all.planes * all.plane_steps, .planes = 0, .eyes = 0};
}

void expectSeen(const Claim& claim, bool also_by_rays = false) {
  const ExactVisibility oracle(claim.scene.view());
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const RegionAnswer answer = claim.search({}, seed);
    ASSERT_TRUE(answer.found) << "seed " << seed;
    EXPECT_TRUE(claim.region.contains(answer.eye)) << "seed " << seed;
    EXPECT_EQ(answer.view.eye, answer.eye) << "seed " << seed;
    EXPECT_EQ(answer.witness.object, claim.object) << "seed " << seed;
    EXPECT_TRUE(oracle.confirm(answer.view, answer.witness)) << "seed " << seed;
    EXPECT_TRUE(also_by_rays || !claim.search(raysAlone(), seed).found) << "seed " << seed;
  }
}

void expectNotSeen(const Claim& claim, const RegionSearchSettings& settings = {}) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    EXPECT_FALSE(claim.search(settings, seed).found) << "seed " << seed;
  }
}

TEST(RegionSearch, SeesThroughASlitFromASmallPartOfTheRegion) {
  Claim claim;
  claim.addWallWithHole(-5, 0.3f, 0.3001f, -0.1f, 0.1f);
  claim.addObject(-50, 10.0f, 10.002f, -0.2f, 0.2f);
  expectSeen(claim);
}

TEST(RegionSearch, SeesThroughTwoSlitsInARow) {
  Claim claim;
  claim.addWallWithHole(-5, 0.3f, 0.3001f, -1, 1);
  claim.addWallWithHole(-8, 0.8f, 0.8001f, -1, 1);
  claim.addObject(-20, -50, 50, -50, 50);
  expectSeen(claim);
}

TEST(RegionSearch, SeesThroughTwoSlitsAcrossEachOther) {
  Claim claim;
  claim.addWallWithHole(-5, 0.3f, 0.3001f, -1, 1);
  claim.addWallWithHole(-8, -1, 1, -0.2f, -0.1999f);
  claim.addObject(-20, -50, 50, -50, 50);
  expectSeen(claim);
}

// Four surfaces around each of two openings of a thousandth of a metre: one line, but for that, passes both.
TEST(RegionSearch, SeesThroughTwoPinholesInARow) {
  Claim claim;
  const auto addPinhole = [&](float z, float x, float y) {
    const float x1 = x + 1e-3f, y1 = y + 1e-3f;
    addWall(claim.scene, claim.opaque, z, -60, x, -60, y1);
    addWall(claim.scene, claim.opaque, z, -60, x1, y1, 60);
    addWall(claim.scene, claim.opaque, z, x1, 60, y, 60);
    addWall(claim.scene, claim.opaque, z, x, 60, -60, y);
  };
  addPinhole(-5, 0.3f, 0.2f);
  addPinhole(-8, 0.5f, -0.2f);
  claim.addObject(-20, -3, 3, -3, 3);
  expectSeen(claim);
}

// The wall's border hides all but a millionth of a metre of the object, which only one border of the region
// looks at.
TEST(RegionSearch, SeesPastACorner) {
  Claim claim;
  addWall(claim.scene, claim.opaque, -4, 0, 100, -100, 100);
  claim.addObject(-8, 1.0f - 0x1p-20f, 3, -1, 1);
  expectSeen(claim);
  claim.addObject(-8, 1.0f + 0x1p-20f, 3, -1, 1);
  expectNotSeen(claim);
}

TEST(RegionSearch, SeesWhatOnlyACornerOfTheRegionSees) {
  Claim claim;
  // From (1, 1, 2), the line past x = 1.999 at the wall goes on to x = 2.71257; from elsewhere, farther.
  claim.addWallWithHole(-5, 1.999f, 2.1f, 1.999f, 2.1f);
  claim.addObject(-10, 2, 2.7126f, 2, 2.7126f);
  expectSeen(claim);
}

TEST(RegionSearch, SeesWhatIsSeenFromOneSideOfAPlane) {
  Claim claim;
  const double c = std::sqrt(0.5);
  claim.region.sides = {{{c, c, 0}, 1.4 * c}};
  claim.addWallWithHole(-5, 1.998f, 2.0f, -0.5f, 0.5f);
  claim.addObject(-10, 3.2f, 5, -0.5f, 0.5f);
  expectSeen(claim, true);
  claim.region.sides.push_back({{1, 0, 0}, 0.81});
  expectNotSeen(claim);
}

TEST(RegionSearch, SeesNothingBehindAWall) {
  Claim claim;
  addWall(claim.scene, claim.opaque, -5, -100, 0.1f, -100, 100);
  addWall(claim.scene, claim.opaque, -5, 0.1f, 100, -100, 100);
  claim.addObject(-10, -5, 5, -5, 5);
  expectNotSeen(claim);
}

TEST(RegionSearch, AnOpenDoorWithTheIndicesOfAWallLeavesTheWallClosed) {
  Claim claim;
  addWall(claim.scene, claim.opaque, -5, -100, 100, -100, 100);
  claim.addObject(-10, -5, 5, -5, 5);
  claim.scene.objects.push_back(claim.scene.objects.front());
  claim.scene.object_names.push_back("the wall's indices");
  claim.scene.objects.front().mark = OccluderMark::kNever;
  expectNotSeen(claim);
  std::swap(claim.scene.objects.front().mark, claim.scene.objects.back().mark);
  expectNotSeen(claim);
}

TEST(RegionSearch, WhatTheNearPlaneClipsHidesNothing) {
  Claim claim;
  addWall(claim.scene, claim.opaque, -0.5f, -100, 100, -100, 100);
  claim.addObject(-10, -5, 5, -5, 5);
  expectNotSeen(claim, {.near_distance = 0.4999});
  EXPECT_TRUE(claim.search({.near_distance = 0.51}, 1).found);
  EXPECT_TRUE(claim.search({.near_distance = 0.51, .lines = 0}, 1).found);
  // A wide picture's near plane is nearer than its corners.
  EXPECT_TRUE(claim.search({.near_distance = 0.7, .lines = 0, .planes = 0, .eyes = 8}, 1).found);
}

// Every face of the region looks at the object through glass; the object's front is turned away.
TEST(RegionSearch, BackFacesAreNotSeenAndSeeThroughOnesHideNothing) {
  Claim claim;
  const MaterialId single = addMaterial(claim.scene, Opacity::kOpaque, false);
  addWall(claim.scene, addMaterial(claim.scene, Opacity::kBlended, true), -5, -100, 100, -100, 100);
  addWall(claim.scene, single, -6, -100, 100, -100, 100, true);
  claim.object = addWall(claim.scene, single, -10, -5, 5, -5, 5, true);
  expectNotSeen(claim);
  claim.object = addWall(claim.scene, single, -11, -5, 5, -5, 5);
  expectSeen(claim, true);
}

TEST(RegionSearch, FindsNothingInAnEmptyRegionOrWithoutTriangles) {
  Claim claim;
  claim.addObject(-10, -5, 5, -5, 5);
  claim.region.sides = {{{1, 0, 0}, 5.0}};
  expectNotSeen(claim);
  claim.region.sides.clear();
  claim.object = addTriangles(claim.scene, claim.opaque, {});
  expectNotSeen(claim);
}

TEST(RegionSearch, FindsTheSameAgain) {
  Claim claim;
  claim.addWallWithHole(-5, 0.3f, 0.3001f, -0.5f, 0.5f);
  claim.addObject(-50, 10.0f, 10.02f, -2, 2);
  const RegionAnswer once = claim.search({}, 7), again = claim.search({}, 7);
  EXPECT_EQ(once.eye, again.eye);
  EXPECT_EQ(once.witness, again.witness);
  EXPECT_EQ(once.planes, again.planes);
}

}  // namespace
}  // namespace sightline
