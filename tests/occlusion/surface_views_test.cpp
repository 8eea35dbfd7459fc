// Surfaces in views that follow each other: what is known of them from earlier views makes nothing wrong.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using hand_made::addMaterial;
using hand_made::addTriangles;
using hand_made::addWall;
using hand_made::frontView;
using test::appendQuad;
using test::kDrawAll;
using test::noTriangle;
using test::ProvedPixels;
using test::provePixels;
using test::sheet;

TEST(SurfaceProbes, ViewsThatFollowEachOtherAreRightToo) {
  const Scene scene = sheet(
      30, 50.0f, 10.0f, [](float x, float y) { return 3.0f * std::sin(0.5f * x) * std::cos(0.8f * y); },
      [](std::uint32_t t) { return t % 37 == 0; });
  const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 100, .patch_triangles = 20});
  const SurfaceSet others = findSurfaces(scene.view());
  Rasteriser raster({.width = 32, .height = 32});
  SurfaceDrawing drawing = kDrawAll;
  for (int i = 0; i < 12; ++i) {
    View view = frontView();
    view.eye = {0.3 * i, 0.1 * i, -0.2 * i};
    drawing.step = i == 5 ? ViewStep::kJump : ViewStep::kNext;
    raster.begin(view);
    raster.draw(i % 4 == 3 ? others : surfaces, surfaces.objects, drawing);
    drawing.step = ViewStep::kSame;
    raster.draw(i % 4 == 3 ? others : surfaces, surfaces.objects, drawing);
    const ProvedPixels checked = provePixels(scene, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << i;
    EXPECT_GT(checked.covered, 300u);
  }
}

// What is kept from view to view of which side of a surface shows changes nothing.
TEST(SurfaceProbes, ViewsThatFollowEachOtherAreDrawnAsTheyAreAlone) {
  test::Random random(5);
  std::size_t covered = 0;
  for (int n = 0; n < 60; ++n) {
    const double bend = random.in(0.0, 4.0);
    const Scene scene = sheet(
        12, 40.0f, 10.0f,
        [bend](float x, float y) {
          return static_cast<float>(bend) * std::sin(0.6f * x) * std::cos(0.9f * y);
        },
        [](std::uint32_t t) { return t % 41 == 0; }, n % 5 == 4);
    const SurfaceSet surfaces = findSurfaces(scene.view(), {.patch_triangles = 12, .cluster_triangles = 4});
    Rasteriser raster({.width = 48, .height = 40});
    SurfaceDrawing drawing = kDrawAll;
    drawing.draw_resting = true;
    View view = frontView();
    // Along the sheet, through it, and around it; sometimes by less than a coordinate's last place.
    const double step = n % 4 == 3 ? 1e-17 : random.in(0.01, 3.0);
    Vec3d velocity = random.point(step);
    view.eye = random.point(12.0);
    for (int i = 0; i < 25; ++i) {
      if (random.below(8) == 0) {
        velocity = random.point(step);
      }
      if (n % 4 == 3 && i == 12) {
        view.eye = view.eye * -1.0 + Vec3d(0, 0, -20);
      } else if (n % 7 == 6 && i == 9) {
        view.eye.x = std::numeric_limits<double>::quiet_NaN();
      } else if (n % 7 == 6 && i == 10) {
        view.eye = random.point(30.0);
      } else {
        view.eye = view.eye + velocity;
      }
      setOrientation(view, Vec3d(0, 0, -10) - view.eye + random.point(4.0), {0, 1, 0});
      view.orthographic = n % 3 == 2 && random.below(3) == 0;
      view.ortho_height = 30.0;
      drawing.step = i == 0 || random.below(12) == 0 ? ViewStep::kJump : ViewStep::kNext;
      raster.begin(view);
      raster.draw(surfaces, surfaces.objects, drawing);
      Rasteriser fresh({.width = 48, .height = 40});
      fresh.begin(view);
      fresh.draw(surfaces, surfaces.objects, drawing);
      for (std::uint32_t y = 0; y < 40; ++y) {
        ASSERT_TRUE(std::ranges::equal(raster.depthBuffer().row(y), fresh.depthBuffer().row(y)))
            << "walk " << n << ", view " << i << ", row " << y;
        for (std::uint32_t x = 0; x < 48; ++x) {
          covered += fresh.depthBuffer().covered(x, y) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(covered, 300'000u);
}

// After a way of 10^18 m, steps of 60 m are less than half of the last place of its length.
TEST(SurfaceProbes, AfterALongWayNoStepIsLost) {
  const Scene scene = sheet(
      2, 40000.0f, 10.0f, [](float, float) { return 0.0f; }, noTriangle, true);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 16, .height = 16});
  SurfaceDrawing drawing = kDrawAll;
  drawing.draw_resting = true;
  drawing.step = ViewStep::kNext;
  View view = frontView();
  view.z_far = 1e5;
  std::size_t covered = 0;
  const auto draw = [&](const Vec3d& eye) {
    view.eye = eye;
    setOrientation(view, {0, 0, eye.z > -10.0 ? -1.0 : 1.0}, {0, 1, 0});
    raster.begin(view);
    raster.draw(surfaces, surfaces.objects, drawing);
    covered += raster.depthBuffer().covered(8, 8) ? 1 : 0;
  };
  draw({1e18, 0, 3000});
  draw({0, 0, 3000});
  ASSERT_EQ(covered, 1u);
  for (double z = 2950.0; z > -3000.0; z -= 60.0) {
    draw({0, 0, z});
  }
  EXPECT_EQ(covered, 101u);
}

TEST(SurfaceProbes, WhatRestsIsDrawnWhereThatIsAskedFor) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -10.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  for (const bool draw_resting : {false, true}) {
    Rasteriser raster({.width = 64, .height = 64});
    SurfaceDrawing drawing = kDrawAll;
    View view = frontView();
    view.z_far = 1e5;
    view.eye.z = 3000.0;  // the wall has one pixel, which is no use
    raster.begin(view);
    raster.draw(surfaces, surfaces.objects, drawing);
    EXPECT_EQ(raster.surfaceStats().groups, 1u);
    view.eye.z = 0.0;
    drawing.step = ViewStep::kNext;
    raster.begin(view);
    raster.draw(surfaces, {}, drawing);
    drawing.step = ViewStep::kSame;
    drawing.draw_resting = draw_resting;
    raster.draw(surfaces, surfaces.objects, drawing);
    EXPECT_EQ(raster.depthBuffer().covered(32, 32), draw_resting);
  }
}

// Pairs of triangles that share an edge, in as many parts and clusters as in any other such scene. Folded
// ones are two patches each.
Scene pairs(float size, float fold) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, false);
  for (int i = 0; i < 400; ++i) {
    const float x = 2.0f * static_cast<float>(i % 20 - 10), y = 2.0f * static_cast<float>(i / 20 - 10);
    std::vector<Vec3f> corners;
    appendQuad(corners, {x, y, -20.0f}, {x + size, y, -20.0f + fold}, {x + size, y + size, -20.0f},
               {x, y + size, -20.0f + fold});
    addTriangles(scene, material, corners);
  }
  return scene;
}

