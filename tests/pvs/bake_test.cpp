#include "sightline/pvs/bake/bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "scenes/procedural.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using test::allOccluders;
using test::baked;
using test::BakeJudge;
using test::block;
using test::membersOf;
using test::partsOf;
using test::sceneOf;
using test::Solid;

bool same(const BakedVisibility& a, const BakedVisibility& b) {
  return a.scene == b.scene && a.record == b.record && a.octree.nodes == b.octree.nodes &&
         a.octree.leaves == b.octree.leaves && a.octree.depths == b.octree.depths &&
         a.octree.reasons == b.octree.reasons && a.octree.planes == b.octree.planes &&
         a.octree.viewers == b.octree.viewers && a.sets.first == b.sets.first &&
         a.sets.nodes == b.sets.nodes && a.boxes.objects == b.boxes.objects;
}

std::map<StopReason, int> reasonsOf(const BakedVisibility& baked) {
  std::map<StopReason, int> reasons;
  for (const std::uint8_t reason : baked.octree.reasons) {
    ++reasons[static_cast<StopReason>(reason)];
  }
  return reasons;
}

// Random walls, pillars and crates; some touch, some stand on one plane.
Scene randomScene(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto whole = [&](int low, int high) {
    return static_cast<float>(std::uniform_int_distribution<int>(low, high)(random));
  };
  std::vector<Solid> solids{block({-1, -1, -1}, {33, 0, 33})};
  for (int i = 0; i < 25; ++i) {
    const bool along = random() % 2 != 0;
    const Vec3f at(whole(0, 28), 0, whole(0, 28));
    const Vec3f size =
        along ? Vec3f(whole(2, 12), whole(2, 6), 0.25f) : Vec3f(0.25f, whole(2, 6), whole(2, 12));
    solids.push_back(block(at, at + size));
  }
  for (int i = 0; i < 60; ++i) {
    const Vec3f at(whole(0, 60) / 2, 0, whole(0, 60) / 2);
    solids.push_back(block(at, at + Vec3f(0.5f, whole(1, 4) / 2, 0.5f)));
  }
  return sceneOf(solids);
}

// Two rows of houses along a street with crates behind them, on a plate that extends `plate` metres.
Scene streetScene(float plate) {
  std::vector<Solid> solids{block({-plate, -1, -plate}, {120 + plate, 0, plate})};
  for (int i = 0; i < 10; ++i) {
    const auto x = static_cast<float>(12 * i);
    solids.push_back(block({x, 0, 8}, {x + 12, 9, 18}));
    solids.push_back(block({x, 0, -18}, {x + 11, 8, -8}));
    for (const float z : {21.0f, 24.0f, -22.0f, -25.0f}) {
      solids.push_back(block({x + 4, 0, z}, {x + 5, 1, z + 1}));
    }
  }
  return sceneOf(solids);
}

// The fraction of all objects that the set of a viewer at `eye` keeps.
double keptAt(const BakedVisibility& baked, const Vec3d& eye) {
  double kept = 0.0;
  forEachLeaf(baked.octree.view(), [&](std::uint32_t leaf, const OctreeCell& cell) {
    const Vec3d low = cellMin(baked.octree.min, baked.octree.max, cell);
    const Vec3d high = cellMax(baked.octree.min, baked.octree.max, cell);
    if (low.x <= eye.x && eye.x < high.x && low.y <= eye.y && eye.y < high.y && low.z <= eye.z &&
        eye.z < high.z) {
      const std::vector<bool> members = membersOf(baked, test::setAt(baked.octree.view(), leaf, eye));
      kept = static_cast<double>(std::count(members.begin(), members.end(), true)) /
             static_cast<double>(members.size());
    }
  });
  return kept;
}

// The mean over viewers at eye height in the street.
double keptInTheStreet(const BakedVisibility& baked) {
  double kept = 0.0;
  constexpr int kEyes = 11;
  for (int i = 0; i < kEyes; ++i) {
    kept += keptAt(baked, {5.0 + 11.0 * i, 1.7, 0.5});
  }
  return kept / kEyes;
}

TEST(Bake, LeavesOutNothingThatIsSeenFromAnywhereInACell) {
  std::size_t hidden = 0, seen = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = randomScene(seed);
    const BakedVisibility result = baked(scene, {.max_depth = 4, .near_distance = 0.05});
    BakeJudge judge(scene, result);
    judge.judge(2, 5, 0.05, seed);
    hidden += judge.hidden;
    seen += judge.seen;
  }
  EXPECT_GT(seen, 1000u);
  EXPECT_GT(hidden, seen) << "the test would prove little";
}

TEST(Bake, LeavesOutNothingThatIsSeenInABuilding) {
  const Scene scene = makeBuilding({.floors = 2});
  const BakedVisibility result = baked(scene, {.max_depth = 5, .near_distance = 0.1});
  BakeJudge judge(scene, result);
  judge.judge(1, 29, 0.1, 7);
  EXPECT_GT(judge.hidden, judge.seen / 4);
}

