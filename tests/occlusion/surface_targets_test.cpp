// Which surfaces are drawn where only those before some boxes are, and what they cover then.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"
#include "tests/support/translation.h"

namespace sightline {
namespace {

using hand_made::addMaterial;
using hand_made::addTriangles;
using hand_made::addWall;
using hand_made::frontView;
using test::kDrawAll;
using test::ProvedPixels;
using test::provePixels;
using test::sheet;
using test::translation;

// A box of a few pixels far behind (x, y, -10).
Box behind(float x, float y) {
  return {{3.0f * x - 1.0f, 3.0f * y - 1.0f, -31.0f}, {3.0f * x + 1.0f, 3.0f * y + 1.0f, -30.0f}};
}

TEST(SurfaceTargets, OnlySurfacesBeforeOneOfThemAreDrawn) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, stone, -10.0f, -9.0f, -2.0f, -9.0f, 9.0f);
  addWall(scene, stone, -10.0f, 2.0f, 9.0f, -9.0f, 9.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 64, .height = 64});
  const auto drawn = [&](std::span<const Box> targets) {
    SurfaceDrawing drawing = kDrawAll;
    drawing.targets = targets;
    raster.begin(frontView());
    raster.draw(surfaces, surfaces.objects, drawing);
    return std::array{raster.depthBuffer().covered(16, 32), raster.depthBuffer().covered(48, 32)};
  };
  EXPECT_EQ(drawn({}), (std::array{true, true}));
  EXPECT_EQ(drawn(std::array{behind(-5.0f, 0.0f)}), (std::array{true, false}));
  EXPECT_EQ(drawn(std::array{behind(5.0f, 0.0f)}), (std::array{false, true}));
  EXPECT_EQ(drawn(std::array{behind(5.0f, 0.0f), behind(-5.0f, 3.0f)}), (std::array{true, true}));
  EXPECT_EQ(drawn(std::array{Box{{-4.0f, -1.0f, -8.0f}, {4.0f, 1.0f, -7.0f}}}), (std::array{false, false}))
      << "before both walls";
  EXPECT_EQ(drawn(std::array{Box{{-4.0f, -1.0f, 7.0f}, {4.0f, 1.0f, 8.0f}}}), (std::array{false, false}))
      << "behind the eye";
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(drawn(std::array{Box{{kNan, -1.0f, -31.0f}, {kNan, 1.0f, -30.0f}}}), (std::array{false, false}));
}

TEST(SurfaceTargets, ASurfaceIsBeforeATargetOnlyWhereItIsNearer) {
  // A wall that begins to the left, near the eye, and ends to the right, far away.
  Scene scene;
  const Vec3f a(-2.0f, -10.0f, -4.0f), b(30.0f, -10.0f, -60.0f), c(30.0f, 10.0f, -60.0f),
      d(-2.0f, 10.0f, -4.0f);
  addTriangles(scene, addMaterial(scene, Opacity::kOpaque, true), std::array<Vec3f, 6>{a, b, c, a, c, d});
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 128, .height = 128});
  const auto groups = [&](const Box& target) {
    SurfaceDrawing drawing = kDrawAll;
    drawing.targets = {&target, 1};
    raster.begin(frontView());
    raster.draw(surfaces, surfaces.objects, drawing);
    return raster.surfaceStats().groups;
  };
  EXPECT_EQ(groups({{11.0f, -1.0f, -41.0f}, {12.0f, 1.0f, -40.0f}}), 1u) << "behind it";
  EXPECT_EQ(groups({{8.0f, -1.0f, -20.0f}, {8.8f, 1.0f, -19.0f}}), 0u) << "before it";
}