TEST(SurfaceProbes, ASetMadeAnewInTheSamePlaceIsAnotherSet) {
  const SurfaceSettings settings{.cluster_triangles = 1};
  const Scene small = pairs(1e-3f, 0.0f), large = pairs(1.8f, 1.5f);
  Rasteriser raster({.width = 64, .height = 64}), fresh({.width = 64, .height = 64});
  SurfaceDrawing drawing = kDrawAll;
  drawing.step = ViewStep::kNext;
  SurfaceSet set = findSurfaces(small.view(), settings);
  const std::size_t parts = set.parts.size(), clusters = set.clusters.size(), patches = set.patches.size();
  raster.begin(frontView());
  raster.draw(set, set.objects, drawing);
  set = findSurfaces(large.view(), settings);
  ASSERT_EQ(set.parts.size(), parts);
  ASSERT_EQ(set.clusters.size(), clusters);
  ASSERT_EQ(set.patches.size(), 2 * patches);
  raster.begin(frontView());
  raster.draw(set, set.objects, drawing);
  fresh.begin(frontView());
  fresh.draw(set, set.objects, drawing);
  const ProvedPixels checked = provePixels(large, frontView(), raster.depthBuffer());
  EXPECT_TRUE(checked.right());
  EXPECT_GT(checked.covered, 400u);
  for (std::uint32_t y = 0; y < 64; ++y) {
    EXPECT_TRUE(std::ranges::equal(raster.depthBuffer().row(y), fresh.depthBuffer().row(y))) << y;
  }
}

// Sides of patches that are remembered of one set must not count for another one of the same sizes.
TEST(SurfaceProbes, ASetOfTheSameSizesMadeAnewInTheSamePlaceIsAnotherSet) {
  // Tilted to the left, and then to the right: what faced the eye faces away.
  const auto tilted = [](float by) {
    Scene scene;
    const MaterialId material = addMaterial(scene, Opacity::kOpaque, false);
    for (int i = 0; i < 20; ++i) {
      const float x = static_cast<float>(i - 10);
      std::vector<Vec3f> corners;
      appendQuad(corners, {x, -9.0f, -20.0f}, {x + 0.4f, -9.0f, -20.0f + by}, {x + 0.4f, 9.0f, -20.0f + by},
                 {x, 9.0f, -20.0f});
      addTriangles(scene, material, corners);
    }
    return scene;
  };
  const Scene before = tilted(3.0f), after = tilted(-3.0f);
  Rasteriser raster({.width = 64, .height = 64}), fresh({.width = 64, .height = 64});
  SurfaceDrawing drawing = kDrawAll;
  drawing.step = ViewStep::kNext;
  drawing.draw_resting = true;
  SurfaceSet set = findSurfaces(before.view());
  const std::size_t patches = set.patches.size(), chains = set.chains.size(), clusters = set.clusters.size();
  raster.begin(frontView());
  raster.draw(set, set.objects, drawing);
  set = findSurfaces(after.view());
  ASSERT_EQ(set.patches.size(), patches);
  ASSERT_EQ(set.chains.size(), chains);
  ASSERT_EQ(set.clusters.size(), clusters);
  raster.begin(frontView());
  raster.draw(set, set.objects, drawing);
  fresh.begin(frontView());
  fresh.draw(set, set.objects, drawing);
  EXPECT_TRUE(provePixels(after, frontView(), raster.depthBuffer()).right());
  std::size_t covered = 0;
  for (std::uint32_t y = 0; y < 64; ++y) {
    EXPECT_TRUE(std::ranges::equal(raster.depthBuffer().row(y), fresh.depthBuffer().row(y))) << y;
    for (std::uint32_t x = 0; x < 64; ++x) {
      covered += fresh.depthBuffer().covered(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(covered, 20u);
}

}  // namespace
}  // namespace sightline
