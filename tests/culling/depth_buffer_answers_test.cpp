// What methods with a depth buffer tell about it: the buffer of the frame, and what was drawn of surfaces.

#include <gtest/gtest.h>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/occluders/surface_set.h"
#include "tests/oracle/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

// Two walls before the eye: one straight ahead, one to the right, beyond the border of frontView().
struct Walls {
  Scene scene;
  std::vector<Box> bounds;
  Hierarchy hierarchy;
  OccluderSet occluders;
  SurfaceSet surfaces;

  Walls() {
    const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
    addWall(scene, material, -10.0f, -4.0f, 4.0f, -4.0f, 4.0f);
    addWall(scene, material, -10.0f, 11.0f, 14.0f, -4.0f, 4.0f);
    for (const Object& object : scene.objects) {
      bounds.push_back(object.bounds);
    }
    hierarchy = buildHierarchy(bounds, {});
    occluders = findOccluders(scene.view());
    surfaces = findSurfaces(scene.view());
  }

  CullingScene parts() const {
    return {.hierarchy = &hierarchy, .object_bounds = bounds, .occluders = &occluders, .surfaces = &surfaces};
  }
};

View turnedToTheRight() {
  View view = frontView();
  setOrientation(view, {0.5, 0, -1}, {0, 1, 0});
  return view;
}

TEST(DepthBufferAnswers, SurfacesOfObjectsThatComeIntoViewAreCountedWithTheOthers) {
  const Walls walls;
  Culler culler(walls.parts(), depthPyramid());
  culler.cull(frontView());
  EXPECT_EQ(culler.visible().size(), 1u);
  EXPECT_EQ(culler.statistic("surfaces", "edges"), 4u) << "the wall ahead";
  const std::uint64_t groups = culler.statistic("surfaces", "groups");
  EXPECT_GT(groups, 0u);
  culler.cull(turnedToTheRight());
  EXPECT_EQ(culler.visible().size(), 2u);
  EXPECT_EQ(culler.statistic("surfaces", "edges"), 8u) << "both walls";
  EXPECT_GT(culler.statistic("surfaces", "groups"), groups);
}

TEST(DepthBufferAnswers, TheOpacityMapCountsItsSurfacesToo) {
  const Walls walls;
  Culler with(walls.parts(), opacityMap({.surfaces = SurfaceUse::kAlone}));
  with.cull(turnedToTheRight());
  EXPECT_EQ(with.statistic("surfaces", "edges"), 8u);
  EXPECT_GT(with.statistic("surfaces", "groups"), 0u);
  Culler without(walls.parts(), opacityMap());
  without.cull(turnedToTheRight());
  for (const MethodStatistic& statistic : without.statistics()) {
    EXPECT_STRNE(statistic.group, "surfaces");
  }
}

TEST(DepthBufferAnswers, AFrameWithoutOcclusionCullingHasNoDepthBuffer) {
  const Walls walls;
  // Nothing is ever saved, so that culling by occlusion is soon suspended.
  Culler culler(walls.parts(), opacityMap({.triangle_us = 1e-12}));
  int suspended = 0, others = 0;
  for (int frame = 0; frame < 200; ++frame) {
    culler.cull(frontView());
    const bool rests = culler.statistic("map", "suspended") != 0;
    EXPECT_EQ(culler.depthBuffer().width, rests ? 0u : 320u) << "frame " << frame;
    (rests ? suspended : others) += 1;
  }
  EXPECT_GT(suspended, 0);
  EXPECT_GT(others, 0);
}

}  // namespace
}  // namespace sightline