TEST(Bake, LeavesOutNothingThatIsSeenOnAShip) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 8});
  const BakedVisibility result =
      baked(scene, {.triangle_budget = 2000, .max_depth = 5, .near_distance = 0.1});
  BakeJudge judge(scene, result);
  judge.judge(1, 13, 0.1, 8);
  EXPECT_GT(judge.hidden, judge.seen);
}

// The depth is chosen, and suits the occluders however wide the ground is.
TEST(Bake, LeavesOutNothingThatIsSeenInAStreetAndMuchThatIsNotWithFewCells) {
  for (const float plate : {20.0f, 2000.0f, 20000.0f}) {
    const Scene scene = streetScene(plate);
    const BakedVisibility result = baked(scene, {.triangle_budget = 100});
    EXPECT_LT(keptInTheStreet(result), 0.7) << plate;
    EXPECT_LT(result.octree.leaves.size(), 65536u) << plate;
    EXPECT_LE(result.record.max_depth, kMaxOctreeDepth);
    if (plate <= 2000.0f) {
      BakeJudge judge(scene, result);
      judge.judge(1, static_cast<std::uint32_t>(result.octree.leaves.size() / 200 + 1), 0.1, 9);
      EXPECT_GT(judge.hidden, judge.seen) << plate;
    }
  }
}

// A court between four walls hides nearly everything around it. But of the few points tested for a root of
// two kilometres, none is in the court or behind much of it.
TEST(Bake, DividesCellsThatAreTooLargeForTheOccludersInThem) {
  std::vector<Solid> solids{block({290, -1, 160}, {310, 9, 161}), block({290, -1, 181}, {310, 9, 182}),
                            block({289, -1, 161}, {290, 9, 181}), block({310, -1, 161}, {311, 9, 181})};
  for (int i = 0; i < 48; ++i) {
    const double angle = 2.0 * 3.14159265 * i / 48;
    const Vec3f at(Vec3d(1000.0 * std::cos(angle), 0.0, 1000.0 * std::sin(angle)));
    solids.push_back(block(at, at + Vec3f(1, 1, 1)));
  }
  const BakedVisibility result = baked(sceneOf(solids), {.max_depth = 9});
  EXPECT_LT(keptAt(result, {300.3, 1.7, 171.2}), 0.5);
  EXPECT_GT(keptAt(result, {-500.3, 1.7, 171.2}), 0.9);
}

// A cell takes much longer where surfaces hide as well.
TEST(Bake, ChoosesFewerCellsWhereSurfacesHide) {
  const Scene scene = streetScene(300.0f);
  const OccluderSet occluders = allOccluders(scene);
  const Result<Bake> convex = Bake::plan(scene.view(), occluders, {});
  const Result<Bake> fused = Bake::plan(scene.view(), occluders, {.occlusion = BakeOcclusion::kFused});
  ASSERT_TRUE(convex && fused);
  EXPECT_LE(fused->maxCells(), 2048u);
  EXPECT_GT(fused->maxCells(), 256u) << "one level more would be too many";
  EXPECT_GT(convex->maxCells().value(), 4 * fused->maxCells().value());
}

TEST(Bake, ChoosesTheDepthByTheSceneAloneAndCountsItsOccluders) {
  const Scene scene = streetScene(2000.0f);
  const OccluderSet occluders = allOccluders(scene);
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, {});
  ASSERT_TRUE(bake);
  EXPECT_EQ(bake->occluders().all, 61u);
  EXPECT_EQ(bake->occluders().inner, 60u) << "all but the plate, beneath which is nothing";
  EXPECT_EQ(bake->occluders().of_use, 20u) << "the houses";
  EXPECT_EQ(bake->occluders().largest_area, 120.0);
  // If this depth is requested, all cells may be divided down to it, which is another plan.
  EXPECT_LT(bake->baseDepth(), bake->settings().max_depth);
  const Result<Bake> asked = Bake::plan(scene.view(), occluders, bake->settings());
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->settings().max_depth, bake->settings().max_depth);
  EXPECT_NE(asked->hash(), bake->hash());
  const Result<Bake> none = Bake::plan(scene.view(), OccluderSet{}, {});
  ASSERT_TRUE(none);
  EXPECT_LT(none->settings().max_depth, bake->settings().max_depth);
  EXPECT_EQ(none->occluders().inner, 0u);
}

TEST(Bake, HidesWhatIsBehindAWallFromACellBeforeIt) {
  // The wall is at x = 10, with crates in front of it and behind it.
  const Scene scene = sceneOf(
      {block({10, 0, 0}, {10.5f, 16, 16}), block({3, 1, 7}, {4, 2, 8}), block({14, 7, 7}, {15, 8, 8})});
  const BakedVisibility result =
      baked(scene,
            {.max_depth = 1, .near_distance = 0.1, .viewers = {{{0, 0, 0}, {8, 16, 16}}}, .similarity = 0.0});
  forEachLeaf(result.octree.view(), [&](std::uint32_t leaf, const OctreeCell& cell) {
    if (cell.level > 0 && cell.at[0] == 0) {
      const std::vector<bool> members = membersOf(result, result.octree.leaves[leaf].set);
      EXPECT_TRUE(members[0]);
      EXPECT_TRUE(members[1]);
      EXPECT_FALSE(members[2]);
    }
  });
}

