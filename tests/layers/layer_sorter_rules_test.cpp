// Rules that a program sets for parts, and settings and input without meaning.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sightline/layers/compositing.h"
#include "tests/layers/made_parts.h"
#include "tests/layers/sorter_choices.h"
#include "tests/support/not_finite.h"

namespace sightline {
namespace {

using namespace made;
using PartPlace = PartSettings::Place;
using test::kInfinity;
using test::kNan;

std::vector<Group> groupsOf(const LayerOrder& order) {
  return Answer(order).in_order;
}

// Two cubes that overlap a little across the plane z = 0.
MadeScene overlapping() {
  return {{solid(shapes::box({-1, -1, -0.25}, {1, 1, 2})), solid(shapes::box({-1, -1, -2}, {1, 1, 0.25}))},
          viewFrom({0, 0, 9})};
}

TEST(LayerSorterRules, APlaneOrdersWhatReachesIntoEachOther) {
  const MadeScene scene = overlapping();
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{0, 1}}));
    sorter.setRule(PartId(0u), PartId(1u), PairPlane{{{0, 0, 1}, 0.0}});
    const Answer from_front(sorter.update(scene.view));
    EXPECT_EQ(from_front.in_order, (std::vector<Group>{{0}, {1}}));
    EXPECT_EQ(from_front.arcs, (std::vector<Pair>{{0, 1}}));
    EXPECT_TRUE(from_front.collisions.empty());
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, -9}))), (std::vector<Group>{{1}, {0}}));
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({9, 0, 0}))), (std::vector<Group>{{0, 1}})) << "in the plane";
    sorter.clearRule(PartId(1u), PartId(0u));
    const Answer without(sorter.update(scene.view));
    EXPECT_EQ(without.in_order, (std::vector<Group>{{0, 1}}));
    EXPECT_EQ(without.collisions, (std::vector<Pair>{{0, 1}}));
  }
}

TEST(LayerSorterRules, APlaneMovesWithItsFirstPart) {
  MadeScene scene = overlapping();
  LayerSorter sorter = sorterOf(scene, {});
  sorter.setRule(PartId(0u), PartId(1u), PairPlane{{{0, 0, 1}, 0.0}});
  EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{0}, {1}}));
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(sorter.setTransform(PartId(i), translation({0, 0, 20})));
  }
  EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{1}, {0}})) << "the eye is behind now";
}

TEST(LayerSorterRules, AJointOrdersSphereAndCylinder) {
  // The cylinder's cap lies inside the sphere.
  MadeScene scene{{solid(shapes::ellipsoid(16, 7, {2, 2, 2})),
                   solid(shapes::moved(shapes::prism(16, 1.0, 2.0), {0, 3, 0}))},
                  viewFrom({0, 30, 1})};
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{0, 1}}));
    sorter.setRule(PartId(0u), PartId(1u), SphereCylinderJoint{{}, 2.0, {0, 1, 0}, 1.0});
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{1}, {0}}));
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({1, -30, 0}))), (std::vector<Group>{{0}, {1}}));
  }
}

struct Says {
  PairOrder order;
  int calls = 0;
  static PairOrder ask(void* user, const View&) {
    auto* says = static_cast<Says*>(user);
    ++says->calls;
    return says->order;
  }
};

TEST(LayerSorterRules, ACallbackIsAskedOnceAFrame) {
  const MadeScene scene = overlapping();
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    Says says;
    sorter.setRule(PartId(1u), PartId(0u), PairCallback{Says::ask, &says});
    for (const auto& [order, expected] : {std::pair(PairOrder{true, false}, std::vector<Group>{{1}, {0}}),
                                          std::pair(PairOrder{false, true}, std::vector<Group>{{0}, {1}}),
                                          std::pair(PairOrder{true, true}, std::vector<Group>{{0, 1}})}) {
      says = {order, 0};
      EXPECT_EQ(groupsOf(sorter.update(scene.view)), expected);
      EXPECT_EQ(says.calls, 1);
    }
    sorter.setRule(PartId(0u), PartId(1u), PairCallback{});
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{0, 1}})) << "nobody to ask";
    sorter.setRule(PartId(0u), PartId(1u), PairPlane{{{0, 0, 1}, 0.0}});
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{0}, {1}})) << "the last rule holds";
  }
}

