// A budget in bytes: the file fits, hides nothing that the whole file keeps, and costs viewers little.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/procedural.h"
#include "sightline/pvs/query/set_query.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/sight_checks.h"

namespace sightline {
namespace {

using sight_test::Bytes;
using sight_test::bytesOf;
using sight_test::seenBy;

Scene smallShip() {
  return makeShip({.decks = 3, .rooms = 4, .machinery = 0});
}

// viewers: none, or a box that ends anywhere in cells.
BakeSettings settingsFor(bool partly) {
  BakeSettings settings{.triangle_budget = 300, .max_depth = 4, .near_distance = 0.05};
  if (partly) {
    const Box bounds = sceneBounds(smallShip().view());
    const Vec3f size = bounds.max - bounds.min;
    settings.viewers = {{bounds.min + size * 0.13f, bounds.min + size * 0.87f}};
  }
  return settings;
}

// The triangles that a viewer's set holds, mean over the viewers' space, with all of the scene where the
// octree holds no set.
double meanTriangles(const BakedVisibility& baked) {
  const OctreeView octree = baked.octree.view();
  double sum = 0.0, all = 0.0;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    if (octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kOutside)) {
      return;
    }
    const ViewerBounds viewers = octree.viewersOf(leaf);
    const Vec3d size =
        viewersMax(octree.min, octree.max, cell, viewers) - viewersMin(octree.min, octree.max, cell, viewers);
    const auto trianglesOf = [&](std::uint32_t set) {
      double triangles = 0.0;
      for (const std::uint32_t node : baked.sets[set]) {
        triangles += baked.boxes.nodes[node].triangles;
      }
      return triangles;
    };
    const OctreeLeaf& l = octree.leaves[leaf];
    const double triangles = l.plane == OctreeLeaf::kNoPlane
                                 ? trianglesOf(l.set)
                                 : std::max(trianglesOf(l.front_set), trianglesOf(l.back_set));
    sum += triangles * size.x * size.y * size.z;
    all += size.x * size.y * size.z;
  });
  return sum / all;
}

TEST(ByteBudget, IsKeptAndLeavesOutNothingThatTheWholeFileHolds) {
  const Scene scene = smallShip();
  for (const bool partly : {false, true}) {
    const BakeSettings settings = settingsFor(partly);
    const test::BakedOnce bake(scene, settings);
    const BakedVisibility whole = *bake.fitted(0);
    const Bytes whole_bytes = bytesOf(whole);
    // The file with one cell.
    BakeSettings of_one = settings;
    of_one.max_depth = 0;
    const auto fewest = static_cast<double>(bytesOf(test::baked(scene, of_one)).size());
    double mean_before = meanTriangles(whole);
    std::size_t leaves_before = whole.octree.leaves.size();
    for (const double share : {0.7, 0.4, 0.15}) {
      const auto budget =
          static_cast<std::uint64_t>(fewest + share * (static_cast<double>(whole_bytes.size()) - fewest));
      const Result<BakedVisibility> result = bake.fitted(budget);
      ASSERT_TRUE(result) << result.error().message;
      const BakedVisibility& fitted = *result;
      const Bytes bytes = bytesOf(fitted);
      EXPECT_LE(bytes.size(), budget) << share;
      EXPECT_LT(fitted.octree.leaves.size(), leaves_before) << share;
      // Less room never serves viewers better.
      const double mean = meanTriangles(fitted);
      EXPECT_GE(mean, mean_before * (1.0 - 1e-12)) << share;
      EXPECT_LT(mean, static_cast<double>(scene.triangleCount())) << share;
      mean_before = mean;
      leaves_before = fitted.octree.leaves.size();
      SetQuery query(*SightFile::fromBytes(bytes, "fitted")),
          of_whole(*SightFile::fromBytes(whole_bytes, "whole"));
      std::mt19937 random(7);
      std::size_t missing = 0;
      for (int i = 0; i < 500; ++i) {
        const Vec3d eye = test::pointIn(whole.octree.min, whole.octree.max, random);
        // What is hidden where the whole file has no set would be a claim that nobody has proved.
        const std::vector<bool> seen = seenBy(query, eye, 0.05), must = seenBy(of_whole, eye, 0.05);
        for (std::size_t object = 0; object < seen.size(); ++object) {
          missing += must[object] && !seen[object] ? 1 : 0;
        }
      }
      EXPECT_EQ(missing, 0u) << share;
    }
  }
}

TEST(ByteBudget, ChangesNothingThatFits) {
  const Scene scene = smallShip();
  const test::BakedOnce bake(scene, settingsFor(false));
  const Bytes whole = bytesOf(*bake.fitted(0));
  EXPECT_TRUE(bytesOf(*bake.fitted(whole.size())) == whole);
  EXPECT_LT(bytesOf(*bake.fitted(whole.size() - 1)).size(), whole.size());
}

TEST(ByteBudget, ThatNoCellsAreFewEnoughForIsAnError) {
  const Scene scene = smallShip();
  BakeSettings settings = settingsFor(false);
  settings.byte_budget = 1000;
  const Result<BakedVisibility> baked = bakeVisibility(scene.view(), test::allOccluders(scene), settings);
  ASSERT_FALSE(baked);
  EXPECT_NE(baked.error().message.find("byte budget of 1000"), std::string::npos) << baked.error().message;
}

TEST(ByteBudget, IsNoPartOfThePlan) {
  const Scene scene = smallShip();
  BakeSettings settings = settingsFor(true);
  const OccluderSet occluders = test::allOccluders(scene);
  const std::uint64_t hash = Bake::plan(scene.view(), occluders, settings)->hash();
  settings.byte_budget = 100'000;
  EXPECT_EQ(Bake::plan(scene.view(), occluders, settings)->hash(), hash);
}

}  // namespace
}  // namespace sightline
