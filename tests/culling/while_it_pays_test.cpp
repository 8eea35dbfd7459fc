#include "sightline/culling/while_it_pays.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/frustum_method.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/visibility_octree_method.h"
#include "tests/culling/culled_scene.h"
#include "tests/culling/fake_sets.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

constexpr std::size_t kHiddenWalls = 50;

// A wall before the eye of frontView(), and kHiddenWalls small walls behind it.
CulledScene wallAndHidden() {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, material, -10.0f, -8.0f, 8.0f, -8.0f, 8.0f);
  for (std::size_t i = 0; i < kHiddenWalls; ++i) {
    const float x = -5.0f + 0.2f * static_cast<float>(i);
    addWall(scene, material, -20.0f - 0.1f * static_cast<float>(i), x, x + 0.1f, -1.0f, 1.0f);
  }
  return CulledScene(std::move(scene));
}

std::unique_ptr<CullingMethod> anyMethod(bool pyramid) {
  return pyramid ? depthPyramid() : occlusionTree();
}

class WhileItPaysAny : public testing::TestWithParam<bool> {};

std::vector<ObjectId> visibleIn(const Culler& culler) {
  return {culler.visible().begin(), culler.visible().end()};
}

TEST_P(WhileItPaysAny, AnExpensiveRendererIsNeverGivenMoreThanTheMethodKeeps) {
  const CulledScene scene = wallAndHidden();
  for (const RendererCost cost : {RendererCost{1e6, 0.0}, RendererCost{0.0, 1e6}}) {
    Culler culler(scene.parts(), whileItPays(anyMethod(GetParam()), cost));
    Culler plain(scene.parts(), anyMethod(GetParam()));
    for (int frame = 0; frame < 200; ++frame) {
      culler.cull(frontView());
      plain.cull(frontView());
      ASSERT_EQ(visibleIn(culler), visibleIn(plain)) << frame;
      ASSERT_EQ(culler.statistic("renderer", "given_up"), 0u) << frame;
    }
    const std::size_t removed = scene.bounds.size() - culler.visible().size();
    EXPECT_GT(removed, kHiddenWalls / 2);
    // Two triangles an object.
    EXPECT_EQ(
        culler.statistic("renderer", "saved_us"),
        static_cast<std::uint64_t>(static_cast<double>(removed) * (cost.object_us + 2 * cost.triangle_us)));
  }
}

TEST_P(WhileItPaysAny, WhereDrawingCostsNothingTheFrustumCulls) {
  const CulledScene scene = wallAndHidden();
  Culler culler(scene.parts(), whileItPays(anyMethod(GetParam()), {1e-9, 0.0}));
  Culler frustum(scene.parts(), frustumCulling());
  int given_up = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    View view = frontView();
    view.eye.x = 0.01 * (frame % 10);
    const std::vector<Box> moving(3, scene.bounds[7]);
    culler.cull(view, moving);
    frustum.cull(view, moving);
    if (culler.statistic("renderer", "given_up") != 0) {
      ++given_up;
      ASSERT_EQ(visibleIn(culler), visibleIn(frustum)) << frame;
      ASSERT_EQ(culler.dynamicStates()[0], Visibility::kVisible) << frame;
      ASSERT_TRUE(culler.occludersUsed().empty()) << frame;
      ASSERT_EQ(culler.depthBuffer().width, 0u) << frame;
      ASSERT_EQ(culler.stats().occluders, 0u) << frame;
    } else {
      ASSERT_LT(culler.visible().size(), kHiddenWalls / 2) << frame;
      ASSERT_EQ(culler.dynamicStates()[0], Visibility::kHidden) << frame;
    }
  }
  EXPECT_GT(given_up, 900);
  EXPECT_LT(given_up, 1000) << "it is tried again";
}