TEST(SurfaceTargets, WhatHidMostComesFirstInTheNextView) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true);
  for (int i = 0; i < 16; ++i) {
    const auto x = static_cast<float>(i % 4 - 2), y = static_cast<float>(i / 4 - 2);
    addWall(scene, stone, -5.0f, x + 0.1f, x + 0.9f, y + 0.1f, y + 0.9f);
  }
  addWall(scene, stone, -10.0f, -30.0f, 30.0f, -30.0f, 30.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 128, .height = 128});
  const std::array targets{Box{{-20.0f, -20.0f, -40.0f}, {20.0f, 20.0f, -30.0f}}};
  SurfaceDrawing drawing = kDrawAll;
  drawing.targets = targets;
  drawing.useful_only = true;
  raster.begin(frontView());
  raster.draw(surfaces, surfaces.objects, drawing);
  EXPECT_EQ(raster.surfaceStats().groups, 0u) << "nothing was drawn in a view before";

  drawing.useful_only = false;
  drawing.step = ViewStep::kSame;
  raster.draw(surfaces, surfaces.objects, drawing);
  EXPECT_EQ(raster.surfaceStats().groups, 17u);
  EXPECT_EQ(provePixels(scene, frontView(), raster.depthBuffer(), 16).wrong, 0u);

  drawing.useful_only = true;
  drawing.step = ViewStep::kNext;
  for (int view = 0; view < 3; ++view) {
    raster.begin(frontView());
    raster.draw(surfaces, {}, drawing);
    // The wall, and what is drawn in one round with it: nothing else is needed.
    EXPECT_GE(raster.surfaceStats().groups, 1u);
    EXPECT_LE(raster.surfaceStats().groups, 8u);
    for (std::uint32_t x = 0; x < 128; x += 8) {
      EXPECT_TRUE(raster.depthBuffer().covered(x, 64));
    }
  }
  drawing.step = ViewStep::kSame;
  raster.draw(surfaces, {}, drawing);
  EXPECT_EQ(raster.surfaceStats().groups, 0u) << "it is drawn once in a view";
}

TEST(SurfaceTargets, AreOfAllSetsThatAreDrawnWhereverTheseAre) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), 0.0f, -3.0f, 3.0f, -9.0f, 9.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 64, .height = 64});
  SurfaceDrawing drawing = kDrawAll;
  std::vector<Box> targets{behind(5.0f, 0.0f)};
  drawing.targets = targets;
  const auto groupsAt = [&](double x, double z) {
    return raster.draw(MovingSurfaces{&surfaces, translation({x, 0.0, z})}, drawing).groups;
  };
  raster.begin(frontView());
  EXPECT_EQ(groupsAt(-5.0, -10.0), 0u) << "beside the target";
  EXPECT_EQ(groupsAt(15.0, -40.0), 0u) << "behind it";
  EXPECT_EQ(groupsAt(5.0, -10.0), 1u);
  EXPECT_EQ(groupsAt(4.5, -9.0), 0u) << "it is hidden by the set before";
  // The same memory has other boxes now.
  targets[0] = behind(-5.0f, 0.0f);
  EXPECT_EQ(groupsAt(-5.0, -10.0), 1u);
  EXPECT_EQ(groupsAt(-5.0, -9.0), 0u);
  // Nothing is known of them in another view, nor once something else was drawn.
  raster.begin(frontView());
  EXPECT_EQ(groupsAt(-5.0, -10.0), 1u);
  raster.draw(OccluderSet(), {});
  EXPECT_EQ(groupsAt(-5.0, -10.0), 0u);
  drawing.targets = {};
  EXPECT_EQ(groupsAt(5.0, -10.0), 1u) << "without targets everything counts";
  EXPECT_EQ(groupsAt(10.0, -20.0), 0u) << "but what is behind it";
}

TEST(SurfaceTargets, EachOfSeveralSetsRemembersWhatWasOfUse) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -10.0f, -3.0f, 3.0f, -9.0f, 9.0f);
  const SurfaceSet left = findSurfaces(scene.view()), right = findSurfaces(scene.view());
  Rasteriser raster({.width = 64, .height = 64});
  const std::array targets{behind(-5.0f, 0.0f), behind(5.0f, 0.0f)};
  SurfaceDrawing drawing = kDrawAll;
  drawing.targets = targets;
  const auto groups = [&](const SurfaceSet& set) {
    const MovingSurfaces placed{&set, translation({&set == &left ? -5.0 : 5.0, 0.0, 0.0})};
    return raster.draw(placed, set.objects, drawing).groups;
  };
  raster.begin(frontView());
  EXPECT_EQ(groups(left), 1u);
  EXPECT_EQ(groups(right), 1u);
  drawing.useful_only = true;
  for (int view = 0; view < 3; ++view) {
    drawing.step = ViewStep::kNext;
    raster.begin(frontView());
    EXPECT_EQ(groups(left), 1u);
    EXPECT_EQ(groups(right), 1u);
    drawing.step = ViewStep::kSame;
    EXPECT_EQ(groups(left), 0u) << "it is drawn once in a view";
  }
  // A set that is drawn for the first time in a view is not taken for drawn because the view is the same.
  raster.begin(frontView());
  drawing.useful_only = false;
  EXPECT_EQ(groups(left), 1u);
}