LayerSorter glassOfMarbles(const LayerSettings& settings, Points content) {
  LayerSorter sorter(settings);
  const std::array<HullId, 1> shell{sorter.addHull(buildHull(shapes::cube({}, 4)).value())};
  const std::array<HullId, 1> inside{sorter.addHull(buildHull(content).value())};
  const PartId marble = sorter.addPart(inside);
  const PartId back = sorter.addPart(shell), front = sorter.addPart(shell);
  const PartId other = sorter.addPart(inside);
  sorter.setTransform(other, translation({0, 0, 2}));
  sorter.setContainer(front, back);
  EXPECT_EQ(marble.value, 0u);
  return sorter;
}

TEST(LayerSorterRules, ContentIsBetweenTheFrontAndTheBackOfItsContainer) {
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = glassOfMarbles(way.settings, shapes::cube({}, 0.5));
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, 20}))), (std::vector<Group>{{2}, {3}, {0}, {1}}));
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, -20}))), (std::vector<Group>{{2}, {0}, {3}, {1}}));
    sorter.setTransform(PartId(0u), translation({0, 4, 0}));  // through the container's side
    const Answer through(sorter.update(viewFrom({0, 0, 20})));
    EXPECT_EQ(through.groupOf(0), through.groupOf(2));
    EXPECT_EQ(through.groupOf(0), through.groupOf(1));
    sorter.clearRule(PartId(1u), PartId(2u));
    sorter.setTransform(PartId(0u), translation({0, 0, 0}));
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, 20}))), (std::vector<Group>{{0, 1, 2, 3}}));
  }
}

TEST(LayerSorterRules, OverlaysAreFirstAndBackdropsLastByNumber) {
  const Points cube = shapes::cube();
  const MadeScene scene{
      {solid(cube, {.place = PartPlace::kBackdrop}), solid(cube, {.place = PartPlace::kOverlay}), solid(cube),
       solid(cube, {.place = PartPlace::kBackdrop}), solid(cube, {.place = PartPlace::kOverlay}),
       solid(shapes::moved(cube, {0, 0, 4}))},
      viewFrom({0, 0, 9})};
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    const Answer answer(sorter.update(scene.view));
    EXPECT_EQ(answer.in_order, (std::vector<Group>{{1}, {4}, {5}, {2}, {0}, {3}}));
    EXPECT_EQ(answer.arcs, (std::vector<Pair>{{5, 2}}));
    EXPECT_TRUE(answer.collisions.empty());
    sorter.setEnabled(PartId(1u), false);
    sorter.setEnabled(PartId(3u), false);
    EXPECT_EQ(groupsOf(sorter.update(scene.view)), (std::vector<Group>{{4}, {5}, {2}, {0}}));
  }
}

TEST(LayerSorterRules, DepthBufferedPartsAreOneGroupBehindWhatIsSorted) {
  const Points cube = shapes::cube();
  const auto at = [&](double z, PartPlace place) {
    return solid(shapes::moved(cube, {0, 0, z}), {.place = place});
  };
  // Depth-buffered ones lie before, between and behind the sorted ones, and one of them intersects part 1.
  const MadeScene scene{
      {at(7, PartPlace::kDepthBuffered), at(0, PartPlace::kSorted), at(0.5, PartPlace::kDepthBuffered),
       at(4, PartPlace::kSorted), at(-9, PartPlace::kBackdrop), at(-5, PartPlace::kDepthBuffered),
       at(9, PartPlace::kOverlay)},
      viewFrom({0, 0, 20})};
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter = sorterOf(scene, way.settings);
    const LayerOrder& order = sorter.update(scene.view);
    const Answer answer(order);
    EXPECT_EQ(answer.in_order, (std::vector<Group>{{6}, {3}, {1}, {0, 2, 5}, {4}}));
    EXPECT_EQ(answer.arcs, (std::vector<Pair>{{3, 1}}));
    EXPECT_TRUE(answer.collisions.empty());
    EXPECT_EQ(order.first_sorted, 1u);
    EXPECT_EQ(order.depth_buffered, 3u);
    EXPECT_LE(order.stats.pair_queries, 3u) << "of the two sorted parts: each before the other, and touching";
    LayerMerger merger;
    const FrameLayers& layers = merger.merge(order);
    EXPECT_TRUE(checkLayers(layers));
    EXPECT_EQ(layers.layers(), 5u);
    EXPECT_EQ(layers.depth_buffered, LayerId(3u));
    EXPECT_EQ(layers.first_hidden, LayerId(1u));
    EXPECT_EQ(layers.partsOf(layers.depth_buffered).size(), 3u);
    for (const std::uint32_t part : {0u, 2u, 5u}) {
      sorter.setEnabled(PartId(part), false);
    }
    EXPECT_EQ(sorter.update(scene.view).depth_buffered, LayerOrder::kNone);
    EXPECT_FALSE(merger.merge(sorter.update(scene.view)).depth_buffered.valid());
  }
}

