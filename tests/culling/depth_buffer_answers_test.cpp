// What methods with a depth buffer tell about it: the buffer of the frame, and what was drawn of surfaces.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "tests/culling/culled_scene.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

// Two walls before the eye: one straight ahead, one to the right, beyond the border of frontView().
CulledScene twoWalls() {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, material, -10.0f, -4.0f, 4.0f, -4.0f, 4.0f);
  addWall(scene, material, -10.0f, 11.0f, 14.0f, -4.0f, 4.0f);
  return CulledScene(std::move(scene));
}

View turnedToTheRight() {
  View view = frontView();
  setOrientation(view, {0.5, 0, -1}, {0, 1, 0});
  return view;
}

TEST(DepthBufferAnswers, SurfacesOfObjectsThatComeIntoViewAreCountedWithTheOthers) {
  const CulledScene walls = twoWalls();
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
  const CulledScene walls = twoWalls();
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

constexpr std::size_t kGridPlaces = 96;

// What add(scene, material, x, y) adds at places before the eye of frontView(), in rows and columns.
template <typename Add>
CulledScene atPlaces(Add&& add) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  for (std::size_t i = 0; i < kGridPlaces; ++i) {
    const std::size_t column = i % 12, row = i / 12;
    add(scene, material, 3.0f * static_cast<float>(column) - 16.5f, 3.0f * static_cast<float>(row) - 10.5f);
  }
  return CulledScene(std::move(scene));
}

// Small discs, each of which hides a still smaller wall.
CulledScene discsBeforeWalls() {
  return atPlaces([](Scene& made, MaterialId material, float x, float y) {
    std::vector<Vec3f> corners;
    const auto rim = [&](int i) {
      const float angle = 0.3926990817f * static_cast<float>(i % 16);
      return Vec3f(x + 1.3f * std::cos(angle), y + 1.3f * std::sin(angle), -20.0f);
    };
    for (int i = 0; i < 16; ++i) {
      corners.insert(corners.end(), {Vec3f(x, y, -20.0f), rim(i), rim(i + 1)});
    }
    addTriangles(made, material, corners);
    const float beyond = 20.5f / 20.0f;
    addWall(made, material, -20.5f, x * beyond - 0.1f, x * beyond + 0.1f, y * beyond - 0.1f,
            y * beyond + 0.1f);
  });
}

// Crumbs before the eye, more than are looked at before anything is hidden; a wall behind them, and as many
// crumbs behind the wall.
CulledScene crumbsBeforeAWall(std::size_t crumbs) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  for (const float z : {-10.0f, -40.0f}) {
    for (std::size_t i = 0; i < crumbs; ++i) {
      const float x = 0.1f * static_cast<float>(i % 64) - 3.2f, y = 0.1f * static_cast<float>(i / 64) - 3.2f;
      addWall(scene, material, z, x, x + 0.01f, y, y + 0.01f);
    }
  }
  addWall(scene, material, -20.0f, -8.0f, 8.0f, -8.0f, 8.0f);
  return CulledScene(std::move(scene));
}

TEST(DepthBufferAnswers, InTheFirstViewWhatIsFarAwayHidesToo) {
  constexpr std::size_t kCrumbs = 3000;
  const CulledScene scene = crumbsBeforeAWall(kCrumbs);
  Culler pyramid(scene.parts(), depthPyramid());
  pyramid.cull(frontView());
  EXPECT_EQ(pyramid.visible().size(), kCrumbs + 1);
  Culler map(scene.parts(), opacityMap({.surfaces = SurfaceUse::kAlone}));
  map.cull(frontView());
  EXPECT_EQ(map.visible().size(), kCrumbs + 1);
}

TEST(DepthBufferAnswers, ACutToAnotherCameraDrawsWhatIsSmallInTheViewsAfterIt) {
  const CulledScene scene = discsBeforeWalls();
  Culler culler(scene.parts(), depthPyramid({.focus = {.magnification = 0.0}}));
  culler.cull(frontView());
  const std::uint64_t all = culler.statistic("surfaces", "edges");
  EXPECT_EQ(culler.visible().size(), kGridPlaces);
  View away = frontView();
  setOrientation(away, {0, 0, 1}, {0, 1, 0});
  culler.cull(away);
  EXPECT_TRUE(culler.visible().empty());
  culler.cull(frontView());
  EXPECT_LT(culler.statistic("surfaces", "edges"), all / 4);
  culler.cull(frontView());
  EXPECT_EQ(culler.visible().size(), kGridPlaces);
}

