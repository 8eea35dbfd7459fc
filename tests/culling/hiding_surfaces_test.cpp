// From view to view, only surfaces that hide something are drawn.

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "tests/culling/culled_scene.h"
#include "tests/support/hand_made.h"

namespace sightline::culling {
namespace {

using hand_made::addMaterial;
using hand_made::addWall;

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
  const CulledScene culled(scene);
  Culler culler(culled.parts(), depthPyramid({.focus = {.windows = 0}}));
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

// A wall with so many teeth along its upper border.
ObjectId addTeeth(Scene& scene, MaterialId material, float z, float x0, float x1, float y0, float y1,
                  int teeth) {
  std::vector<Vec3f> corners;
  for (int i = 0; i < teeth; ++i) {
    const float width = (x1 - x0) / static_cast<float>(teeth), a = x0 + width * static_cast<float>(i),
                b = x0 + width * static_cast<float>(i + 1);
    const Vec3f p(a, y0, z), q(b, y0, z), r(b, y1, z), s(a, y1, z), top(0.5f * (a + b), y1 + 0.05f, z);
    corners.insert(corners.end(), {p, q, r, p, r, s, s, r, top});
  }
  return hand_made::addTriangles(scene, material, corners);
}

// However much is drawn to hide something else, a wall that has hidden nothing so far is found once a few
// objects have been behind it for a while.
TEST(HidingSurfaces, WhatComesToBeHiddenIsFound) {
  for (const int teeth : {1, 60, 100, 200}) {
    for (const int panels : {1, 5, 10}) {
      Scene scene;
      const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
      const ObjectId left = addTeeth(scene, stone, -10.0f, -9.5f, 1.5f, -9.0f, 8.0f, teeth);
      addWall(scene, stone, -30.0f, -20.0f, 0.0f, -15.0f, 15.0f);  // behind it in all views
      const ObjectId right = addWall(scene, stone, -10.0f, 2.5f, 9.0f, -4.0f, 4.0f);
      for (int i = 0; i < panels; ++i) {
        const float x = 16.0f + 0.6f * static_cast<float>(i % 5),
                    y = -8.0f + 2.0f * static_cast<float>(i / 5);
        addWall(scene, stone, -80.0f - 0.01f * static_cast<float>(i), x, x + 0.5f, y, y + 1.5f);
      }
      const CulledScene culled(scene);
      Culler culler(culled.parts(), depthPyramid({.focus = {.windows = 0}}));
      View view = hand_made::frontView();
      culler.cull(view);
      EXPECT_GT(culler.visible().size(), 2u);
      // To the right, until the panels are behind the wall there, and then no farther.
      int views = 0;
      for (; views < 600 && (view.eye.x < 1.2 || culler.visible().size() > 2); ++views) {
        view.eye.x = std::min(view.eye.x + 0.02, 1.2);
        culler.cull(view);
      }
      const std::vector<ObjectId> kept(culler.visible().begin(), culler.visible().end());
      EXPECT_EQ(kept, (std::vector{left, right})) << teeth << " teeth, " << panels << " panels";
    }
  }
}

// Where nearly all that a view shows is new, what was of no use in the last one is drawn too.
TEST(HidingSurfaces, AFastTurnKeepsAboutWhatAViewAloneKeeps) {
  const Result<Scene> scene = makeDemoScene("demo:building");
  ASSERT_TRUE(scene.has_value());
  const CulledScene culled(*scene);
  Culler culler(culled.parts(), depthPyramid());
  Culler alone(culled.parts(), depthPyramid({.temporal_coherence = false}));
  const CameraPath& path = scene->paths[0];
  std::size_t kept = 0, kept_alone = 0;
  for (std::size_t frame = 0; frame < path.frames.size(); frame += 10) {
    const View view = path.view(frame, scene->origin);
    culler.cull(view);
    alone.cull(view);
    kept += culler.visible().size();
    kept_alone += alone.visible().size();
  }
  EXPECT_LT(kept, kept_alone * 5 / 4);
}

TEST(HidingSurfaces, ADoorHidesTheRoomWhileItIsShut) {
  Scene door, scene;
  addWall(door, addMaterial(door, Opacity::kOpaque, true), 0.0f, -20.0f, 20.0f, -20.0f, 20.0f);
  const SurfaceSet surfaces = findSurfaces(door.view());
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -20.0f, -1.0f, 1.0f, -1.0f, 1.0f);
  const std::vector<Box> bounds{scene.objects[0].bounds};
  const Hierarchy hierarchy = buildHierarchy(bounds, {});
  Mat4 shut, open;
  shut(2, 3) = open(2, 3) = -10.0;
  // Opened, it is turned about its height and stands beside the view.
  open(0, 3) = -5.0;
  open(0, 0) = open(2, 2) = 0.0;
  open(2, 0) = -1.0;
  open(0, 2) = 1.0;
  for (const bool pyramid : {false, true}) {
    OpacityMapMethodSettings drawing;
    drawing.surfaces = SurfaceUse::kAlone;
    Culler culler({.hierarchy = &hierarchy, .object_bounds = bounds},
                  pyramid ? depthPyramid() : opacityMap(drawing));
    for (const bool is_shut : {true, false, true, true}) {
      const MovingSurfaces moving{&surfaces, is_shut ? shut : open};
      culler.cull(hand_made::frontView(), bounds, nullptr, std::span(&moving, 1));
      EXPECT_EQ(culler.visible().empty(), is_shut) << pyramid;
      EXPECT_EQ(culler.dynamicStates()[0] == Visibility::kHidden, is_shut) << pyramid;
    }
  }
}

}  // namespace
}  // namespace sightline::culling