TEST_P(WhileItPaysAny, AfterAJumpTheMethodIsTriedAgain) {
  const CulledScene scene = wallAndHidden();
  Culler culler(scene.parts(), whileItPays(anyMethod(GetParam()), {1e-9, 0.0}));
  int in_a_row = 0;
  for (int frame = 0; frame < 1000 && in_a_row < 60; ++frame) {
    culler.cull(frontView());
    in_a_row = culler.statistic("renderer", "given_up") != 0 ? in_a_row + 1 : 0;
  }
  ASSERT_EQ(in_a_row, 60) << "far from the end of a delay of 128 frames";
  View away = frontView();
  setOrientation(away, {0, 0, 1}, {0, 1, 0});
  culler.cull(away);
  culler.cull(frontView());
  EXPECT_EQ(culler.statistic("renderer", "given_up"), 0u);
  EXPECT_LT(culler.visible().size(), kHiddenWalls / 2);
}

TEST_P(WhileItPaysAny, CostsThatAreNoNumbersCountAsNothing) {
  const CulledScene scene = wallAndHidden();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double us : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, -1.0, 1e300}) {
    Culler culler(scene.parts(), whileItPays(anyMethod(GetParam()), {us, us}));
    for (int frame = 0; frame < 100; ++frame) {
      culler.cull(frontView());
    }
    EXPECT_EQ(culler.statistic("renderer", "saved_us") > 0, us == 1e300) << us;
  }
}

TEST_P(WhileItPaysAny, ASetThatChangesMeanwhileIsThatOfTheMethodToo) {
  const CulledScene scene = wallAndHidden();
  fake_sets::FakeSets sets(scene.bounds);
  CullingScene parts = scene.parts();
  parts.sets = &sets;
  Culler culler(parts, whileItPays(anyMethod(GetParam()), {1e-9, 0.0}), {.visible_sets = true});
  // The wall is always in the set, and seen; a set without it would be wrong.
  std::vector<bool> others(scene.bounds.size(), true), wall(scene.bounds.size(), false);
  others[0] = false;
  wall[0] = true;
  int resumed = 0;
  bool gave_up = false;
  for (int frame = 0; frame < 1000; ++frame) {
    // The set changes while frames are culled by the frustum alone.
    if (gave_up) {
      sets.use(1, wall);
    } else {
      sets.use(0, others);
    }
    culler.cull(frontView());
    const bool now = culler.statistic("renderer", "given_up") != 0;
    resumed += gave_up && !now ? 1 : 0;
    if (gave_up) {
      ASSERT_EQ(visibleIn(culler), std::vector<ObjectId>{ObjectId(0u)}) << frame;
    }
    gave_up = now;
  }
  EXPECT_GT(resumed, 3);
}

View walkingView(int frame) {
  View view = frontView();
  view.eye.x = 0.001 * frame;
  return view;
}

TEST(WhileItPays, SeveralViewsAreCulledAtOnce) {
  const CulledScene scene = wallAndHidden();
  const CullingScene parts = scene.parts();
  const CullerSettings settings{.views_at_once = 6};
  Culler culler(parts, whileItPays(depthPyramid(), {1e6, 0.0}), settings);
  Culler plain(parts, depthPyramid(), settings);
  int held = 0;
  for (int frame = 0; frame < 200; ++frame) {
    culler.cull(walkingView(frame));
    plain.cull(walkingView(frame));
    ASSERT_EQ(culler.stats().held, plain.stats().held) << frame;
    ASSERT_EQ(visibleIn(culler), visibleIn(plain)) << frame;
    held += culler.stats().held ? 1 : 0;
  }
  EXPECT_GT(held, 100);
  EXPECT_LT(culler.visible().size(), kHiddenWalls / 2);
}