TEST(Bake, DoesNotCombineWhatDifferentOccludersHideFromDifferentCorners) {
  // Two screens with a gap between them. No corner of the cell sees the crate through the gap, but the cell's
  // centre does. So the crate must stay in the set.
  const Scene scene = sceneOf({block({10, 0, 0}, {10.25f, 16, 7.5f}), block({10, 0, 8.5f}, {10.25f, 16, 16}),
                               block({15, 7.5f, 7.75f}, {15.5f, 8.5f, 8.25f})});
  const BakedVisibility result =
      baked(scene, {.max_depth = 0, .near_distance = 0.1, .viewers = {{{0, 0, 0}, {8, 8, 16}}}});
  ASSERT_EQ(result.octree.leaves.size(), 1u);
  EXPECT_TRUE(membersOf(result, result.octree.leaves[0].set)[2]);
}

TEST(Bake, KeepsWhatAViewersNearPlaneMayCutOpen) {
  const Scene scene = sceneOf(
      {block({8.5f, -8, -8}, {9, 24, 24}), block({12, 7, 7}, {13, 8, 8}), block({1, 1, 1}, {2, 2, 2})});
  const Box region{{0, 0, 0}, {8, 8, 8}};
  const auto hides = [&](double near_distance) {
    const BakedVisibility result =
        baked(scene, {.max_depth = 0, .near_distance = near_distance, .viewers = {region}});
    return !membersOf(result, result.octree.leaves[0].set)[1];
  };
  EXPECT_TRUE(hides(0.4));
  EXPECT_FALSE(hides(0.6));
}

TEST(Bake, DividesACellAtAWallThatFillsIt) {
  const Scene scene = sceneOf(
      {block({3, -1, -1}, {3.5f, 9, 9}), block({0.5f, 3, 3}, {1, 4, 4}), block({6, 3, 3}, {7, 4, 4})});
  const BakedVisibility result =
      baked(scene, {.max_depth = 0, .near_distance = 0.1, .viewers = {{{0, 0, 0}, {8, 8, 8}}}});
  const OctreeView octree = result.octree.view();
  ASSERT_EQ(octree.leaves.size(), 1u);
  ASSERT_NE(octree.leaves[0].plane, OctreeLeaf::kNoPlane);
  const auto sees = [&](const Vec3d& eye, std::uint32_t object) -> bool {
    return membersOf(result, test::setAt(octree, 0, eye))[object];
  };
  EXPECT_TRUE(sees({1, 4, 4}, 1));
  EXPECT_FALSE(sees({1, 4, 4}, 2));
  EXPECT_FALSE(sees({7, 4, 4}, 1));
  EXPECT_TRUE(sees({7, 4, 4}, 2));
  EXPECT_TRUE(sees({2.95, 4, 4}, 2)) << "its near plane may cut the wall open";
  EXPECT_TRUE(sees({3.2, 4, 4}, 1) && sees({3.2, 4, 4}, 2));
}

TEST(Bake, StopsWhereTheBudgetIsMet) {
  const Scene scene = randomScene(3);
  const BakedVisibility all = baked(scene, {.triangle_budget = scene.triangleCount(), .max_depth = 4});
  EXPECT_EQ(all.octree.leaves.size(), 1u);
  EXPECT_EQ(reasonsOf(all)[StopReason::kBudgetMet], 1);
  const std::uint64_t budget = scene.triangleCount() / 2;
  const BakedVisibility half =
      baked(scene, {.triangle_budget = budget, .max_depth = 4, .merge_tolerance = 0.0});
  std::size_t met = 0;
  forEachLeaf(half.octree.view(), [&](std::uint32_t leaf, const OctreeCell&) {
    std::uint64_t triangles = 0;
    for (const std::uint32_t node : half.sets[half.octree.leaves[leaf].set]) {
      triangles += half.boxes.nodes[node].triangles;
    }
    const bool whole = half.octree.leaves[leaf].plane == OctreeLeaf::kNoPlane;
    if (whole && half.octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kBudgetMet)) {
      EXPECT_LE(triangles, budget);
      ++met;
    }
  });
  EXPECT_GT(met, 0u);
}

TEST(Bake, StopsInOpenAirAndMergesIt) {
  // Nothing hides anything, so the first test decides.
  const Scene open = sceneOf({block({0, 0, 0}, {1, 1, 1}), block({60, 60, 60}, {61, 61, 61})});
  const BakedVisibility result = baked(open, {.max_depth = 5});
  EXPECT_LE(result.octree.leaves.size(), 64u);
  EXPECT_GT(reasonsOf(result)[StopReason::kNothingGained] + reasonsOf(result)[StopReason::kMerged], 0);
  EXPECT_EQ(reasonsOf(result)[StopReason::kMaxDepth], 0);
}

