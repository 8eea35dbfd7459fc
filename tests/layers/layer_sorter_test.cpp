// Scenes of a few parts whose order is known exactly.

#include "sightline/layers/layer_sorter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/layers/made_parts.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace made;

// Expects each group of `fine` to be within a group of `coarse`.
void expectInside(const std::set<Group>& fine, const std::set<Group>& coarse) {
  for (const Group& group : fine) {
    EXPECT_TRUE(std::any_of(coarse.begin(), coarse.end(), [&](const Group& whole) {
      return std::includes(whole.begin(), whole.end(), group.begin(), group.end());
    })) << ::testing::PrintToString(group);
  }
}

// Whether the group is a cycle of which no two parts intersect.
bool isCycle(const Group& group, const Truth& truth) {
  return group.size() > 1 &&
         std::none_of(truth.collisions.begin(), truth.collisions.end(), [&](const Pair& pair) {
           return std::binary_search(group.begin(), group.end(), pair.first);
         });
}

TEST(LayerSorter, FindsExactlyTheArcsGroupsAndCollisions) {
  const std::vector<Way> with_all_arcs = allWays(true), without = allWays(false);
  std::size_t grouped = 0, cycles = 0, alone = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(150u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MadeScene scene =
        seed % 3 == 0 ? randomBars(random, 12) : randomScene(random, 2 + random.below(6), random.whole(2, 9));
    const Truth truth = truthOf(scene);
    for (const Group& group : truth.groups) {
      ++(group.size() > 1 ? grouped : alone);
      cycles += isCycle(group, truth) ? 1 : 0;
    }
    for (const std::vector<Way>* ways : {&with_all_arcs, &without}) {
      for (const Way& way : *ways) {
        SCOPED_TRACE(way.name);
        LayerSorter sorter = sorterOf(scene, way.settings);
        expectTrue(Answer(sorter.update(scene.view)), truth, way.settings.arcs == LayerArcs::kAll);
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_GT(grouped, test::rounds(50u));
  EXPECT_GT(cycles, test::sanitized() ? 1u : 5u);
  EXPECT_GT(alone, test::rounds(100u));
}

TEST(LayerSorter, WithoutArcsGivesTheSameGroupsOfFewerExactTests) {
  std::uint64_t tests_with_arcs = 0, tests = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MadeScene scene = randomScene(random, 6, 4);
    const Truth truth = truthOf(scene);
    for (Way way : allWays(false)) {
      SCOPED_TRACE(way.name);
      LayerSorter with_arcs = sorterOf(scene, way.settings);
      tests_with_arcs += with_arcs.update(scene.view).stats.pair_queries;
      way.settings.arcs = LayerArcs::kNone;
      LayerSorter sorter = sorterOf(scene, way.settings);
      const LayerOrder& order = sorter.update(scene.view);
      tests += order.stats.pair_queries;
      const Answer answer(order);
      EXPECT_TRUE(answer.arcs.empty());
      EXPECT_EQ(answer.groups, truth.groups);
      EXPECT_TRUE(std::includes(truth.collisions.begin(), truth.collisions.end(), answer.collisions.begin(),
                                answer.collisions.end()));
      expectOrdered(answer, truth.arcs);
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_LT(tests, tests_with_arcs);
}

TEST(LayerSorter, MissesNoArcOfViewsAlongAnyDirection) {
  const std::vector<Way> ways = allWays(true);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    MadeScene scene = randomScene(random, 6, 5);
    scene.view = viewFrom({}, random.below(2) == 0 ? random.direction() : Vec3d(1, 1, 0));
    scene.view.orthographic = true;
    const Truth truth = truthOf(scene);
    for (const Way& way : ways) {
      SCOPED_TRACE(way.name);
      LayerSorter sorter = sorterOf(scene, way.settings);
      expectNothingMissing(Answer(sorter.update(scene.view)), truth);
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(LayerSorter, ByExtentsAloneJoinsGroupsAndDropsNoArc) {
  std::size_t coarser = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MadeScene scene = randomScene(random, 6, 8);
    const Truth truth = truthOf(scene);
    for (Way way : allWays(true)) {
      SCOPED_TRACE(way.name);
      way.settings.exact = false;
      LayerSorter sorter = sorterOf(scene, way.settings);
      const Answer answer(sorter.update(scene.view));
      expectInside(truth.groups, answer.groups);
      expectOrdered(answer, truth.arcs);
      expectOrdered(answer, answer.arcs);
      EXPECT_TRUE(
          std::includes(answer.arcs.begin(), answer.arcs.end(), truth.arcs.begin(), truth.arcs.end()));
      coarser += answer.groups.size() < truth.groups.size() ? 1 : 0;
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(coarser, 0u);
}

// Changes a scene and its sorter in all ways that the sorter allows.
void changeSomething(MadeScene& scene, LayerSorter& sorter, Random& random) {
  for (std::uint32_t i = 0; i < scene.parts.size(); ++i) {
    MadePart& part = scene.parts[i];
    if (random.below(3) == 0) {
      for (int axis = 0; axis < 3; ++axis) {
        part.world_from_part(axis, 3) += random.whole(-1, 1);
      }
      EXPECT_TRUE(sorter.setTransform(PartId(i), part.world_from_part));
    }
    if (random.below(8) == 0) {
      part.enabled = !part.enabled;
      sorter.setEnabled(PartId(i), part.enabled);
    }
  }
  if (random.below(4) == 0) {
    scene.parts.push_back(randomPart(random, 5));
    addMade(sorter, scene.parts.back());
  }
  if (random.below(2) == 0) {
    scene.view = randomView(random, scene, 7);
  }
  if (random.below(6) == 0) {
    sorter.reset();
  }
  if (random.below(6) == 0) {
    sorter.rebuildSearch();
  }
}

TEST(LayerSorter, SaysInEveryFrameWhatAFreshOneSays) {
  for (std::uint64_t seed = 1; seed <= test::rounds(12u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random common(seed);
    const std::uint32_t pair_expiry = common.below(4), rebuild_after = common.below(3),
                        rebuild_steps = 1 + common.below(3);
    for (Way way : allWays(seed % 2 == 0,
                           {.min_gain = 1, .rebuild_after = rebuild_after, .rebuild_steps = rebuild_steps})) {
      SCOPED_TRACE(way.name);
      way.settings.pair_expiry = pair_expiry;
      Random random = common;
      MadeScene scene = randomScene(random, 4, 5);
      LayerSorter sorter = sorterOf(scene, way.settings);
      for (int frame = 0; frame < 15; ++frame) {
        SCOPED_TRACE(::testing::Message() << "frame " << frame);
        const Answer warm(sorter.update(scene.view));
        LayerSorter fresh = sorterOf(scene, way.settings);
        expectSame(warm, Answer(fresh.update(scene.view)));
        if (frame % 5 == 4) {
          expectTrue(warm, truthOf(scene), way.settings.arcs == LayerArcs::kAll);
        }
        ASSERT_FALSE(HasFailure());
        changeSomething(scene, sorter, random);
      }
    }
  }
}

TEST(LayerSorter, GroupsDoNotDependOnTheOrderInWhichPartsWereAdded) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MadeScene scene = randomScene(random, 12, 7);
    std::vector<std::uint32_t> old_of(scene.parts.size());
    MadeScene shuffled = scene;
    for (std::uint32_t i = 0; i < old_of.size(); ++i) {
      old_of[i] = i;
      std::swap(old_of[i], old_of[random.below(i + 1)]);
    }
    for (std::uint32_t i = 0; i < old_of.size(); ++i) {
      shuffled.parts[i] = scene.parts[old_of[i]];
    }
    for (const Way& way : allWays(true)) {
      SCOPED_TRACE(way.name);
      LayerSorter sorter = sorterOf(scene, way.settings), other = sorterOf(shuffled, way.settings);
      const Answer expected(sorter.update(scene.view)), answer(other.update(scene.view));
      std::set<Group> groups;
      for (Group group : answer.groups) {
        for (std::uint32_t& part : group) {
          part = old_of[part];
        }
        std::sort(group.begin(), group.end());
        groups.insert(group);
      }
      EXPECT_EQ(groups, expected.groups);
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(LayerSorter, TheSameInputGivesTheSameOrder) {
  Random random(5);
  const MadeScene scene = randomScene(random, 30, 12);
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter first = sorterOf(scene, way.settings), second = sorterOf(scene, way.settings);
    const LayerOrder &a = first.update(scene.view), &b = second.update(scene.view);
    EXPECT_TRUE(std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end()));
    EXPECT_TRUE(std::equal(a.arcs.begin(), a.arcs.end(), b.arcs.begin(), b.arcs.end()));
  }
}

// Moves and scales a whole scene.
MadeScene mapped(MadeScene scene, double scale, double shift) {
  const Vec3d by{shift, -shift, shift};
  for (MadePart& part : scene.parts) {
    std::vector<Points> hulls = placed(part);
    for (Points& points : hulls) {
      for (Vec3d& p : points) {
        p = p * scale + by;
      }
    }
    part.hulls = std::move(hulls);
    part.world_from_part = {};
  }
  scene.view.eye = scene.view.eye * scale + by;
  return scene;
}

TEST(LayerSorter, FindsTheSameFarFromTheOriginAndAtPowersOfTwo) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const MadeScene scene = randomScene(random, 6, 6);
    const Truth truth = truthOf(scene);
    for (const auto& [scale, shift] : {std::pair(1.0, 0x1p20), {0x1p-20, 0.0}, {0x1p20, 0.0}}) {
      const MadeScene other = mapped(scene, scale, shift);
      for (const Way& way : allWays(true)) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << way.name << ", scale " << scale);
        LayerSorter sorter = sorterOf(other, way.settings);
        expectTrue(Answer(sorter.update(other.view)), truth, true);
        ASSERT_FALSE(HasFailure());
      }
    }
  }
}

// Decimal scales round every coordinate, so parts that touched may become disjoint by the last digit, and
// vice versa.
TEST(LayerSorter, MissesNothingAtAnyScale) {
  for (std::uint64_t seed = 1; seed <= test::rounds(30u); ++seed) {
    Random random(seed);
    const MadeScene scene = randomScene(random, 6, 6);
    for (const auto& [scale, shift] : {std::pair(1e-6, 0.0), {1e6, 0.0}, {1.0 / 3, 1e6}, {1e-6, 1e6}}) {
      const MadeScene other = mapped(scene, scale, shift);
      const Truth truth = truthOf(other);
      for (const Way& way : allWays(true)) {
        SCOPED_TRACE(::testing::Message()
                     << "seed " << seed << ", " << way.name << ", scale " << scale << ", shift " << shift);
        LayerSorter sorter = sorterOf(other, way.settings);
        expectNothingMissing(Answer(sorter.update(other.view)), truth);
        ASSERT_FALSE(HasFailure());
      }
    }
  }
}

TEST(LayerSorter, WhatCoincidesOrTouchesIsOneGroup) {
  const Points cube = shapes::cube();
  for (const Points& other :
       {cube, shapes::moved(cube, {2, 0, 0}), shapes::moved(cube, {2, 2, 0}), shapes::moved(cube, {2, 2, 2}),
        shapes::point({1, 1, 1}), shapes::segment({1, -5, 0}, {1, 5, 0})}) {
    for (const Vec3d& eye : {Vec3d(0, 0, 9), Vec3d(1, 0, 9), Vec3d(9, 1, 1), Vec3d(1, 1, 1), Vec3d()}) {
      const MadeScene scene{{solid(cube), solid(other)}, viewFrom(eye)};
      for (const Way& way : allWays(true)) {
        SCOPED_TRACE(way.name);
        LayerSorter sorter = sorterOf(scene, way.settings);
        const Answer answer(sorter.update(scene.view));
        EXPECT_EQ(answer.groups, (std::set<Group>{{0, 1}}));
        EXPECT_EQ(answer.collisions, (std::vector<Pair>{{0, 1}}));
        EXPECT_EQ(answer.arcs, (std::vector<Pair>{{0, 1}, {1, 0}}));
      }
    }
  }
}

TEST(LayerSorter, ThreeBarsThatOverlapInACycleAreOneGroup) {
  // Each bar lies above the next one where they cross.
  MadeScene scene;
  scene.parts = {solid({{-4, -1, 0}, {4, -1, 2}, {-4, -2, 0}, {4, -2, 2}}),
                 solid({{3, -4, 0}, {-1, 4, 2}, {4, -4, 0}, {0, 4, 2}}),
                 solid({{1, 4, 0}, {-3, -4, 2}, {0, 4, 0}, {-4, -4, 2}})};
  scene.view = viewFrom({0, 0, 50});
  const Truth truth = truthOf(scene);
  ASSERT_EQ(truth.groups, (std::set<Group>{{0, 1, 2}}));
  ASSERT_EQ(truth.arcs.size(), 3u);
  for (const Way& way : allWays(false)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    expectTrue(Answer(sorter.update(scene.view)), truth, false);
  }
}

}  // namespace
}  // namespace sightline
