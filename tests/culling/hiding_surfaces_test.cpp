// From view to view, only surfaces that hide something are drawn.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/surface_set.h"
#include "tests/oracle/hand_made.h"

namespace sightline::culling {
namespace {

using hand_made::addMaterial;
using hand_made::addWall;

// A scene and what a culler needs of it.
struct Prepared {
  explicit Prepared(const Scene& scene) : surfaces(findSurfaces(scene.view())) {
    for (const Object& object : scene.objects) {
      bounds.push_back(object.bounds);
    }
    hierarchy = buildHierarchy(bounds, {});
  }
  CullingScene scene() const {
    return {.hierarchy = &hierarchy, .object_bounds = bounds, .surfaces = &surfaces};
  }

  std::vector<Box> bounds;
  Hierarchy hierarchy;
  SurfaceSet surfaces;
};

TEST(HidingSurfaces, AWallIsDrawnAndWhatStandsBeforeItIsNot) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
  constexpr std::size_t kPanels = 25;
  for (std::size_t i = 0; i < kPanels; ++i) {
    const float x = static_cast<float>(i % 5) - 2.5f, y = static_cast<float>(i / 5) - 2.5f;
    addWall(scene, stone, -5.0f, x + 0.1f, x + 0.9f, y + 0.1f, y + 0.9f);
  }
  const ObjectId wall = addWall(scene, stone, -10.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  for (int i = 0; i < 100; ++i) {
    const auto x = static_cast<float>(i % 10), y = static_cast<float>(i / 10);
    addWall(scene, stone, -20.0f - x, x - 5.0f, x - 4.5f, y - 5.0f, y - 4.5f);
  }
  const Prepared prepared(scene);
  Culler culler(prepared.scene(), depthPyramid({.focus = {.windows = 0}}));
  View view = hand_made::frontView();
  culler.cull(view);
  EXPECT_GT(culler.statistic("surfaces", "groups"), kPanels) << "nothing is known in the first view";
  std::size_t groups = 0;
  constexpr int kViews = 40;
  for (int i = 0; i < kViews; ++i) {
    view.eye.x += 0.02;
    culler.cull(view);
    ASSERT_EQ(culler.visible().size(), kPanels + 1) << i;
    EXPECT_EQ(culler.visible().back(), wall);
    groups += culler.statistic("surfaces", "groups");
  }
  // Now and then, less and less often, the panels are tried before what is kept.
  EXPECT_LT(groups, kViews * kPanels / 4);
  EXPECT_GE(groups, std::size_t{kViews});
}

// A wall that has hidden nothing so far is found as soon as an object has been behind it for a while.
TEST(HidingSurfaces, WhatComesToBeHiddenIsFound) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
  const ObjectId wall = addWall(scene, stone, -10.0f, 2.0f, 8.0f, -3.0f, 3.0f);
  const ObjectId panel = addWall(scene, stone, -20.0f, -1.0f, 1.0f, -1.0f, 1.0f);
  const ObjectId other_wall = addWall(scene, stone, -10.0f, -9.0f, -4.0f, -3.0f, 3.0f);
  addWall(scene, stone, -20.0f, -15.0f, -13.0f, -1.0f, 1.0f);  // behind it from the start
  const Prepared prepared(scene);
  Culler culler(prepared.scene(), depthPyramid());
  View view = hand_made::frontView();
  culler.cull(view);
  const std::vector<ObjectId> at_first(culler.visible().begin(), culler.visible().end());
  EXPECT_EQ(at_first, (std::vector{wall, panel, other_wall}));
  // To the right, until the panel is behind the first wall, and then no farther.
  int views = 0;
  for (; views < 600 && std::ranges::count(culler.visible(), panel) > 0; ++views) {
    view.eye.x = std::min(view.eye.x + 0.1, 9.0);
    culler.cull(view);
  }
  EXPECT_LT(views, 600);
  EXPECT_GE(view.eye.x, 5.0) << "it could still be seen";
}

}  // namespace
}  // namespace sightline::culling
