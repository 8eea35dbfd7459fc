#include "sightline/culling/while_it_pays.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
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