TEST(Bake, NeverGoesBelowItsDepthAndSaysSo) {
  const BakedVisibility result = baked(randomScene(5), {.max_depth = 3});
  const OctreeView octree = result.octree.view();
  for (std::size_t leaf = 0; leaf < octree.leaves.size(); ++leaf) {
    EXPECT_LE(octree.depths[leaf], 3);
    if (octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kMaxDepth)) {
      EXPECT_EQ(octree.depths[leaf], 3);
    }
  }
  EXPECT_GT(reasonsOf(result)[StopReason::kMaxDepth], 0);
}

TEST(Bake, MergesSiblingsWithLikeSets) {
  const Scene scene = randomScene(6);
  const BakedVisibility none = baked(scene, {.max_depth = 4, .merge_tolerance = 0.0});
  const BakedVisibility some = baked(scene, {.max_depth = 4, .merge_tolerance = 0.3});
  EXPECT_LT(some.octree.leaves.size(), none.octree.leaves.size());
  EXPECT_GT(reasonsOf(some)[StopReason::kMerged], 0);
  BakeJudge judge(scene, some);
  judge.judge(1, 3, 0.25, 6);
}

TEST(Bake, OfASmallRegionLooksAsFarAsOfALargeOne) {
  const Scene scene = sceneOf({block({-20, -20, 10}, {20, 20, 10.5f}), block({0, 0, 20}, {1, 1, 21})});
  for (const float size : {8.0f, 0.5f, 0.0f}) {
    const BakedVisibility result = baked(scene, {.max_depth = 0,
                                                 .near_distance = 0.1,
                                                 .viewers = {{{0, 0, 0}, {size, size, size}}},
                                                 .min_gain = 0.0});
    EXPECT_FALSE(membersOf(result, result.octree.leaves[0].set)[1]) << size;
  }
}

TEST(Bake, CellsThatNoViewerIsInHoldEverything) {
  const Scene scene = randomScene(2);
  const BakedVisibility result = baked(scene, {.max_depth = 3, .viewers = {{{0, 0, 0}, {32, 2, 4}}}});
  const OctreeView octree = result.octree.view();
  int outside = 0;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    const Vec3d low = cellMin(octree.min, octree.max, cell);
    const bool beyond = low.y > 2.0 || low.z > 4.0;
    EXPECT_EQ(octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kOutside), beyond);
    if (beyond) {
      ++outside;
      const std::vector<bool> members = membersOf(result, octree.leaves[leaf].set);
      EXPECT_EQ(std::count(members.begin(), members.end(), true), static_cast<long>(members.size()));
    }
  });
  EXPECT_GT(outside, 0);
}

TEST(Bake, OfSeveralBoxesOfViewersCoversThoseAndNoOther) {
  const Scene scene = randomScene(2);
  const std::vector<Box> viewers{{{1, 1, 1}, {3, 3, 3}}, {{25, 20, 28}, {31, 22, 30}}};
  const BakedVisibility result = baked(scene, {.max_depth = 4, .viewers = viewers, .merge_tolerance = 0.0});
  const OctreeView octree = result.octree.view();
  int outside = 0, small = 0;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    const Vec3d low = cellMin(octree.min, octree.max, cell), high = cellMax(octree.min, octree.max, cell);
    const bool meets = std::any_of(viewers.begin(), viewers.end(), [&](const Box& box) {
      const Vec3d min(box.min), max(box.max);
      return low.x <= max.x && low.y <= max.y && low.z <= max.z && high.x >= min.x && high.y >= min.y &&
             high.z >= min.z;
    });
    EXPECT_EQ(octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kOutside), !meets);
    if (!meets) {
      ++outside;
      const std::vector<bool> members = membersOf(result, octree.leaves[leaf].set);
      EXPECT_EQ(std::count(members.begin(), members.end(), true), static_cast<long>(members.size()));
    }
    small += meets && cell.level == 4 ? 1 : 0;
  });
  EXPECT_GT(outside, 0);
  EXPECT_GT(small, 0);
  BakeJudge judge(scene, result);
  judge.judge(2, 1, 0.25, 4);
}

