// Orders that hold for a set of eyes, and for parts that move meanwhile. What rays from single eyes of the
// set hit at single times is known exactly: all coordinates and shares are whole numbers over powers of two.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/layers/made_parts.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace made;

struct EyeScene {
  MadeScene made;
  std::vector<Vec3d> more_eyes;
};

EyeScene randomEyes(Random& random, std::uint32_t parts) {
  EyeScene scene{randomScene(random, parts, 5), {}};
  scene.made.view.orthographic = false;
  const std::uint32_t more = 1 + random.below(3);
  for (std::uint32_t i = 0; i < more; ++i) {
    scene.more_eyes.push_back(scene.made.view.eye + shapes::randomGrid(random, 1, 2)[0]);
  }
  return scene;
}

// An eye of the set: its corners' mean with weights of eighths.
Vec3d eyeOf(const EyeScene& scene, Random& random) {
  std::vector<Vec3d> corners = scene.more_eyes;
  corners.push_back(scene.made.view.eye);
  Vec3d sum;
  for (int i = 0; i < 8; ++i) {
    sum += corners[random.below(static_cast<std::uint32_t>(corners.size()))];
  }
  return sum / 8.0;
}

// The arcs, collisions and groups for all eyes: a part is occluded by what intersects the convex hull of one
// of its hulls and all eyes.
Truth truthOf(const EyeScene& scene) {
  Truth truth;
  std::vector<std::vector<Points>> hulls;
  std::vector<std::uint32_t> parts;
  for (std::uint32_t i = 0; i < scene.made.parts.size(); ++i) {
    hulls.push_back(placed(scene.made.parts[i]));
    parts.push_back(i);
  }
  const auto occludes = [&](const Points& front, const Points& back) {
    Points with_eyes = back;
    with_eyes.push_back(scene.made.view.eye);
    with_eyes.insert(with_eyes.end(), scene.more_eyes.begin(), scene.more_eyes.end());
    return test::convexHullsIntersect(front, with_eyes);
  };
  for (const std::uint32_t a : parts) {
    for (const std::uint32_t b : parts) {
      if (a == b) {
        continue;
      }
      if (a < b && anyHulls(hulls[a], hulls[b], test::convexHullsIntersect)) {
        truth.collisions.emplace_back(a, b);
      }
      if (anyHulls(hulls[a], hulls[b], occludes)) {
        truth.arcs.emplace_back(a, b);
      }
    }
  }
  truth.groups = strongComponents(parts, truth.arcs);
  return truth;
}