// No frame takes as little as the one time, or as much as the other.
TEST(DepthBufferAnswers, ABudgetOfTimeSetsHowMuchIsDrawn) {
  const CulledScene scene = discsBeforeWalls();
  Culler all(scene.parts(), depthPyramid());
  all.cull(frontView());
  const std::uint64_t edges = all.statistic("surfaces", "edges");
  Culler ample(scene.parts(), depthPyramid({.budget_us = 1e9}));
  Culler scant(scene.parts(), depthPyramid({.budget_us = 1e-3}));
  for (int i = 0; i < 10; ++i) {
    all.cull(frontView());
    ample.cull(frontView());
    scant.cull(frontView());
    EXPECT_EQ(ample.statistic("surfaces", "edges"), all.statistic("surfaces", "edges")) << i;
    EXPECT_EQ(ample.visible().size(), kGridPlaces) << i;
    if (i > 0) {
      EXPECT_LT(scant.statistic("surfaces", "edges"), edges / 4) << i;
      EXPECT_GT(scant.visible().size(), kGridPlaces) << i;
    }
  }
}

// Strips far narrower than a pixel.
CulledScene stripsOfNoUse() {
  return atPlaces([](Scene& made, MaterialId material, float x, float y) {
    const float z = -20.0f;
    const std::array<Vec3f, 3> strip{
        {{x - 1.3f, y - 1.3f, z}, {x + 1.3f, y + 1.3f, z}, {x + 1.3f, y + 1.301f, z}}};
    addTriangles(made, material, strip);
  });
}

TEST(DepthBufferAnswers, SurfacesOfNoUseAreTriedAgainInDifferentViews) {
  const CulledScene scene = stripsOfNoUse();
  Culler culler(scene.parts(), depthPyramid());
  culler.cull(frontView());
  const std::uint64_t all = culler.statistic("surfaces", "edges");
  EXPECT_EQ(all, 3 * kGridPlaces);
  std::uint64_t most = 0, sum = 0;
  for (int i = 0; i < 400; ++i) {
    culler.cull(frontView());
    most = std::max(most, culler.statistic("surfaces", "edges"));
    sum += culler.statistic("surfaces", "edges");
  }
  EXPECT_LE(most, all / 2) << "never all in one view";
  EXPECT_GT(sum, 4 * all) << "but they are tried";
}

TEST(DepthBufferAnswers, SurfacesOfNoUseAreTriedAgainSoonerWhereTheEyeMoves) {
  const CulledScene scene = stripsOfNoUse();
  const auto edgesDrawn = [&](double step) {
    Culler culler(scene.parts(), depthPyramid());
    std::uint64_t sum = 0;
    for (int i = 0; i < 200; ++i) {
      View view = frontView();
      view.eye.x += i % 2 == 0 ? 0.0 : step;
      culler.cull(view);
      sum += i >= 50 ? culler.statistic("surfaces", "edges") : 0;
    }
    return sum;
  };
  const std::uint64_t still = edgesDrawn(0.0);
  EXPECT_GT(edgesDrawn(1.0), 3 * still);
  EXPECT_LT(edgesDrawn(0.001), still + still / 4) << "no more than the strips' distance tells";
}

TEST(DepthBufferAnswers, AFrameWithoutOcclusionCullingHasNoDepthBuffer) {
  const CulledScene walls = twoWalls();
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

// Frames of 200 in which the opacity map did without occlusion culling, for a renderer whose frames take this
// time whatever they have in them; negative: nothing is known of it.
int suspendedFrames(double draw_us) {
  const CulledScene walls = twoWalls();
  MeasuredRenderer renderer;
  Culler culler(walls.parts(), opacityMap({.renderer = &renderer}));
  int suspended = 0;
  for (int frame = 0; frame < 200; ++frame) {
    culler.cull(frontView());
    suspended += culler.statistic("map", "suspended") != 0 ? 1 : 0;
    renderer.frame(draw_us, frame % 2 == 0 ? 1 : 1'000);
  }
  return suspended;
}

TEST(DepthBufferAnswers, TheOpacityMapRestsWhereTheMeasuredRendererTakesNoTimeForTriangles) {
  EXPECT_GT(suspendedFrames(0.0), 0);
  EXPECT_GT(suspendedFrames(500.0), 0) << "a frame's fixed time is not saved";
}

TEST(DepthBufferAnswers, TheOpacityMapGoesOnWhileNothingIsKnownOfTheRenderer) {
  EXPECT_EQ(suspendedFrames(-1.0), 0);
}

}  // namespace
}  // namespace sightline
