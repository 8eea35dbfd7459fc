// Scenes that leave parts out: what a method does not need may be missing, and what it needs must not hide
// anything by being missing.

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/culling/demo_frames.h"
#include "tests/culling/fake_sets.h"
#include "tests/culling/kept_objects.h"

namespace sightline {
namespace {

using namespace demo_frames;
using kept_objects::visibleOf;

std::vector<ObjectId> allOf(const DemoScene& demo) {
  std::vector<ObjectId> all;
  for (std::size_t i = 0; i < demo.bounds.size(); ++i) {
    all.push_back(ObjectId(i));
  }
  return all;
}

TEST(MissingParts, WithoutAHierarchyMethodsThatNeedOneKeepEverything) {
  const DemoScene& demo = smallCity();
  for (const NamedSettings& method : kStructures) {
    Culler culler({.object_bounds = demo.bounds, .occluders = &demo.occluders}, makeMethod(method.settings));
    for (const View& view : demo.frames(demo.scene.paths[0], 40, 2)) {
      EXPECT_EQ(visibleOf(culler, view), allOf(demo)) << method.name;
      EXPECT_NE(culler.stats().scene_fault, nullptr) << method.name;
    }
  }
}

TEST(MissingParts, WithoutOccludersEveryMethodIsViewFrustumCulling) {
  const DemoScene& demo = smallCity();
  const CullingScene scene{.hierarchy = &demo.bvh, .object_bounds = demo.bounds};
  for (const NamedSettings& method : kStructures) {
    Culler culler(scene, makeMethod(method.settings)), frustum(scene, frustumCulling());
    for (const View& view : demo.frames(demo.scene.paths[0], 40, 4)) {
      EXPECT_EQ(visibleOf(culler, view), visibleOf(frustum, view)) << method.name;
      EXPECT_NE(culler.stats().scene_note, nullptr) << method.name;
      EXPECT_EQ(frustum.stats().scene_note, nullptr);
      EXPECT_EQ(culler.stats().scene_fault, nullptr) << method.name;
    }
  }
}

TEST(MissingParts, SetsAloneGiveWhatTheyGiveWithAHierarchy) {
  const DemoScene& demo = smallCity();
  for (const bool with_sets : {true, false}) {
    fake_sets::FakeSets sets(demo.bounds);
    std::vector<bool> members(demo.bounds.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      members[i] = i % 3 != 0;
    }
    sets.use(1, members);
    VisibleSets* const used = with_sets ? &sets : nullptr;
    Culler alone({.object_bounds = demo.bounds, .sets = used}, visibilityOctree());
    Culler whole({.hierarchy = &demo.bvh, .object_bounds = demo.bounds, .sets = used}, visibilityOctree());
    for (const View& view : demo.frames(demo.scene.paths[0], 40, 6)) {
      EXPECT_EQ(visibleOf(alone, view), visibleOf(whole, view));
      EXPECT_EQ(alone.stats().scene_fault, nullptr);
      EXPECT_GT(alone.visible().size(), 0u);
      EXPECT_LT(alone.visible().size(), demo.bounds.size());
    }
  }
}

TEST(MissingParts, BadBoxesAreKeptWithoutAHierarchy) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Box> bounds{{{kNan, 0, 0}, {1, 1, 1}},
                                {{2, 2, 2}, {1, 1, 1}},
                                {{-kInfinity, 0, 0}, {kInfinity, 1, 1}},
                                {{0, 0, 1000}, {1, 1, 1001}}};
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  Culler culler({.object_bounds = bounds}, visibilityOctree());
  EXPECT_EQ(visibleOf(culler, view), (std::vector<ObjectId>{ObjectId(0u), ObjectId(1u), ObjectId(2u)}));
}

TEST(MissingParts, StatisticsAreZeroWhereEverythingIsKept) {
  const DemoScene& demo = smallCity();
  AnyCuller culler = demo.culler(HierarchyKind::kBvh, {.variant = OcclusionTreeVariant::kFSE});
  const View view = demo.frames(demo.scene.paths[0], 40, 1)[0];
  EXPECT_EQ(culler.statistic("tree", "nodes"), 0u) << "before the first frame";
  culler.cull(view);
  EXPECT_GT(culler.statistic("tree", "nodes"), 0u);
  View none = view;
  none.eye.x = std::numeric_limits<double>::quiet_NaN();
  culler.cull(none);
  ASSERT_NE(culler.stats().view_fault, nullptr);
  EXPECT_EQ(culler.statistic("tree", "nodes"), 0u);
  culler.cull(view);
  EXPECT_GT(culler.statistic("tree", "nodes"), 0u);
  culler.Culler::reset();
  EXPECT_EQ(culler.statistic("tree", "nodes"), 0u);
}

}  // namespace
}  // namespace sightline