// Frames that are culled by the frustum alone are culled one by one: no answer is held while the method is
// given up, and the frustum's answer is not held once it resumes.
TEST(WhileItPays, WhatIsGivenUpIsNotHeld) {
  const CulledScene scene = wallAndHidden();
  const CullingScene parts = scene.parts();
  Culler culler(parts, whileItPays(depthPyramid(), {1e-9, 0.0}), {.views_at_once = 6});
  Culler frustum(parts, frustumCulling());
  const std::vector<Box> moving{scene.bounds[7]};
  int given_up = 0, held = 0, resumed = 0;
  bool gave_up = false;
  for (int frame = 0; frame < 3000; ++frame) {
    culler.cull(walkingView(frame % 1000), moving);
    frustum.cull(walkingView(frame % 1000));
    const bool now = culler.statistic("renderer", "given_up") != 0;
    if (now) {
      ++given_up;
      ASSERT_FALSE(culler.stats().held) << frame;
      ASSERT_EQ(visibleIn(culler), visibleIn(frustum)) << frame;
      ASSERT_EQ(culler.dynamicStates()[0], Visibility::kVisible) << frame;
    } else {
      ASSERT_EQ(visibleIn(culler).front(), ObjectId(0u)) << frame;
      ASSERT_LT(culler.visible().size(), kHiddenWalls / 2) << frame;
      ASSERT_EQ(culler.dynamicStates()[0], Visibility::kHidden) << frame;
    }
    held += culler.stats().held ? 1 : 0;
    resumed += gave_up && !now ? 1 : 0;
    gave_up = now;
  }
  EXPECT_GT(given_up, 2000);
  EXPECT_GT(resumed, 3);
  EXPECT_GT(held, 20);
}

// Hides everything from whoever asks, and writes down for how many frames its answers held.
class HidesAll final : public CullingMethod {
 public:
  explicit HidesAll(std::vector<std::uint32_t>& held) : held_(held) {}
  MethodTraits traits() const override { return {}; }
  bool answersForRegions() const override { return true; }
  void prepare(const CullingScene&) override {}
  void build(const CullingFrame& frame) override { held_.push_back(frame.held_before); }
  void traverse(const CullingFrame&, CullStats&, std::vector<ObjectId>&) override {}

 private:
  std::vector<std::uint32_t>& held_;
};

TEST(WhileItPays, WhatServesSeveralFramesMayTakeAsMuchMore) {
  const CulledScene scene = wallAndHidden();
  const ParallelFor serial = serialFor;
  for (const std::uint32_t held : {0u, 7u}) {
    std::vector<std::uint32_t> told;
    const auto method = whileItPays(std::make_unique<HidesAll>(told), {1e4, 0.0});
    method->prepare(scene.parts());
    const View view = frontView();
    const CullingFrame frame{.view = view,
                             .frustum = frustumOf(view),
                             .viewers = {.radius = 0.125},
                             .held_before = held,
                             .parallel_for = &serial};
    int suspended = 0;
    for (int i = 0; i < 100; ++i) {
      CullStats stats;
      std::vector<ObjectId> visible;
      method->build(frame);
      method->traverse(frame, stats, visible);
      stats.build_us = 2e6;  // to save half a second a frame
      method->finish(stats);
      suspended += method->answersForRegions() ? 0 : 1;
    }
    EXPECT_EQ(suspended > 0, held == 0) << suspended;
  }
}

TEST(WhileItPays, MethodsAreToldForHowManyFramesTheirAnswersHeld) {
  const CulledScene scene = wallAndHidden();
  std::vector<std::uint32_t> told, expected;
  Culler culler(scene.parts(), std::make_unique<HidesAll>(told), {.views_at_once = 6});
  std::uint32_t held = 0;
  for (int frame = 0; frame < 60; ++frame) {
    culler.cull(walkingView(frame));
    if (culler.stats().held) {
      ++held;
    } else {
      expected.push_back(std::exchange(held, 0u));
    }
  }
  EXPECT_EQ(told, expected);
  EXPECT_LT(told.size(), 20u);
}

TEST(WhileItPays, WithoutAHierarchyEverythingIsKept) {
  const CulledScene scene = wallAndHidden();
  CullingScene parts = scene.parts();
  parts.hierarchy = nullptr;
  Culler culler(parts, whileItPays(visibilityOctree(), {1e-9, 0.0}));
  for (int frame = 0; frame < 100; ++frame) {
    culler.cull(frontView());
    ASSERT_EQ(culler.visible().size(), scene.bounds.size()) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, WhileItPaysAny, testing::Bool(),
                         [](const auto& method) { return method.param ? "DepthPyramid" : "OcclusionTree"; });

}  // namespace
}  // namespace sightline
