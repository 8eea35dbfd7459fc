// Surfaces that the near plane cuts, or that reach beyond the far plane, against exact proofs.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using hand_made::addMaterial;
using hand_made::addTriangles;
using hand_made::frontView;
using test::drawAndProve;
using test::kDrawAll;
using test::noTriangle;
using test::ProvedPixels;
using test::sceneOfCorners;
using test::sheet;

TEST(SurfaceProbes, TheNearPlaneCutsThroughEverything) {
  const Scene scene = sheet(
      20, 30.0f, 10.0f, [](float x, float y) { return 4.0f * std::sin(0.4f * x) * std::cos(0.3f * y); },
      noTriangle);
  for (const double near : {5.0, 6.0, 8.0, 10.0, 12.0, 13.5}) {
    View view = frontView();
    view.z_near = near;
    EXPECT_TRUE(drawAndProve(scene, view, 32, 32).right()) << near;
    view.orthographic = true;
    EXPECT_TRUE(drawAndProve(scene, view, 32, 32).right()) << near;
  }
}

// The part of the triangle before the near plane is smaller than what single precision makes of half the size
// of its box.
TEST(SurfaceProbes, AVertexJustBeforeTheNearPlaneIsCutOff) {
  const View view = frontView();
  const double clip = view.z_near * (1.0 + 1e-6);
  for (float depth = static_cast<float>(clip - 4.5e-7); depth < clip; depth = std::nextafter(depth, 1.0f)) {
    const std::array<Vec3f, 3> corners{Vec3f(-0.12f, 0.12f, -depth), Vec3f(-22.0f, -22.0f, -20.0f),
                                       Vec3f(0.12f, -0.12f, -depth)};
    const ProvedPixels checked = drawAndProve(sceneOfCorners(corners), view, 16, 16);
    EXPECT_TRUE(checked.right()) << depth;
    EXPECT_GT(checked.covered, 50u);
  }
}

TEST(SurfaceProbes, TrianglesWithVerticesAlmostInTheNearPlane) {
  std::mt19937 engine(5);
  const auto number = test::numbersFrom<double>(engine);
  std::size_t covered = 0;
  for (int n = 0; n < 400; ++n) {
    View view = frontView();
    view.z_near = n % 2 == 0 ? 0.1 : 0.25;
    view.orthographic = n % 4 == 0;
    view.ortho_height = 4.0;
    view.z_far = 1e6;
    const double clip = view.z_near * (1.0 + 1e-6), reach = std::exp2(number(-2.0, 14.0));
    std::vector<Vec3f> vertices, corners;
    for (std::uint32_t i = 0; i < 16; ++i) {
      const double depths[] = {number(-reach, reach), number(0.0, 2.0), number(0.0, reach),
                               clip * (1.0 + number(-3e-7, 3e-7)), clip * (1.0 + number(-6e-6, 6e-6))};
      const double depth = depths[i % 5], size = view.orthographic ? 1.0 : std::max(std::abs(depth), 0.1);
      vertices.push_back(Vec3f(Vec3d(number(-3.0, 3.0) * size, number(-3.0, 3.0) * size, -depth)));
    }
    for (int i = 0; i < 8; ++i) {
      const std::size_t first = engine() % 16, second = (first + 1 + engine() % 7) % 16;
      corners.insert(corners.end(),
                     {vertices[first], vertices[second], vertices[(second + 1 + engine() % 7) % 16]});
    }
    const ProvedPixels checked = drawAndProve(sceneOfCorners(corners, n % 3 == 0), view, 8, 8,
                                              {.max_angle_deg = n % 5 < 2 ? 180.0 : 20.0});
    EXPECT_TRUE(checked.right()) << n;
    covered += checked.covered;
  }
  EXPECT_GT(covered, 2000u);
}

