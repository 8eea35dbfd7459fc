// Invalid and extreme input must neither crash the sorter nor make it miss an arc.

#include <gtest/gtest.h>

#include <limits>

#include "sightline/layers/compositing.h"
#include "sightline/layers/layer_sorter.h"
#include "tests/support/translation.h"

namespace sightline {
namespace {

using test::translation;

ConvexHull point() {
  return *buildHull(std::vector<Vec3d>{{0, 0, 0}});
}

ConvexHull cube() {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  }
  return *buildHull(corners);
}

// Makes two parts with one hull each, the second at a distance of `behind` along -z.
LayerSorter two(const ConvexHull& hull, double behind, LayerSettings settings = {}) {
  settings.arcs = LayerArcs::kAll;
  LayerSorter sorter(settings);
  const HullId id = sorter.addHull(hull);
  sorter.addPart({&id, 1});
  sorter.setTransform(sorter.addPart({&id, 1}), translation({0, 0, -behind}));
  return sorter;
}

View orthographic(const Vec3d& forward) {
  View view;
  view.orthographic = true;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.forward = forward;
  return view;
}

const std::vector<LayerArc> kFirstOccludes{{PartId(0u), PartId(1u)}};

TEST(HostileSorter, PointsInTheSamePlaceOccludeEachOther) {
  LayerSorter sorter = two(point(), 0.0);
  EXPECT_EQ(sorter.update(orthographic({0, 0, -1})).arcs.size(), 2u);
}

TEST(HostileSorter, AnOrthographicViewsForwardMayHaveAnyLength) {
  for (const double length : {1e-300, 1e-170, 1e-20, 1.0, 1e20, 1e170, 1e300}) {
    LayerSorter sorter = two(cube(), 100.0);
    const LayerOrder& order = sorter.update(orthographic({0, 0, -length}));
    EXPECT_EQ(std::vector<LayerArc>(order.arcs.begin(), order.arcs.end()), kFirstOccludes) << length;
  }
}

// With a right of (1, 0, skew), the cube's side at x = 0 appears where x = 10,000 skew is 10 km behind it.
TEST(HostileSorter, AnOrthographicViewLooksAtRightAnglesToRightAndUp) {
  for (const double skew : {9e-7, -9e-7}) {
    for (const double x : {0.004, 0.008, 0.01, 0.014, -0.004, -0.008, -0.01, -0.014}) {
      LayerSettings settings;
      settings.arcs = LayerArcs::kAll;
      LayerSorter sorter(settings);
      const HullId near = sorter.addHull(cube()), far = sorter.addHull(point());
      sorter.setTransform(sorter.addPart({&near, 1}), translation({-1, 0, 0}));
      sorter.setTransform(sorter.addPart({&far, 1}), translation({x, 0, -10000}));
      View view = orthographic({0, 0, -1});
      view.right = {1, 0, skew};
      ASSERT_TRUE(validate(view));
      const LayerOrder& order = sorter.update(view);
      EXPECT_EQ(std::vector<LayerArc>(order.arcs.begin(), order.arcs.end()),
                x < 10000 * skew ? kFirstOccludes : std::vector<LayerArc>())
          << skew << ' ' << x;
    }
  }
}

TEST(HostileSorter, AxesThatSpanNoPlaneRuleNothingOut) {
  for (const Vec3d& direction : {Vec3d(1, 1, 1), Vec3d(-2, -2, -2), Vec3d(0, 0, 0), Vec3d(1e-300, 0, 0)}) {
    LayerSettings settings;
    settings.conditioning = false;
    settings.extents = {{ExtentAxis::Kind::kAngular, ExtentAxis::Frame::kWorld, direction, {1, 1, 1}},
                        {ExtentAxis::Kind::kSpatial, ExtentAxis::Frame::kWorld, direction * 0.0}};
    LayerSorter sorter = two(cube(), 100.0, settings);
    View view;
    view.eye = {0.3, 0.1, 0.2};  // inside the first part
    const LayerOrder& order = sorter.update(view);
    EXPECT_EQ(std::vector<LayerArc>(order.arcs.begin(), order.arcs.end()), kFirstOccludes);
  }
}

TEST(HostileSorter, AHullWithoutVerticesCanBeAnywhere) {
  LayerSorter sorter;
  const HullId empty = sorter.addHull({}), solid = sorter.addHull(cube());
  const PartId first = sorter.addPart({&empty, 1}), second = sorter.addPart({&solid, 1});
  sorter.setTransform(first, translation({0, 0, -5}));
  sorter.setTransform(second, translation({0, 0, -50}));
  EXPECT_EQ(sorter.update(View{}).groups(), 1u);
}

TEST(HostileSorter, RulesOfNoPartAreLeftOut) {
  LayerSorter sorter = two(cube(), 10.0);
  sorter.setRule(PartId(0u), PartId(), PairPlane{{{0, 0, 1}, 5}});
  sorter.setRule(PartId(7u), PartId(1u), SphereCylinderJoint{});
  sorter.setRule(PartId(), PartId(), PairCallback{});
  sorter.clearRule(PartId(0u), PartId(9u));
  sorter.setContainer(PartId(), PartId(1u));
  sorter.setContainer(PartId(1u), PartId(1u));
  View view;
  view.eye = {0, 0, 20};
  const LayerOrder& order = sorter.update(view);
  EXPECT_EQ(std::vector<LayerArc>(order.arcs.begin(), order.arcs.end()), kFirstOccludes);
}

TEST(HostileSorter, AViewThatIsNotFiniteJoinsEverything) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    LayerSorter sorter = two(cube(), 10.0);
    View view;
    view.eye = {0, bad, 0};
    EXPECT_EQ(sorter.update(view).groups(), 1u);
    EXPECT_EQ(sorter.update(orthographic({0, bad, 0})).groups(), 1u);
    EXPECT_EQ(sorter.update(orthographic({0, 0, 0})).groups(), 1u);
  }
}

TEST(CheckLayers, TakesWhatIsMergedAndRefusesTheRest) {
  FrameLayers sound;
  sound.parts = {PartId(4u), PartId(2u), PartId(9u)};
  sound.first_part = {0, 1, 2, 3};
  sound.first_layer = {0, 3};
  sound.occlusions = {{LayerId(0u), LayerId(1u)}, {LayerId(1u), LayerId(2u)}, {LayerId(2u), LayerId(0u)}};
  EXPECT_TRUE(checkLayers(sound));
  EXPECT_TRUE(checkLayers(FrameLayers{}));
  const auto refused = [&](const auto& damage) {
    FrameLayers layers = sound;
    damage(layers);
    return !checkLayers(layers);
  };
  EXPECT_TRUE(refused([](FrameLayers& l) { l.occlusions[1].back = LayerId(3u); }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.occlusions[1].back = LayerId(); }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.occlusions[1].back = LayerId(1u); }));
  EXPECT_TRUE(refused([](FrameLayers& l) { std::swap(l.occlusions[0], l.occlusions[1]); }));
  EXPECT_TRUE(refused([](FrameLayers& l) {
    l.occlusions = {{LayerId(0u), LayerId(1u)}, {LayerId(1u), LayerId(0u)}};
  }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.first_layer = {0, 1, 3}; }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.first_layer = {0, 4}; }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.first_part = {0, 2, 1, 3}; }));
  EXPECT_TRUE(refused([](FrameLayers& l) { l.parts.pop_back(); }));
}

}  // namespace
}  // namespace sightline