TEST(Bake, CountsTheCellsWithViewersUnlessTheyAreTooMany) {
  const Scene scene = randomScene(2);
  const OccluderSet occluders = allOccluders(scene);
  const std::vector<Box> viewers{{{0, 0, 0}, {9, 9, 1}}, {{8, 8, 8}, {8, 8, 8}}, {{20, 3, 31}, {32, 9, 32}}};
  constexpr std::uint32_t kDepth = 4;
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, {.max_depth = kDepth, .viewers = viewers});
  ASSERT_TRUE(bake);
  // The root depends on the viewers alone.
  const BakedVisibility root = baked(scene, {.max_depth = 0, .viewers = viewers});
  const Vec3d low = root.octree.min, high = root.octree.max;
  std::uint64_t count = 0;
  OctreeCell cell{kDepth, {}};
  for (std::uint32_t i = 0; i < 1u << (3 * kDepth); ++i) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      cell.at[axis] = i >> (axis * kDepth) & ((1u << kDepth) - 1);
    }
    const Vec3d min = cellMin(low, high, cell), max = cellMax(low, high, cell);
    count += std::ranges::any_of(viewers, [&](const Box& box) {
      const Vec3d first(box.min), last(box.max);
      return first.x <= max.x && first.y <= max.y && first.z <= max.z && last.x >= min.x && last.y >= min.y &&
             last.z >= min.z;
    });
  }
  EXPECT_GT(count, 20u);
  EXPECT_EQ(bake->maxCells(), count);
  // All cells of the cube meet viewers, and 8^7 = 2,097,152 are as many as are counted.
  const std::vector<Box> all{{{0, 0, 0}, {33, 33, 33}}};
  EXPECT_EQ(Bake::plan(scene.view(), occluders, {.max_depth = 7, .viewers = all})->maxCells(),
            Bake::kMaxCounted);
  EXPECT_EQ(Bake::plan(scene.view(), occluders, {.max_depth = 8, .viewers = all})->maxCells(), std::nullopt);
}

TEST(Bake, WithFewerPlacesForViewersChoosesSmallerCells) {
  const Scene scene = randomScene(2);
  const OccluderSet occluders = allOccluders(scene);
  const auto depthOf = [&](std::vector<Box> viewers) {
    const Result<Bake> bake =
        Bake::plan(scene.view(), occluders, {.near_distance = 0.01, .viewers = std::move(viewers)});
    EXPECT_TRUE(bake);
    return bake->baseDepth();
  };
  EXPECT_GT(depthOf({{{0, 0, 0}, {1, 1, 1}}, {{31, 31, 31}, {32, 32, 32}}}),
            depthOf({{{0, 0, 0}, {32, 32, 32}}}));
}

TEST(Bake, IsAnotherPlanForOtherViewers) {
  const Scene scene = randomScene(2);
  const OccluderSet occluders = allOccluders(scene);
  const auto hashOf = [&](std::vector<Box> viewers) {
    return Bake::plan(scene.view(), occluders, {.max_depth = 2, .viewers = std::move(viewers)})->hash();
  };
  const Box all{{0, 0, 0}, {32, 32, 32}}, part{{4, 4, 4}, {5, 5, 5}};
  EXPECT_NE(hashOf({all}), hashOf({all, part}));
  EXPECT_NE(hashOf({all}), hashOf({part}));
  EXPECT_EQ(hashOf({all, part}), hashOf({all, part}));
}

TEST(Bake, PartsAreFewCellsSoThatLittleIsLostWhenOneIsNotFinished) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 8});
  for (std::uint32_t depth = 4; depth <= (test::sanitized() ? 4u : 5u); ++depth) {
    const Result<Bake> bake =
        Bake::plan(scene.view(), allOccluders(scene), {.max_depth = depth, .merge_tolerance = 0.0});
    ASSERT_TRUE(bake);
    double share = 0.0;
    std::uint32_t leaves = 0;
    for (const auto& [id, part] : bake->bakeAll()) {
      EXPECT_TRUE(bake->isPart(id, part));
      EXPECT_FALSE(bake->isPart(id, std::span(part).first(part.size() - 1)));
      EXPECT_LE(bake->summaryOf(part).leaves, 64u) << depth;
      leaves += bake->summaryOf(part).leaves;
      share += bake->summaryOf(part).share;
    }
    EXPECT_NEAR(share, 1.0, 1e-9) << "parts fill the viewers' region";
    EXPECT_GT(leaves, 64u);
  }
}

// A cell takes far longer with surfaces than with convex occluders alone.
TEST(Bake, PartsOfMoreWorkAreFewerCells) {
  const Scene scene = randomScene(3);
  const auto partsWith = [&](BakeOcclusion occlusion, std::uint32_t& most_leaves) {
    const Result<Bake> bake =
        Bake::plan(scene.view(), allOccluders(scene),
                   {.occlusion = occlusion, .max_depth = 3, .near_distance = 0.1, .merge_tolerance = 0.0});
    EXPECT_TRUE(bake);
    const BakedParts parts = bake->bakeAll();
    for (const auto& [id, part] : parts) {
      most_leaves = std::max(most_leaves, bake->summaryOf(part).leaves);
    }
    EXPECT_TRUE(bake->assemble(parts));
    return parts.size();
  };
  std::uint32_t most_convex = 0, most_fused = 0;
  const std::size_t convex = partsWith(BakeOcclusion::kConvex, most_convex);
  const std::size_t fused = partsWith(BakeOcclusion::kFused, most_fused);
  EXPECT_GT(fused, 2 * convex);
  EXPECT_LT(2 * most_fused, most_convex);
}