// Triangles of 100 km whose plane is that of the eye but for 10^-12 metres, as seen straight from the front.
// What lies behind the plane of the eye hides nothing.
TEST(SurfaceProbes, ANearDistanceOfZeroLeavesRoomForRounding) {
  std::mt19937 engine(1);
  const auto number = test::numbersFrom<double>(engine);
  std::size_t behind = 0;
  for (int n = 0; n < 20'000; ++n) {
    View view = frontView();
    view.orthographic = true;
    view.ortho_height = 2000.0;
    view.z_near = 0.0;
    view.z_far = 1000.0;
    setOrientation(view, {number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)}, {0.0, 1.0, 0.0});
    const Vec3d base{std::floor(number(-1e3, 1e3)), std::floor(number(-1e3, 1e3)),
                     std::floor(number(-1e3, 1e3))};
    const auto at = [&](double x, double y) { return Vec3f(base + view.right * x + view.up * y); };
    const std::array<Vec3f, 3> corners{at(-4e4, -4e4), at(4e4, -4e4), at(0.0, 6e4)};
    const Vec3d a(corners[0]), b(corners[1]), c(corners[2]);
    Vec3d normal = normalized(cross(b - a, c - a));
    normal = dot(normal, view.forward) < 0.0 ? -normal : normal;
    setOrientation(view, normal, view.up);
    view.eye = (a + b + c) * (1.0 / 3.0) + normal * number(0.0, 8e-12);
    // Exact to 10^-14 metres.
    const auto depth = [&](const Vec3d& p) {
      const auto product = [](double direction, double to, double from) {
        return static_cast<long double>(direction) * (static_cast<long double>(to) - from);
      };
      return product(view.forward.x, p.x, view.eye.x) + product(view.forward.y, p.y, view.eye.y) +
             product(view.forward.z, p.z, view.eye.z);
    };
    const bool all_behind = std::max({depth(a), depth(b), depth(c)}) < -1e-14L;
    Rasteriser raster({.width = 1, .height = 1});
    raster.begin(view);
    const SurfaceSet surfaces = findSurfaces(sceneOfCorners(corners, true).view());
    raster.draw(surfaces, surfaces.objects, kDrawAll);
    EXPECT_FALSE(all_behind && raster.depthBuffer().covered(0, 0)) << n;
    behind += all_behind ? 1 : 0;
  }
  EXPECT_GT(behind, 1000u);
  View view = frontView();
  view.orthographic = true;
  view.ortho_height = 20.0;
  view.z_near = 0.0;
  const Scene beyond = sheet(
      4, 24.0f, 10.0f, [](float x, float) { return 0.1f * x; }, noTriangle);
  const ProvedPixels checked = drawAndProve(beyond, view, 16, 16);
  EXPECT_TRUE(checked.right());
  EXPECT_EQ(checked.covered, 16u * 16u);
}

// The second hill of a strip lies partly beyond the far plane and shows above the first one.
TEST(SurfaceProbes, WhatLiesBeyondTheFarPlaneIsNoNearerThanItIs) {
  constexpr std::array<std::array<float, 2>, 5> kProfile{{{10.0f, -8.0f},
                                                          {20.0f, -8.0f},
                                                          {60.0f, -1.2f},
                                                          {140.0f, -10.0f},
                                                          {240.0f, 5.0f}}};  // distance, height
  Scene scene;
  std::vector<Vec3f> corners;
  for (std::size_t i = 0; i + 1 < kProfile.size(); ++i) {
    const auto at = [&](std::size_t k, float x) { return Vec3f(x, kProfile[k][1], -kProfile[k][0]); };
    const Vec3f a = at(i, -200), b = at(i, 200), c = at(i + 1, 200), d = at(i + 1, -200);
    corners.insert(corners.end(), {a, b, c, a, c, d});
  }
  addTriangles(scene, addMaterial(scene, Opacity::kOpaque, false), corners);
  View view = frontView();
  view.z_near = 0.1;
  view.tan_half_fovy = 0.2;
  view.aspect = 16.0 / 9.0;
  Rasteriser raster({.width = 320, .height = 180});
  for (const double far : {130.0, 1000.0}) {
    view.z_far = far;
    raster.begin(view);
    const SurfaceSet surfaces = findSurfaces(scene.view());
    raster.draw(surfaces, surfaces.objects, kDrawAll);
    const DepthBufferView buffer = raster.depthBuffer();
    std::size_t covered = 0;
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      // The slope of the rays through the row's upper border, and where they meet the second hill. Only those
      // that pass over the crest of the first one do.
      const double slope = view.tan_half_fovy * (2.0 * (y + 1.0) / buffer.height - 1.0);
      if (slope > -1.2 / 60.0 + 0.005 && slope < 5.0 / 240.0 - 0.005) {
        ++covered;
        const double distance = (10.0 + 140.0 * 0.15) / (0.15 - slope);
        EXPECT_TRUE(!buffer.covered(160, y) || 1.0 / buffer.at(160, y) >= distance * 0.98)
            << "row " << y << ", far " << far;
      }
    }
    EXPECT_GT(covered, 8u);
  }
}

}  // namespace
}  // namespace sightline