TEST(LayerSorterRules, AStaticPartMovesOnlyBeforeItIsSorted) {
  LayerSorter sorter;
  const PartId still = addMade(sorter, solid(shapes::cube(), {.is_static = true}));
  const PartId other = addMade(sorter, solid(shapes::cube({0, 0, -3})));
  EXPECT_TRUE(sorter.setTransform(still, translation({0, 0, 3})));
  EXPECT_TRUE(sorter.setTransform(still, translation({0, 0, -6})));
  EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, 9}))), (std::vector<Group>{{1}, {0}}));
  EXPECT_FALSE(sorter.setTransform(still, translation({0, 0, 3})));
  EXPECT_TRUE(sorter.setTransform(other, translation({0, 0, 1})));
  EXPECT_EQ(groupsOf(sorter.update(viewFrom({0, 0, 9}))), (std::vector<Group>{{1}, {0}}));
}

TEST(LayerSorterRules, WhatIsNotFiniteIsOneGroupWithAllUntilItIsAgain) {
  const Points cube = shapes::cube();
  MadeScene scene{
      {solid(cube), solid(shapes::moved(cube, {20, 0, 0})), solid(shapes::moved(cube, {0, 20, 0}))},
      viewFrom({0, 0, 9})};
  for (const Way& way : allWays(true)) {
    LayerSorter sorter = sorterOf(scene, way.settings);
    const Answer before(sorter.update(scene.view));
    EXPECT_EQ(before.groups.size(), 3u);
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      for (const int column : {0, 3}) {
        SCOPED_TRACE(::testing::Message() << way.name << ", " << bad << ", " << column);
        Mat4 m;
        m(1, column) = bad;
        EXPECT_TRUE(sorter.setTransform(PartId(1u), m));
        const Answer answer(sorter.update(scene.view));
        EXPECT_EQ(answer.groups, (std::set<Group>{{0, 1, 2}}));
        EXPECT_TRUE(answer.hasArc(0, 1) && answer.hasArc(1, 0) && answer.hasArc(1, 2) && answer.hasArc(2, 1));
        EXPECT_TRUE(sorter.setTransform(PartId(1u), {}));
        expectSame(Answer(sorter.update(scene.view)), before);
      }
    }
    for (const double bad : {kNan, kInfinity}) {
      EXPECT_EQ(Answer(sorter.update(viewFrom({bad, 0, 0}))).groups, (std::set<Group>{{0, 1, 2}}))
          << way.name;
    }
    expectSame(Answer(sorter.update(scene.view)), before);
  }
}

// A finite transform whose result, or its square, is not finite groups the part with all others.
TEST(LayerSorterRules, WhatIsTooLargeIsOneGroupWithAll) {
  const Points cube = shapes::cube();
  const MadeScene scene{{solid(cube), solid(shapes::moved(cube, {20, 0, 0})), solid(shapes::cube({}, 4))},
                        viewFrom({0, 0, 9})};
  for (const Way& way : allWays(true)) {
    for (const double size : {1e100, 1e160, 1e300, 1.7e308}) {
      SCOPED_TRACE(::testing::Message() << way.name << ", size " << size);
      LayerSorter sorter = sorterOf(scene, way.settings);
      Mat4 m;
      m(0, 0) = m(1, 1) = m(2, 2) = size;
      EXPECT_TRUE(sorter.setTransform(PartId(2u), m));
      EXPECT_EQ(Answer(sorter.update(scene.view)).groups, (std::set<Group>{{0, 1, 2}}));
    }
  }
}