// Bakes each part by a worker of its own, the last ones of each level first.
BakedParts partsBackwards(const Bake& bake) {
  BakedParts parts;
  for (std::vector<PartTask> open{bake.firstPart()}; !open.empty();) {
    const PartTask part = open.front();
    open.erase(open.begin());
    const BakedPart& bytes = parts.emplace(part.id, Bake::Worker(bake).bake(part)).first->second;
    const std::vector<PartTask> below = bake.partsBelow(bytes);
    open.insert(open.end(), below.rbegin(), below.rend());
  }
  return parts;
}

TEST(Bake, IsTheSameWhoeverBakesThePartsAndHoweverMuchIsForgotten) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 8});
  const OccluderSet occluders = allOccluders(scene);
  const BakeSettings settings{.max_depth = 4};
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, settings);
  ASSERT_TRUE(bake);
  BakeSettings small = settings;
  small.sample_bytes = 1;
  const Result<Bake> forgetful = Bake::plan(scene.view(), occluders, small);
  ASSERT_TRUE(forgetful);
  EXPECT_EQ(bake->hash(), forgetful->hash());
  Bake::Worker one(*bake), third(*forgetful);
  const BakedParts forwards = partsOf(*bake, [&](const PartTask& part) { return one.bake(part); });
  const BakedParts poor = partsOf(*forgetful, [&](const PartTask& part) { return third.bake(part); });
  const BakedParts backwards = partsBackwards(*bake);
  ASSERT_GT(forwards.size(), 1u);
  EXPECT_GT(third.stats().forgotten, one.stats().forgotten);
  EXPECT_GT(third.stats().shadows, one.stats().shadows);
  const Result<BakedVisibility> a = bake->assemble(forwards), b = bake->assemble(backwards),
                                c = bake->assemble(poor);
  ASSERT_TRUE(a && b && c);
  EXPECT_TRUE(same(*a, *b));
  EXPECT_TRUE(same(*a, *c));
  EXPECT_TRUE(same(*a, baked(scene, settings)));
}

// Without samples, a cell hands lists of occluders to the cells within it, if one worker bakes them all.
TEST(Bake, IsTheSameWhoeverBakesThePartsWithoutSamples) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 8});
  const OccluderSet occluders = allOccluders(scene);
  const std::uint32_t depth = test::sanitized() ? 3 : 4;
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, {.max_depth = depth, .sample_bytes = 0});
  ASSERT_TRUE(bake);
  Bake::Worker one(*bake);
  const BakedParts forwards = partsOf(*bake, [&](const PartTask& part) { return one.bake(part); });
  ASSERT_GT(forwards.size(), 1u);
  const Result<BakedVisibility> a = bake->assemble(forwards), b = bake->assemble(partsBackwards(*bake));
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(same(*a, *b));
  EXPECT_TRUE(same(*a, baked(scene, {.max_depth = depth})));
}

// Without samples, lists are handed to cells only where there are no witnesses. The test before this one does
// the same with a ship.
TEST(Bake, HasTheSameSetsWithSamplesAndWithout) {
  for (const Scene& scene : {makeCity({.copies = 2}), makeBuilding({.floors = 2})}) {
    BakeSettings settings{.triangle_budget = 100, .max_depth = 5, .witnesses = true};
    const BakedVisibility with = baked(scene, settings);
    settings.sample_bytes = 0;
    for (const bool witnesses : {false, true}) {
      settings.witnesses = witnesses;
      const BakedVisibility without = baked(scene, settings);
      EXPECT_TRUE(same(with, without)) << witnesses;
      EXPECT_GT(without.sets.count(), 20u);
    }
  }
}

TEST(Bake, KeepsNoSamplesAndLooksAtAnyDistanceWhereObjectsAreMany) {
  for (const bool many : {false, true}) {
    const std::uint32_t boxes = many ? static_cast<std::uint32_t>(BakeSettings::kManyObjects) : 1000;
    const Scene scene = makeBoxCity({.buildings = 100, .boxes = boxes});
    ASSERT_EQ(scene.objects.size() > BakeSettings::kManyObjects, many);
    const Result<Bake> bake = Bake::plan(scene.view(), OccluderSet(), {.max_depth = 1}),
                       near = Bake::plan(scene.view(), OccluderSet(), {.max_depth = 1, .search_distance = 5});
    ASSERT_TRUE(bake && near);
    Box bounds;
    for (const Object& object : scene.objects) {
      bounds.extend(object.bounds);
    }
    const double diagonal = length(Vec3d(bounds.max) - Vec3d(bounds.min));
    EXPECT_EQ(bake->firstPart().search_distance >= diagonal, many);
    Bake::Worker worker(*bake);
    worker.bake(bake->firstPart());
    EXPECT_EQ(worker.stats().samples == 0, many);
    EXPECT_EQ(near->firstPart().search_distance, 5.0);
  }
}