class RandomSurfaceTargets : public testing::TestWithParam<bool> {};

TEST_P(RandomSurfaceTargets, HideWhatTheyCoverWhereOnlySomeAreDrawn) {
  std::size_t covered = 0, useful = 0, fewer = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(40u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    const auto rough = static_cast<float>(number(0.0, 4.0));
    const double waves = number(0.1, 1.0), holes = number(0.0, 1.0) < 0.5 ? 0.0 : number(0.0, 0.1);
    const Scene scene = sheet(
        8 + static_cast<std::uint32_t>(number(0.0, 16.0)), 40.0f, 12.0f,
        [&](float x, float y) {
          return rough * static_cast<float>(std::sin(waves * x) * std::cos(waves * y));
        },
        [&](std::uint32_t) { return number(0.0, 1.0) < holes; }, number(0.0, 1.0) < 0.5);
    const SurfaceSet surfaces =
        findSurfaces(scene.view(), {.part_triangles = 60, .patch_triangles = 16, .cluster_triangles = 4});
    View view = frontView();
    view.eye = {number(-3.0, 3.0), number(-3.0, 3.0), number(-4.0, 3.0)};
    setOrientation(view, {number(-0.7, 0.7), number(-0.7, 0.7), -1.0}, {0.0, 1.0, 0.0});
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    std::vector<Box> targets;
    const auto aim = [&] {
      const Vec3f at(static_cast<float>(number(-15.0, 15.0)), static_cast<float>(number(-15.0, 15.0)),
                     static_cast<float>(number(-40.0, -10.0)));
      const auto size = static_cast<float>(number(0.5, 8.0));
      targets.push_back({at, at + Vec3f(size, size, size)});
    };
    Rasteriser raster({.width = 24 + static_cast<std::uint32_t>(number(0.0, 40.0)), .height = 32});
    SurfaceDrawing drawing = kDrawAll;
    raster.begin(view);
    raster.draw(surfaces, surfaces.objects, drawing);
    const std::uint32_t all = raster.surfaceStats().groups;
    aim();
    drawing.targets = targets;
    drawing.limits.pixels_per_edge = number(0.0, 2.0);
    raster.begin(view);
    raster.draw(surfaces, surfaces.objects, drawing);
    fewer += raster.surfaceStats().groups < all ? 1 : 0;
    // The next view, in two steps: what was of use, and what is aimed at besides.
    view.eye += Vec3d(number(-0.5, 0.5), number(-0.5, 0.5), number(-0.5, 0.5));
    drawing.step = ViewStep::kNext;
    drawing.useful_only = true;
    raster.begin(view);
    raster.draw(surfaces, {}, drawing);
    useful += raster.surfaceStats().groups;
    aim();
    drawing.targets = targets;
    drawing.step = ViewStep::kSame;
    drawing.useful_only = false;
    raster.draw(surfaces, surfaces.objects, drawing);
    const ProvedPixels checked = provePixels(scene, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
  }
  EXPECT_GT(covered, test::rounds(2000u));
  EXPECT_GT(useful, test::rounds(20u));
  EXPECT_GT(fewer, test::rounds(20u));
}

INSTANTIATE_TEST_SUITE_P(Views, RandomSurfaceTargets, testing::Bool(),
                         [](const auto& shown) { return shown.param ? "Orthographic" : "Perspective"; });

}  // namespace
}  // namespace sightline
