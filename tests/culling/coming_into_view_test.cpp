// What comes into view hides in the same view, also where the camera made no jump.

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "tests/culling/culled_scene.h"
#include "tests/support/hand_made.h"

namespace sightline::culling {
namespace {

using hand_made::addMaterial;
using hand_made::addWall;

TEST(ComingIntoView, AWallBehindAWallHidesAsSoonAsTheEyeIsPastTheFirstOne) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
  const ObjectId first = addWall(scene, stone, -5.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  const ObjectId second = addWall(scene, stone, -12.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  for (int i = 0; i < 100; ++i) {
    const auto x = static_cast<float>(i % 10), y = static_cast<float>(i / 10);
    addWall(scene, stone, -20.0f - x, x - 5.0f, x - 4.5f, y - 5.0f, y - 4.5f);
  }
  const CulledScene culled(std::move(scene));
  for (const bool pyramid : {false, true}) {
    Culler culler(culled.parts(), pyramid ? depthPyramid() : opacityMap({.surfaces = SurfaceUse::kAlone}));
    View view = hand_made::frontView();
    for (int step = 0; step < 5; ++step) {
      view.eye.z = -0.5 * step;
      culler.cull(view);
      ASSERT_EQ(culler.visible().size(), 1u);
      EXPECT_EQ(culler.visible()[0], first);
    }
    view.eye.z = -6.0;  // less than ten times the last step, so no jump
    culler.cull(view);
    ASSERT_EQ(culler.visible().size(), 1u) << pyramid;
    EXPECT_EQ(culler.visible()[0], second) << pyramid;
  }
}

}  // namespace
}  // namespace sightline::culling