TEST(Bake, FusedSetsAreSmallerAndLeaveOutNothingThatIsSeen) {
  const Scene scene = makeShip({.decks = 2, .rooms = 2, .machinery = 2});
  BakeSettings settings{.max_depth = 2, .near_distance = 0.1};
  const BakedVisibility convex = baked(scene, settings);
  settings.occlusion = BakeOcclusion::kFused;
  const BakedVisibility fused = baked(scene, settings);
  BakeJudge judge_convex(scene, convex), judge(scene, fused);
  judge_convex.judge(2, 1, 0.1, 21);
  judge.judge(2, 1, 0.1, 21);
  EXPECT_GT(judge.hidden, judge_convex.hidden + judge_convex.hidden / 10);
}

// An L, lying on its longer side.
test::Solid bentSolid() {
  test::Solid solid = test::block({2, -2, -2}, {2.5f, 3, -1});
  const test::Solid upright = test::block({2, -2, -1}, {2.5f, -1.5f, 3});
  for (std::vector<std::uint32_t> face : upright.faces) {
    for (std::uint32_t& corner : face) {
      corner += static_cast<std::uint32_t>(solid.points.size());
    }
    solid.faces.push_back(face);
  }
  solid.points.insert(solid.points.end(), upright.points.begin(), upright.points.end());
  return solid;
}

TEST(Bake, FusedSetsLeaveOutAnObjectOfWhichEachBoxIsHidden) {
  // The wall lacks a corner, through which the empty corner of the L's own box shows.
  const Scene scene = test::sceneOf(
      {test::block({-0.25f, -4, -4}, {0, 4, 2}), test::block({-0.25f, -4, 2}, {0, 0, 4}), bentSolid()});
  for (const std::uint32_t boxes : {1u, kMaxObjectBoxes}) {
    const BakedVisibility result = baked(scene, {.occlusion = BakeOcclusion::kFused,
                                                 .max_depth = 0,
                                                 .near_distance = 0.1,
                                                 .viewers = {{{-6, -0.5, -0.5}, {-5, 0.5, 0.5}}},
                                                 .object_boxes = boxes});
    EXPECT_EQ(test::membersOf(result, 0)[2], boxes == 1) << boxes;
  }
}

// Bounds may be wider than the triangles, to hold what was moved for the bake; then boxes of the triangles do
// not count.
TEST(Bake, FusedSetsKeepAnObjectWhoseWiderBoundsShow) {
  Scene scene = test::sceneOf({test::block({-0.25f, -4, -4}, {0, 4, 4}), bentSolid()});
  const auto isKept = [&]() -> bool {
    const BakedVisibility result = baked(scene, {.occlusion = BakeOcclusion::kFused,
                                                 .max_depth = 0,
                                                 .near_distance = 0.1,
                                                 .viewers = {{{-6, -0.5, -0.5}, {-5, 0.5, 0.5}}}});
    return test::membersOf(result, 0)[1];
  };
  EXPECT_FALSE(isKept());
  scene.objects[1].bounds.max.z = 9.0f;
  EXPECT_TRUE(isKept());
}

// Two walls across x, each with an edge in the way from the viewers to the last block. Only together they
// hide it, and only narrowing shows that.
Scene twoWalls() {
  return test::sceneOf({test::block({0, -9, -9}, {0.25f, 9, 0.5f}),
                        test::block({4, -9, -0.5f}, {4.25f, 9, 9}),
                        test::block({8, -0.5f, -1}, {8.25f, 0.5f, 1})});
}

TEST(Bake, NarrowsWhateverEndsDivision) {
  BakeSettings settings{.occlusion = BakeOcclusion::kFused,
                        .near_distance = 0.1,
                        .viewers = {{{-6, -0.5, -0.5}, {-5, 0.5, 0.5}}}};
  struct End {
    StopReason reason;
    std::uint32_t max_depth;
    std::uint64_t triangle_budget;
  };
  for (const End& end : {End{StopReason::kMaxDepth, 0, 0}, End{StopReason::kBudgetMet, 2, 1000},
                         End{StopReason::kNothingGained, 2, 0}}) {
    settings.max_depth = end.max_depth;
    settings.triangle_budget = end.triangle_budget;
    settings.similarity = 1.0;  // no point sees so much less that dividing helps
    for (const std::uint32_t narrowings : {0u, 1u}) {
      settings.narrowings = narrowings;
      const BakedVisibility result = baked(twoWalls(), settings);
      const VisibilityOctree& octree = result.octree;
      ASSERT_EQ(octree.leaves.size(), 1u);
      EXPECT_EQ(octree.reasons[0], static_cast<std::uint8_t>(end.reason));
      EXPECT_EQ(test::membersOf(result, 0)[2], narrowings == 0) << static_cast<int>(end.reason);
    }
  }
}

TEST(Bake, FusedSetsAreTheSameWhoeverBakesTheParts) {
  const Scene scene = randomScene(3);
  const BakeSettings settings{
      .occlusion = BakeOcclusion::kFused, .max_depth = 3, .near_distance = 0.05, .narrowings = 1};
  const Result<Bake> bake = Bake::plan(scene.view(), allOccluders(scene), settings);
  ASSERT_TRUE(bake);
  Bake::Worker one(*bake);
  const BakedParts alone = partsOf(*bake, [&](const PartTask& part) { return one.bake(part); });
  const BakedParts anew =
      partsOf(*bake, [&](const PartTask& part) { return Bake::Worker(*bake).bake(part); });
  EXPECT_EQ(alone, anew);
  const Result<BakedVisibility> result = bake->assemble(alone);
  ASSERT_TRUE(result);
  BakeJudge judge(scene, *result);
  judge.judge(2, 5, 0.05, 3);
  EXPECT_GT(judge.hidden, judge.seen);
}