TEST(EyeSets, HaveExactlyTheArcsOfTheirConvexHull) {
  std::size_t alone = 0, grouped = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const EyeScene scene = randomEyes(random, 6);
    const Truth truth = truthOf(scene);
    for (const Group& group : truth.groups) {
      ++(group.size() > 1 ? grouped : alone);
    }
    for (const bool all_arcs : {true, false}) {
      for (const Way& way : allWays(all_arcs)) {
        SCOPED_TRACE(way.name);
        LayerSorter sorter = sorterOf(scene.made, way.settings);
        // The second frame starts from the results of the first, the last one from those of a single eye.
        for (int frame = 0; frame < 4; ++frame) {
          if (frame == 2) {
            sorter.update(scene.made.view);
            continue;
          }
          expectTrue(Answer(sorter.update(scene.made.view, scene.more_eyes)), truth, all_arcs);
        }
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_GT(alone, 50u);
  EXPECT_GT(grouped, 5u);
}

TEST(EyeSets, WhatOccludesForSomeEyeOfTheSetIsInTheOrder) {
  std::size_t only_between = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(60u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const EyeScene scene = randomEyes(random, 7);
    LayerSorter sorter = sorterOf(scene.made, {.arcs = LayerArcs::kAll}),
                middle = sorterOf(scene.made, {.arcs = LayerArcs::kAll});
    const Answer answer(sorter.update(scene.made.view, scene.more_eyes));
    const Answer of_one(middle.update(scene.made.view));
    for (int sample = 0; sample < 6; ++sample) {
      MadeScene from_one = scene.made;
      from_one.view.eye = eyeOf(scene, random);
      const Truth truth = made::truthOf(from_one);
      expectNothingMissing(answer, truth);
      for (const Pair& arc : truth.arcs) {
        only_between += of_one.hasArc(arc.first, arc.second) ? 0 : 1;
      }
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(only_between, test::rounds(20u));  // arcs that the order of one eye lacks
}

TEST(EyeSets, RulesAllowWhatTheyAllowForOneOfTheEyes) {
  // Two boxes side by side that share a face, and the plane between them.
  LayerSorter sorter({.arcs = LayerArcs::kAll});
  const auto add = [&](double from) {
    const HullId hull = sorter.addHull(*buildHull(shapes::box({from, 0, 0}, {from + 1, 1, 1})));
    return sorter.addPart({&hull, 1});
  };
  const PartId left = add(0), right = add(1);
  sorter.setRule(left, right, PairPlane{{{-1, 0, 0}, 1}});
  const auto arcs = [&](double x, const std::vector<Vec3d>& more) {
    return sorter.update(viewFrom({x, 0.5, 5}), more).arcs.size();
  };
  EXPECT_EQ(arcs(-2, {}), 1u);
  EXPECT_EQ(arcs(-2, {{0, 0.5, 5}}), 1u);
  EXPECT_EQ(arcs(-2, {{4, 0.5, 5}}), 2u);
  EXPECT_EQ(arcs(4, {{3, 0.5, 5}}), 1u);
}

TEST(EyeSets, HostileEyesGiveAnOrderOfAllParts) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  Random random(5);
  const EyeScene scene = randomEyes(random, 6);
  for (const Vec3d& eye :
       {Vec3d{nan, 0, 0}, Vec3d{0, infinity, 0}, Vec3d{1e308, -1e308, 1e308}, Vec3d{1e-320, 0, 0}}) {
    LayerSorter sorter = sorterOf(scene.made, {.arcs = LayerArcs::kAll});
    const LayerOrder& order = sorter.update(scene.made.view, {&eye, 1});
    EXPECT_EQ(order.parts.size(), scene.made.parts.size());
    if (!isFinite(eye)) {
      EXPECT_EQ(order.groups(), 1u);  // nothing is known
    }
  }
  LayerSorter sorter = sorterOf(scene.made, {}), few = sorterOf(scene.made, {});
  const std::vector<Vec3d> many(70000, scene.more_eyes[0]);
  expectSame(Answer(sorter.update(scene.made.view, many)),
             Answer(few.update(scene.made.view, {scene.more_eyes.data(), 1})));
}

TEST(EyeSets, InAnOrthographicViewThereAreNone) {
  Random random(7);
  EyeScene scene = randomEyes(random, 8);
  scene.made.view = viewFrom({0, 0, 20});
  scene.made.view.orthographic = true;
  LayerSorter sorter = sorterOf(scene.made, {.arcs = LayerArcs::kAll});
  expectTrue(Answer(sorter.update(scene.made.view, scene.more_eyes)), made::truthOf(scene.made), true);
}

// Parts and the camera move along lines; the order of swept hulls and of the eyes' way holds at all times.
TEST(EyeSets, SweptPartsHaveAnOrderThatHoldsAtAllTimes) {
  constexpr int kTimes = 8;
  std::size_t pairs = 0, groups = 0, crossings = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(40u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    MadeScene first = randomScene(random, 6, 6), last = first;
    first.view.orthographic = last.view.orthographic = false;
    last.view.eye = first.view.eye + shapes::randomGrid(random, 1, 2)[0];
    for (MadePart& part : last.parts) {
      for (int axis = 0; axis < 3; ++axis) {
        part.world_from_part(axis, 3) += random.whole(-2, 2);
        part.world_from_part(axis, axis) += random.below(4) == 0 ? 1.0 : 0.0;
      }
    }
    LayerSorter sorter({.arcs = LayerArcs::kAll});
    for (std::size_t i = 0; i < first.parts.size(); ++i) {
      std::vector<HullId> hulls;
      for (const Points& points : first.parts[i].hulls) {
        hulls.push_back(sorter.addHull(
            *sweptHull(*buildHull(points), first.parts[i].world_from_part, last.parts[i].world_from_part)));
      }
      sorter.addPart(hulls);
    }
    const Answer answer(sorter.update(first.view, {&last.view.eye, 1}));
    groups += answer.in_order.size();
    const Answer at_first(sorterOf(first, {.arcs = LayerArcs::kAll}).update(first.view));
    for (int time = 0; time <= kTimes; ++time) {
      const double t = static_cast<double>(time) / kTimes;
      MadeScene now = first;
      now.view.eye = first.view.eye * (1.0 - t) + last.view.eye * t;
      for (std::size_t i = 0; i < now.parts.size(); ++i) {
        for (std::size_t k = 0; k < 16; ++k) {
          now.parts[i].world_from_part.m[k] =
              first.parts[i].world_from_part.m[k] * (1.0 - t) + last.parts[i].world_from_part.m[k] * t;
        }
      }
      const Truth truth = made::truthOf(now);
      pairs += truth.arcs.size();
      expectNothingMissing(answer, truth);
      for (const Pair& arc : truth.arcs) {
        crossings += at_first.hasArc(arc.first, arc.second) ? 0 : 1;
      }
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(pairs, test::rounds(500u));
  EXPECT_GT(groups, test::rounds(80u));
  EXPECT_GT(crossings, test::rounds(50u));  // arcs that the order of the first time lacks
}

TEST(EyeSets, ASweptHullIsTheHullOfAllPlacesAndNoMore) {
  Mat4 last = translation({10, 0, 0});
  last(1, 1) = 3.0;
  const Result<ConvexHull> swept = sweptHull(*buildHull(shapes::cube()), {}, last);
  ASSERT_TRUE(swept);
  Points places = shapes::cube();
  for (const Vec3d& p : shapes::cube()) {
    places.push_back(transformPoint(last, p));
  }
  const ConvexHull expected = *buildHull(places);
  EXPECT_EQ(swept->vertices.size(), expected.vertices.size());
  EXPECT_LT(swept->slack, 1e-12);
  Mat4 bad;
  bad(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sweptHull(*buildHull(shapes::cube()), {}, bad));
  EXPECT_FALSE(sweptHull(ConvexHull{}, {}, {}));
}

}  // namespace
}  // namespace sightline