TEST(LayerSorterRules, FlattenedPartsAreStillSorted) {
  // Singular transforms that flatten the part to a polygon, a line and a point.
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    MadeScene scene = randomScene(random, 5, 4);
    for (MadePart& part : scene.parts) {
      const int axes = random.whole(0, 3);
      for (int axis = 0; axis < axes; ++axis) {
        for (int column = 0; column < 3; ++column) {
          part.world_from_part(axis, column) = 0.0;
        }
      }
    }
    const Truth truth = truthOf(scene);
    for (const Way& way : allWays(true)) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << way.name);
      LayerSorter sorter = sorterOf(scene, way.settings);
      expectTrue(Answer(sorter.update(scene.view)), truth, true);
    }
  }
}

TEST(LayerSorterRules, SettingsOutOfRangeAreMadeUsable) {
  Random random(4);
  const MadeScene scene = randomScene(random, 8, 6);
  const Truth truth = truthOf(scene);
  for (const std::uint32_t conditioning_axis : {0u, 1u, 2u, 3u, 16u, 1000u, 0xffffffffu}) {
    for (const std::size_t axes : {0u, 1u, 3u, 16u, 17u, 40u}) {
      SCOPED_TRACE(::testing::Message() << axes << " axes, conditioned along " << conditioning_axis);
      LayerSettings settings;
      settings.arcs = LayerArcs::kAll;
      settings.conditioning_axis = conditioning_axis;
      settings.extents.clear();
      for (std::size_t i = 0; i < axes; ++i) {
        settings.extents.push_back(cameraExtents()[i % 3]);
      }
      settings.pair_expiry = axes == 3 ? 0 : 0xffffffffu;
      settings.search = searchOf(
          axes % 2 == 0 ? SearchChoice::kTree : SearchChoice::kScan,
          {.min_gain = 0, .rebuild_after = 1, .rebuild_imbalance = kNan, .rebuild_steps = 0, .tree_axes = 0});
      LayerSorter sorter = sorterOf(scene, settings);
      for (int frame = 0; frame < 4; ++frame) {
        expectTrue(Answer(sorter.update(scene.view)), truth, true);
      }
    }
  }
}

TEST(LayerSorterRules, AxesWithoutDirectionBoundNothing) {
  Random random(8);
  const MadeScene scene = randomScene(random, 8, 6);
  const Truth truth = truthOf(scene);
  for (const Vec3d& direction : {Vec3d(), Vec3d(kNan, 0, 0), Vec3d(kInfinity, 1, 0), Vec3d(1e-300, 0, 0)}) {
    for (const auto kind : {ExtentAxis::Kind::kSpatial, ExtentAxis::Kind::kAngular}) {
      LayerSettings settings;
      settings.arcs = LayerArcs::kAll;
      settings.extents = {{kind, ExtentAxis::Frame::kWorld, direction, {0, 0, 1}},
                          {kind, ExtentAxis::Frame::kCamera, {1, 0, 0}, direction}};
      settings.conditioning_axis = 0;
      LayerSorter sorter = sorterOf(scene, settings);
      expectTrue(Answer(sorter.update(scene.view)), truth, true);
    }
  }
}

TEST(LayerSorterRules, NoPartsAndOnePartAndNoneEnabledHaveAnOrder) {
  for (const Way& way : allWays(true)) {
    SCOPED_TRACE(way.name);
    LayerSorter sorter(way.settings);
    sorter.reset();
    EXPECT_EQ(sorter.parts(), 0u);
    EXPECT_EQ(sorter.update(viewFrom({})).groups(), 0u);
    sorter.rebuildSearch();
    EXPECT_TRUE(sorter.update(viewFrom({})).parts.empty());
    const PartId only = addMade(sorter, solid(shapes::cube()));
    EXPECT_EQ(sorter.parts(), 1u);
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({}))), (std::vector<Group>{{0}}));
    sorter.setEnabled(only, false);
    const LayerOrder& none = sorter.update(viewFrom({}));
    EXPECT_EQ(none.groups(), 0u);
    EXPECT_TRUE(none.parts.empty() && none.arcs.empty() && none.collisions.empty());
    sorter.setEnabled(only, true);
    EXPECT_EQ(groupsOf(sorter.update(viewFrom({}))), (std::vector<Group>{{0}}));
  }
}

TEST(LayerSorterRules, AMovedSorterGoesOnWhereItWas) {
  Random random(6);
  const MadeScene scene = randomScene(random, 6, 6);
  LayerSorter sorter = sorterOf(scene, {});
  const Answer before(sorter.update(scene.view));
  LayerSorter other = std::move(sorter);
  expectSame(Answer(other.update(scene.view)), before);
}

}  // namespace
}  // namespace sightline