TEST(Bake, RefusesPartsOfAnotherPlanAndBrokenOnes) {
  const Scene scene = randomScene(1);
  const OccluderSet occluders = allOccluders(scene);
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, {.max_depth = 3});
  const Result<Bake> other = Bake::plan(scene.view(), occluders, {.max_depth = 3, .near_distance = 0.5});
  ASSERT_TRUE(bake && other);
  EXPECT_NE(bake->hash(), other->hash());
  const BakedParts parts = bake->bakeAll();
  const BakedPart of_other = Bake::Worker(*other).bake(other->firstPart());
  ASSERT_GT(parts.size(), 2u);
  ASSERT_TRUE(bake->assemble(parts));
  const std::uint64_t last = parts.rbegin()->first;
  EXPECT_FALSE(bake->isPart(1, of_other));
  for (const auto& [id, part] : parts) {
    BakedParts missing = parts;
    missing.erase(id);
    EXPECT_FALSE(bake->assemble(missing)) << id;
  }
  BakedParts foreign = parts;
  foreign[1] = of_other;
  EXPECT_FALSE(bake->assemble(foreign));
  BakedParts swapped = parts;
  std::swap(swapped[last], swapped[last - 1]);
  EXPECT_FALSE(bake->assemble(swapped));
  for (const std::uint64_t id : {std::uint64_t{1}, last}) {
    const BakedPart& whole = parts.at(id);
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 16) {
      BakedParts torn = parts;
      torn[id].resize(length);
      EXPECT_FALSE(bake->assemble(torn)) << length << " bytes of part " << id;
    }
  }
}

TEST(Bake, RefusesSettingsThatMakeNoSense) {
  const Scene scene = randomScene(1);
  const OccluderSet occluders = allOccluders(scene);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<BakeSettings> bad{
      {.max_depth = kMaxOctreeDepth + 1},
      {.near_distance = -1.0},
      {.near_distance = kNan},
      {.search_distance = -1.0},
      {.divisions = 17},
      {.narrowings = 9},
      {.object_boxes = 0},
      {.object_boxes = kMaxObjectBoxes + 1},
      {.box_margin = -1.0},
      {.occluder_size = kNan},
      {.similarity = 2.0},
      {.min_gain = -0.1},
      {.merge_tolerance = -1.0},
      {.viewers = {{{0, 0, 0}, {std::numeric_limits<float>::infinity(), 1, 1}}}}};
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const Result<Bake> bake = Bake::plan(scene.view(), occluders, bad[i]);
    ASSERT_FALSE(bake) << i;
    EXPECT_EQ(bake.error().message.find("bake: "), 0u);
  }
  EXPECT_FALSE(Bake::plan({}, {}, {})) << "nothing to see";
  EXPECT_FALSE(Bake::plan({}, {}, {.viewers = {{{0, 0, 0}, {1, 1, 1}}}})) << "also where viewers are given";
}

TEST(Bake, RefusesOccludersOfNoObjectOfTheScene) {
  const Scene scene = randomScene(1);
  for (const ObjectId object : {ObjectId(), ObjectId(scene.objects.size()), ObjectId(4'000'000'000u)}) {
    OccluderSet occluders = allOccluders(scene);
    occluders.occluders.back().object = object;
    const Result<Bake> bake = Bake::plan(scene.view(), occluders);
    ASSERT_FALSE(bake) << object.value;
    const std::string owner = object.valid() ? "object " + std::to_string(object.value) : "no object";
    EXPECT_NE(bake.error().message.find("bake: an occluder belongs to " + owner), std::string::npos);
  }
}

TEST(Bake, TakesBrokenBoxesFlatScenesAndNoOccluders) {
  Scene scene =
      sceneOf({{{{0, 0, 0}, {4, 0, 0}, {4, 0, 4}, {0, 0, 4}}, {{0, 3, 2, 1}}}, block({1, 0, 1}, {2, 0, 2})});
  scene.objects.push_back(scene.objects[0]);
  scene.objects.back().bounds = Box{};
  const BakedVisibility result = baked(scene, {.max_depth = 2});
  for (const OctreeLeaf& leaf : result.octree.leaves) {
    EXPECT_TRUE(membersOf(result, leaf.set)[2]) << "nothing is known of it";
  }
  const Result<BakedVisibility> blind = bakeVisibility(scene.view(), OccluderSet{}, {.max_depth = 2});
  ASSERT_TRUE(blind);
  EXPECT_EQ(blind->sets.count(), 1u);
}

}  // namespace
}  // namespace sightline
