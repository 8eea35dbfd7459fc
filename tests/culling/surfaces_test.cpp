// What a depth buffer of surfaces promises, against exact proofs: whatever lies in a covered pixel farther
// than its depth is hidden.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>

#include "oracle/exact_visibility.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/oracle/hand_made.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace hand_made;

// Adds a see-through quad that fills pixel (x, y) of the view at this depth, farther by a millionth.
ObjectId addPixel(Scene& scene, MaterialId glass, const View& view, std::uint32_t width, std::uint32_t height,
                  std::uint32_t x, std::uint32_t y, double depth) {
  depth *= 1.0 + 1e-5;
  const auto corner = [&](std::uint32_t column, std::uint32_t row) {
    // A thousandth of a pixel inside: corners are rounded to single precision.
    const double inset_x = column == x ? 1e-3 : -1e-3, inset_y = row == y ? 1e-3 : -1e-3;
    const double u = 2.0 * (column + inset_x) / width - 1.0, v = 2.0 * (row + inset_y) / height - 1.0;
    const double half = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
    return Vec3f(view.eye + view.forward * depth + view.right * (u * half * view.aspect) +
                 view.up * (v * half));
  };
  const Vec3f a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1), d = corner(x, y + 1);
  return addTriangles(scene, glass, std::array<Vec3f, 6>{a, b, c, a, c, d});
}

struct Checked {
  std::size_t covered = 0, wrong = 0, undecided = 0;

  bool right() const { return wrong + undecided == 0; }
};

constexpr SurfaceDrawing kEverything{.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0};

// Proves for each covered pixel, or for every so many of them, that what lies behind it is hidden.
Checked prove(const Scene& scene, const View& view, const DepthBufferView& buffer, std::size_t every = 1) {
  Scene with_pixels = scene;
  const MaterialId glass = addMaterial(with_pixels, Opacity::kBlended, true);
  std::vector<ObjectId> pixels;
  Checked checked;
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      if (!buffer.covered(x, y) || checked.covered++ % every != 0) {
        continue;
      }
      const double value = buffer.at(x, y), depth = view.orthographic ? -value : 1.0 / value;
      if (depth < view.z_far / 1.1) {
        pixels.push_back(addPixel(with_pixels, glass, view, buffer.width, buffer.height, x, y, depth));
      }
    }
  }
  for (const Decision& decision : ExactVisibility(with_pixels.view()).decide(view, pixels, 20'000)) {
    checked.wrong += decision.verdict == Verdict::kVisible ? 1 : 0;
    checked.undecided += decision.verdict == Verdict::kUndecided ? 1 : 0;
  }
  return checked;
}

Checked check(const Scene& scene, const View& view, std::uint32_t width, std::uint32_t height,
              const SurfaceSettings& settings = {}, const SurfaceDrawing& drawing = kEverything) {
  Rasteriser raster({.width = width, .height = height});
  raster.begin(view);
  const SurfaceSet surfaces = findSurfaces(scene.view(), settings);
  raster.draw(surfaces, surfaces.objects, drawing);
  return prove(scene, view, raster.depthBuffer());
}

// A square sheet of hills, count x count squares, as seen from its front: z = -depth + height(x, y).
Scene sheet(std::uint32_t count, float size, float depth, const std::function<float(float, float)>& height,
            const std::function<bool(std::uint32_t)>& leave_out, bool double_sided = false) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, double_sided);
  std::vector<Vec3f> corners;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    const float x = size * (static_cast<float>(i) / static_cast<float>(count) - 0.5f),
                y = size * (static_cast<float>(j) / static_cast<float>(count) - 0.5f);
    return Vec3f(x, y, -depth + height(x, y));
  };
  std::uint32_t triangle = 0;
  for (std::uint32_t j = 0; j < count; ++j) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3f a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const std::array<Vec3f, 3>& t : {std::array<Vec3f, 3>{a, b, c}, std::array<Vec3f, 3>{a, c, d}}) {
        if (!leave_out(triangle++)) {
          corners.insert(corners.end(), t.begin(), t.end());
        }
      }
    }
  }
  addTriangles(scene, material, corners);
  return scene;
}

bool none(std::uint32_t) {
  return false;
}

TEST(Surfaces, ASheetOfSmallTrianglesCoversAllThatLiesWithinItsOutline) {
  const Scene scene = sheet(
      40, 30.0f, 10.0f, [](float x, float y) { return 0.2f * std::sin(3 * x) * y * 0.1f; }, none);
  const Checked checked = check(scene, frontView(), 16, 16, {.part_triangles = 4000});
  EXPECT_EQ(checked.covered, 16u * 16u);
  EXPECT_EQ(checked.wrong + checked.undecided, 0u);
}

TEST(Surfaces, OneMissingTriangleLeavesItsPixelsOpen) {
  for (const std::uint32_t missing : {0u, 399u, 1000u, 3199u}) {
    const Scene scene = sheet(
        40, 24.0f, 10.0f, [](float, float) { return 0.0f; }, [&](std::uint32_t t) { return t == missing; });
    const Checked checked = check(scene, frontView(), 32, 32);
    EXPECT_EQ(checked.wrong + checked.undecided, 0u);
    EXPECT_GT(checked.covered, 800u);
  }
}

TEST(Surfaces, BoundariesOfPatchesWithinASheetAreNone) {
  const Scene scene = sheet(
      12, 24.0f, 10.0f, [](float x, float y) { return std::cos(x) * std::cos(y); }, none);
  const SurfaceSet set = findSurfaces(scene.view(), {.part_triangles = 7, .max_angle_deg = 90.0});
  EXPECT_GT(set.parts.size(), 288u / 7);
  for (const SurfaceCluster& cluster : set.clusters) {
    EXPECT_LE(cluster.triangle_count, 7u);
  }
  std::size_t outline = 0;
  for (const SurfaceChain& chain : set.chains) {
    std::int32_t sum = 0;
    for (const ChainUse& use : set.usesOf(chain)) {
      sum += use.value;
    }
    outline += sum != 0 ? chain.vertex_count - 1 : 0;
  }
  EXPECT_EQ(outline, 48u);  // four sides of 12 squares
}

// A scene of one material with these triangles.
Scene sceneOf(std::span<const Vec3f> corners, bool double_sided = false) {
  Scene scene;
  addTriangles(scene, addMaterial(scene, Opacity::kOpaque, double_sided), corners);
  return scene;
}

// The corners of two triangles that fill a convex quad.
void addQuad(std::vector<Vec3f>& corners, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  corners.insert(corners.end(), {a, b, c, a, c, d});
}

// The faces of a box, seen from outside or from inside.
void addBox(std::vector<Vec3f>& corners, const Vec3f& low, const Vec3f& high, bool inside) {
  const auto at = [&](int x, int y, int z) {
    return Vec3f(x != 0 ? high.x : low.x, y != 0 ? high.y : low.y, z != 0 ? high.z : low.z);
  };
  const std::size_t first = corners.size();
  addQuad(corners, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  addQuad(corners, at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0));
  addQuad(corners, at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1));
  addQuad(corners, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  addQuad(corners, at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0));
  addQuad(corners, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  for (std::size_t i = first; inside && i < corners.size(); i += 3) {
    std::swap(corners[i + 1], corners[i + 2]);
  }
}

// Level and upright edges, many of them exactly along rows, columns and centres of pixels.
TEST(SurfaceProbes, BoxesInAxisAlignedViews) {
  for (const bool orthographic : {false, true}) {
    for (std::uint32_t step = 0; step < 8; ++step) {
      std::vector<Vec3f> corners;
      const float shift = static_cast<float>(step) / 8.0f;
      addBox(corners, {-4.0f + shift, -3.0f, -12.0f}, {1.0f, 2.0f + shift, -10.0f}, false);
      addBox(corners, {1.5f, -6.0f, -30.0f}, {6.0f, 3.0f - shift, -20.0f}, false);
      View view = frontView();
      view.orthographic = orthographic;
      view.ortho_height = 16.0;
      for (const std::uint32_t size : {1u, 16u, 33u}) {
        const Checked checked = check(sceneOf(corners), view, size, size);
        EXPECT_TRUE(checked.right()) << step << ", " << size;
        EXPECT_TRUE(size == 1 || checked.covered > 4);
      }
    }
  }
}

TEST(SurfaceProbes, AClosedRoomHidesAllThatLiesBehindItsWalls) {
  std::vector<Vec3f> corners;
  addBox(corners, {-5.0f, -4.0f, -7.0f}, {6.0f, 3.0f, 8.0f}, true);
  View view = frontView();
  view.eye = {0.25, -0.5, 1.0};
  for (const double near : {0.01, 0.1, 2.0, 7.5}) {
    view.z_near = near;
    const Checked checked = check(sceneOf(corners), view, 24, 24);
    EXPECT_TRUE(checked.right());
    EXPECT_TRUE(checked.covered == 24u * 24u || near > 7.0) << "the near plane leaves a corner of the room";
  }
  // From the back, its walls hide nothing.
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::swap(corners[i + 1], corners[i + 2]);
  }
  view.z_near = 0.1;
  EXPECT_EQ(check(sceneOf(corners), view, 24, 24).covered, 0u);
}

TEST(SurfaceProbes, TheNearPlaneCutsThroughEverything) {
  const Scene scene = sheet(
      20, 30.0f, 10.0f, [](float x, float y) { return 4.0f * std::sin(0.4f * x) * std::cos(0.3f * y); },
      none);
  for (const double near : {5.0, 6.0, 8.0, 10.0, 12.0, 13.5}) {
    View view = frontView();
    view.z_near = near;
    EXPECT_TRUE(check(scene, view, 32, 32).right()) << near;
    view.orthographic = true;
    EXPECT_TRUE(check(scene, view, 32, 32).right()) << near;
  }
}

// Two sheets with a slit between them; where they only almost meet, the slit is one unit in the last place.
TEST(SurfaceProbes, SlitsAndCracksStayOpen) {
  for (const float gap : {1e-4f, 0.0f}) {
    std::vector<Vec3f> corners;
    const float right = gap > 0.0f ? gap : std::nextafter(1.0f, 2.0f) - 1.0f;
    addQuad(corners, {-9.0f, -9.0f, -10.0f}, {1.0f, -9.0f, -10.0f}, {1.0f, 9.0f, -10.0f},
            {-9.0f, 9.0f, -10.0f});
    addQuad(corners, {1.0f + right, -9.0f, -10.0f}, {9.0f, -9.0f, -10.0f}, {9.0f, 9.0f, -10.0f},
            {1.0f + right, 9.0f, -10.0f});
    const Checked checked = check(sceneOf(corners), frontView(), 32, 32);
    EXPECT_TRUE(checked.right());
    // The sheets fill 28 x 28 pixels of the picture, and the slit runs through one column of them.
    EXPECT_EQ(checked.covered, 27u * 28u);
  }
}

// A wall of panels, each row shifted by half a panel, so that corners lie on edges; leaning, where it must
// still be exact, and with one panel's corner moved.
std::vector<Vec3f> panels(bool leaning, float moved) {
  std::vector<Vec3f> corners;
  const auto at = [&](int x, int y) {
    const auto u = static_cast<float>(x), v = static_cast<float>(y);
    return leaning ? Vec3f(u + 0.25f * v, v - 0.5f * u, -20.0f + 0.75f * u + 0.5f * v) : Vec3f(u, v, -14.0f);
  };
  for (int y = -8; y < 8; y += 2) {
    for (int x = -12 + (y & 2) / 2; x < 10; x += 2) {
      Vec3f a = at(x, y), b = at(x + 2, y), c = at(x + 2, y + 2), d = at(x, y + 2);
      if (x == 0 && y == 0) {
        a.y += moved;
      }
      addQuad(corners, a, b, c, d);
    }
  }
  return corners;
}

TEST(SurfaceProbes, PanelsWhoseCornersLieOnEdgesJoin) {
  for (const bool leaning : {false, true}) {
    std::size_t covered[3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const Scene scene = sceneOf(panels(leaning, i == 2 ? 0x1p-20f : 0.0f));
      const SurfaceSettings settings{.part_triangles = 4096, .join_edges = i > 0};
      const Checked checked = check(scene, frontView(), 40, 40, settings);
      EXPECT_TRUE(checked.right()) << leaning << ", " << i;
      covered[i] = checked.covered;
    }
    EXPECT_GT(covered[1], covered[0] + 100);
    // A millionth of a metre is a crack.
    EXPECT_LT(covered[2], covered[1]);
    EXPECT_GT(covered[2] + 20, covered[1]);
  }
}

// Sheets that meet at one edge, in all orientations, single-sided and double-sided.
TEST(SurfaceProbes, EdgesWithUpToFourSheets) {
  const Vec3f low{0.1f, -6.0f, -10.0f}, high{-0.2f, 6.0f, -10.0f};
  const Vec3f ends[4] = {
      {-7.0f, 0.5f, -9.0f}, {7.0f, 0.3f, -11.0f}, {-6.0f, 0.2f, -14.0f}, {5.0f, -0.4f, -7.0f}};
  std::size_t covered = 0;
  for (std::uint32_t sheets = 2; sheets <= 4; ++sheets) {
    for (std::uint32_t turned = 0; turned < 1u << sheets; ++turned) {
      for (const bool double_sided : {false, true}) {
        for (const std::uint32_t size : {1u, 1024u}) {
          std::vector<Vec3f> corners;
          for (std::uint32_t i = 0; i < sheets; ++i) {
            const bool turn = (turned >> i & 1) != 0;
            corners.insert(corners.end(), {turn ? high : low, turn ? low : high, ends[i]});
          }
          const Checked checked =
              check(sceneOf(corners, double_sided), frontView(), 20, 20,
                    {.cluster_triangles = size, .max_angle_deg = 180.0, .join_edges = size == 1});
          EXPECT_TRUE(checked.right()) << sheets << ", " << turned << ", " << double_sided;
          covered += checked.covered;
        }
      }
    }
  }
  EXPECT_GT(covered, 3000u);
}

TEST(SurfaceProbes, MoebiusStripsAndFoldedSheets) {
  for (const bool double_sided : {false, true}) {
    std::vector<Vec3f> strip, folded;
    const auto edge = [](std::uint32_t i, float side) {
      const float angle = 6.2831853f * static_cast<float>(i % 24) / 24.0f;
      const float turn = (i == 24 ? -side : side);  // the strip closes with its sides exchanged
      const float radius = 5.0f + turn * 2.0f * std::cos(0.5f * angle);
      return Vec3f(radius * std::cos(angle), radius * std::sin(angle),
                   -12.0f + turn * 2.0f * std::sin(0.5f * angle));
    };
    for (std::uint32_t i = 0; i < 24; ++i) {
      addQuad(strip, edge(i, -1.0f), edge(i, 1.0f), edge(i + 1, 1.0f), edge(i + 1, -1.0f));
    }
    addQuad(folded, {-6, -5, -10}, {5, -5, -10}, {5, 5, -10}, {-6, 5, -10});
    addQuad(folded, {5, -5, -10}, {5, 5, -10}, {-4, 4, -8}, {-4, -4, -8});
    addQuad(folded, {-4, -4, -8}, {-4, 4, -8}, {6, 3, -6}, {6, -3, -6});
    for (const std::uint32_t size : {1u, 5u, 1024u}) {
      const SurfaceSettings settings{.cluster_triangles = size, .max_angle_deg = 180.0};
      EXPECT_TRUE(check(sceneOf(strip, double_sided), frontView(), 32, 32, settings).right());
      const Checked checked = check(sceneOf(folded, double_sided), frontView(), 32, 32, settings);
      EXPECT_TRUE(checked.right());
      EXPECT_GT(checked.covered, 50u);
    }
  }
}

TEST(SurfaceProbes, ABudgetThatRunsOutCoversLess) {
  const Scene scene = sheet(
      24, 40.0f, 12.0f, [](float x, float y) { return 3.0f * std::sin(x) * std::cos(0.7f * y); }, none);
  const SurfaceSettings settings{.part_triangles = 60};
  SurfaceDrawing drawing = kEverything;
  std::size_t last = 0;
  for (const std::uint32_t budget : {0u, 1u, 100u, 400u, 1000u, 1'000'000u}) {
    drawing.budget = budget;
    const Checked checked = check(scene, frontView(), 40, 40, settings, drawing);
    EXPECT_TRUE(checked.right());
    EXPECT_GE(checked.covered, last);
    EXPECT_TRUE(budget > 0 || checked.covered == 0);
    last = checked.covered;
  }
  EXPECT_GT(last, 1000u);
}

// More edges than a row can count.
TEST(SurfaceProbes, ManyEdgesThroughOneRowCoverNothingWrong) {
  std::vector<Vec3f> corners;
  for (int i = 0; i < 9000; ++i) {
    const float x = -6.0f + 12.0f * static_cast<float>(i) / 9000.0f,
                depth = -10.0f - 1e-4f * static_cast<float>(i);
    corners.insert(corners.end(),
                   {Vec3f(x, -3.0f, depth), Vec3f(x + 4.0f, -3.0f, depth), Vec3f(x + 2.0f, 3.0f, depth)});
    corners.insert(corners.end(),
                   {Vec3f(x, -3.0f, depth), Vec3f(x + 2.0f, 3.0f, depth), Vec3f(x - 1.0f, 3.0f, depth)});
  }
  Rasteriser raster({.width = 16, .height = 16});
  const Scene scene = sceneOf(corners);
  raster.begin(frontView());
  const SurfaceSet surfaces = findSurfaces(scene.view());
  raster.draw(surfaces, surfaces.objects, kEverything);
  EXPECT_TRUE(prove(scene, frontView(), raster.depthBuffer(), 16).right());
}

TEST(SurfaceProbes, ViewsThatFollowEachOtherAreRightToo) {
  const Scene scene = sheet(
      30, 50.0f, 10.0f, [](float x, float y) { return 3.0f * std::sin(0.5f * x) * std::cos(0.8f * y); },
      [](std::uint32_t t) { return t % 37 == 0; });
  const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 100, .patch_triangles = 20});
  const SurfaceSet others = findSurfaces(scene.view());
  Rasteriser raster({.width = 32, .height = 32});
  SurfaceDrawing drawing = kEverything;
  for (int i = 0; i < 12; ++i) {
    View view = frontView();
    view.eye = {0.3 * i, 0.1 * i, -0.2 * i};
    drawing.step = i == 5 ? ViewStep::kJump : ViewStep::kNext;
    raster.begin(view);
    raster.draw(i % 4 == 3 ? others : surfaces, surfaces.objects, drawing);
    drawing.step = ViewStep::kSame;
    raster.draw(i % 4 == 3 ? others : surfaces, surfaces.objects, drawing);
    const Checked checked = prove(scene, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << i;
    EXPECT_GT(checked.covered, 300u);
  }
}

TEST(SurfaceProbes, MapsOfManySizes) {
  const Scene scene = sheet(
      16, 30.0f, 10.0f, [](float x, float y) { return 2.0f * std::sin(x) * std::cos(y); },
      [](std::uint32_t t) { return t == 200; });
  for (const auto& [width, height] : {std::pair(1u, 1u), {1u, 64u}, {7u, 3u}, {1000u, 8u}, {4096u, 4096u}}) {
    Rasteriser raster({.width = width, .height = height});
    raster.begin(frontView());
    const SurfaceSet surfaces = findSurfaces(scene.view());
    raster.draw(surfaces, surfaces.objects, kEverything);
    const Checked checked =
        prove(scene, frontView(), raster.depthBuffer(), std::max(1u, width * height / 2000));
    EXPECT_TRUE(checked.right()) << width << " x " << height;
    EXPECT_TRUE(width < 1000 || checked.covered > width * height / 2);
  }
}

// The top edge of each wall rises by a pixel in thousands; within one row of pixels its line leaves the map
// by thousands of pixels.
TEST(SurfaceProbes, EdgesThatAreNearlyLevelCrossTheirRowsWhereTheyDo) {
  constexpr std::uint32_t kWidth = 1280, kHeight = 8;
  View view = frontView();
  view.aspect = static_cast<double>(kWidth) / kHeight;
  view.tan_half_fovy = 0.5 * kHeight / 720.0;  // 720 pixels a metre, one metre before the eye
  const auto at = [](double x, double y) {
    return Vec3f(static_cast<float>((x - 0.5 * kWidth) / 720.0),
                 static_cast<float>((y - 0.5 * kHeight) / 720.0), -1.0f);
  };
  // Half of a wall's length and what its top rises in that, pixels: walls of 17, 56 and 278 metres.
  for (const auto& [half, rise] : {std::pair(6000.0, 0.43), {20'000.0, 0.6}, {100'000.0, 0.6}}) {
    std::vector<Vec3f> corners;
    addQuad(corners, at(-half, -1e4), at(half, -1e4), at(half, 4.25 + rise), at(-half, 4.25 - rise));
    const Checked checked = check(sceneOf(corners), view, kWidth, kHeight);
    EXPECT_TRUE(checked.right()) << half;
    // The top edge lies within the fifth row of pixels, or begins to do so in the map's middle.
    EXPECT_GE(checked.covered, 4 * kWidth - 2);
    EXPECT_LE(checked.covered, 5 * kWidth);
  }
}

// The part of the triangle before the near plane is smaller than what single precision makes of half the size
// of its box.
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
    raster.draw(surfaces, surfaces.objects, kEverything);
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

TEST(SurfaceProbes, AVertexJustBeforeTheNearPlaneIsCutOff) {
  const View view = frontView();
  const double clip = view.z_near * (1.0 + 1e-6);
  for (float depth = static_cast<float>(clip - 4.5e-7); depth < clip; depth = std::nextafter(depth, 1.0f)) {
    const std::array<Vec3f, 3> corners{Vec3f(-0.12f, 0.12f, -depth), Vec3f(-22.0f, -22.0f, -20.0f),
                                       Vec3f(0.12f, -0.12f, -depth)};
    const Checked checked = check(sceneOf(corners), view, 16, 16);
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
    const Checked checked =
        check(sceneOf(corners, n % 3 == 0), view, 8, 8, {.max_angle_deg = n % 5 < 2 ? 180.0 : 20.0});
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
    const SurfaceSet surfaces = findSurfaces(sceneOf(corners, true).view());
    raster.draw(surfaces, surfaces.objects, kEverything);
    EXPECT_FALSE(all_behind && raster.depthBuffer().covered(0, 0)) << n;
    behind += all_behind ? 1 : 0;
  }
  EXPECT_GT(behind, 1000u);
  View view = frontView();
  view.orthographic = true;
  view.ortho_height = 20.0;
  view.z_near = 0.0;
  const Scene beyond = sheet(
      4, 24.0f, 10.0f, [](float x, float) { return 0.1f * x; }, none);
  const Checked checked = check(beyond, view, 16, 16);
  EXPECT_TRUE(checked.right());
  EXPECT_EQ(checked.covered, 16u * 16u);
}

// Pairs of triangles that share an edge, in as many parts and clusters as in any other such scene. Folded
// ones are two patches each.
Scene pairs(float size, float fold) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, false);
  for (int i = 0; i < 400; ++i) {
    const float x = 2.0f * static_cast<float>(i % 20 - 10), y = 2.0f * static_cast<float>(i / 20 - 10);
    std::vector<Vec3f> corners;
    addQuad(corners, {x, y, -20.0f}, {x + size, y, -20.0f + fold}, {x + size, y + size, -20.0f},
            {x, y + size, -20.0f + fold});
    addTriangles(scene, material, corners);
  }
  return scene;
}

TEST(SurfaceProbes, WhatRestsIsDrawnWhereThatIsAskedFor) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -10.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  for (const bool draw_resting : {false, true}) {
    Rasteriser raster({.width = 64, .height = 64});
    SurfaceDrawing drawing = kEverything;
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
    SurfaceDrawing drawing = kEverything;
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
    SurfaceDrawing drawing = kEverything;
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
  SurfaceDrawing drawing = kEverything;
  drawing.targets = targets;
  drawing.useful_only = true;
  raster.begin(frontView());
  raster.draw(surfaces, surfaces.objects, drawing);
  EXPECT_EQ(raster.surfaceStats().groups, 0u) << "nothing was drawn in a view before";

  drawing.useful_only = false;
  drawing.step = ViewStep::kSame;
  raster.draw(surfaces, surfaces.objects, drawing);
  EXPECT_EQ(raster.surfaceStats().groups, 17u);
  EXPECT_EQ(prove(scene, frontView(), raster.depthBuffer(), 16).wrong, 0u);

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

Mat4 movedBy(const Vec3d& by) {
  Mat4 m;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 3) = by[axis];
  }
  return m;
}

TEST(SurfaceTargets, AreOfAllSetsThatAreDrawnWhereverTheseAre) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), 0.0f, -3.0f, 3.0f, -9.0f, 9.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 64, .height = 64});
  SurfaceDrawing drawing = kEverything;
  std::vector<Box> targets{behind(5.0f, 0.0f)};
  drawing.targets = targets;
  const auto groupsAt = [&](double x, double z) {
    return raster.draw(MovingSurfaces{&surfaces, movedBy({x, 0.0, z})}, drawing).groups;
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
  SurfaceDrawing drawing = kEverything;
  drawing.targets = targets;
  const auto groups = [&](const SurfaceSet& set) {
    const MovingSurfaces placed{&set, movedBy({&set == &left ? -5.0 : 5.0, 0.0, 0.0})};
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
    SurfaceDrawing drawing = kEverything;
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
      2, 40000.0f, 10.0f, [](float, float) { return 0.0f; }, none, true);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 16, .height = 16});
  SurfaceDrawing drawing = kEverything;
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

TEST(SurfaceProbes, ASetMadeAnewInTheSamePlaceIsAnotherSet) {
  const SurfaceSettings settings{.cluster_triangles = 1};
  const Scene small = pairs(1e-3f, 0.0f), large = pairs(1.8f, 1.5f);
  Rasteriser raster({.width = 64, .height = 64}), fresh({.width = 64, .height = 64});
  SurfaceDrawing drawing = kEverything;
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
  const Checked checked = prove(large, frontView(), raster.depthBuffer());
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
      addQuad(corners, {x, -9.0f, -20.0f}, {x + 0.4f, -9.0f, -20.0f + by}, {x + 0.4f, 9.0f, -20.0f + by},
              {x, 9.0f, -20.0f});
      addTriangles(scene, material, corners);
    }
    return scene;
  };
  const Scene before = tilted(3.0f), after = tilted(-3.0f);
  Rasteriser raster({.width = 64, .height = 64}), fresh({.width = 64, .height = 64});
  SurfaceDrawing drawing = kEverything;
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
  EXPECT_TRUE(prove(after, frontView(), raster.depthBuffer()).right());
  std::size_t covered = 0;
  for (std::uint32_t y = 0; y < 64; ++y) {
    EXPECT_TRUE(std::ranges::equal(raster.depthBuffer().row(y), fresh.depthBuffer().row(y))) << y;
    for (std::uint32_t x = 0; x < 64; ++x) {
      covered += fresh.depthBuffer().covered(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(covered, 20u);
}

TEST(SurfaceProbes, HostileInputHidesNothing) {
  constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  std::vector<Vec3f> corners{
      {kNotANumber, 0, -10}, {1, 0, -10},           {0, 1, -10},          {-kInf, -5, -10}, {5, -5, -10},
      {0, kInf, -10},        {-3e38f, -3e38f, -10}, {3e38f, -3e38f, -10}, {0, 3e38f, -10},  {1, 1, -10},
      {1, 1, -10},           {2, 2, -10},           {0, 0, -10},          {1, 0, -10},      {2, 0, -10}};
  EXPECT_TRUE(check(sceneOf(corners), frontView(), 16, 16).right());
  EXPECT_EQ(findSurfaces(Scene().view()).parts.size(), 0u);
  Rasteriser raster({.width = 8, .height = 8});
  const Scene scene = sheet(
      4, 30.0f, 10.0f, [](float, float) { return 0.0f; }, none);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  View view = frontView();
  view.eye.x = std::numeric_limits<double>::quiet_NaN();
  raster.begin(view);
  raster.draw(surfaces, surfaces.objects, kEverything);
  EXPECT_FALSE(raster.depthBuffer().covered(4, 4));
}

TEST(SurfaceSets, EveryTriangleIsInOneClusterAndChainsAreItsBoundary) {
  const Scene scene = sheet(
      13, 20.0f, 10.0f, [](float x, float y) { return std::sin(x) + std::cos(3.0f * y); },
      [](std::uint32_t t) { return t % 11 == 0; });
  const SurfaceSet set =
      findSurfaces(scene.view(), {.part_triangles = 50, .patch_triangles = 20, .cluster_triangles = 7});
  EXPECT_EQ(set.triangles.size(), scene.view().indices.size());
  // The signed edges of each cluster, from its triangles and from its chains.
  using Edge = std::array<float, 6>;
  for (std::uint32_t c = 0; c < set.clusters.size(); ++c) {
    std::map<Edge, int> edges;
    const auto add = [&](const Vec3f& a, const Vec3f& b, int value) {
      edges[{a.x, a.y, a.z, b.x, b.y, b.z}] += value;
      edges[{b.x, b.y, b.z, a.x, a.y, a.z}] -= value;
    };
    EXPECT_LE(set.clusters[c].triangle_count, 7u);
    const auto corners = set.trianglesOf(set.clusters[c]);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        add(set.vertices[corners[i + k]], set.vertices[corners[i + (k + 1) % 3]], 1);
      }
    }
    for (const std::uint32_t number : set.chainsOf(set.clusters[c])) {
      const auto vertices = set.verticesOf(set.chains[number]);
      for (const ChainUse& use : set.usesOf(set.chains[number])) {
        for (std::size_t i = 1; use.cluster == c && i < vertices.size(); ++i) {
          add(vertices[i - 1], vertices[i], -use.value);
        }
      }
    }
    for (const auto& [edge, value] : edges) {
      EXPECT_EQ(value, 0) << "cluster " << c;
    }
  }
}

class RandomSurfaces : public testing::TestWithParam<bool> {};

TEST_P(RandomSurfaces, HideWhatTheyCover) {
  Checked all;
  for (std::uint64_t seed = 0; seed < test::rounds(40u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    const float rough = static_cast<float>(number(0.0, 4.0));
    const double waves = number(0.1, 2.0);
    const std::uint32_t count = 4 + static_cast<std::uint32_t>(number(0.0, 20.0));
    const double holes = number(0.0, 1.0) < 0.5 ? 0.0 : number(0.0, 0.2);
    Scene scene = sheet(
        count, 40.0f, 12.0f,
        [&](float x, float y) {
          return rough * static_cast<float>(std::sin(waves * x) * std::cos(waves * y));
        },
        [&](std::uint32_t) { return number(0.0, 1.0) < holes; }, number(0.0, 1.0) < 0.5);
    View view = frontView();
    view.eye = {number(-3.0, 3.0), number(-3.0, 3.0), number(-13.0, 3.0)};
    setOrientation(view, {number(-1.0, 1.0), number(-1.0, 1.0), -1.0}, {0.0, 1.0, 0.0});
    view.z_near = number(0.0, 1.0) < 0.5 ? 0.1 : number(0.5, 8.0);
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    const Checked checked = check(scene, view, 1 + static_cast<std::uint32_t>(number(0.0, 40.0)), 24);
    EXPECT_EQ(checked.wrong + checked.undecided, 0u) << "seed " << seed;
    all.covered += checked.covered;
  }
  EXPECT_GT(all.covered, test::rounds(4000u));
}

TEST_P(RandomSurfaces, HideWhatTheyCoverWhereOnlySomeAreDrawn) {
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
    SurfaceDrawing drawing = kEverything;
    raster.begin(view);
    raster.draw(surfaces, surfaces.objects, drawing);
    const std::uint32_t all = raster.surfaceStats().groups;
    aim();
    drawing.targets = targets;
    drawing.pixels_per_edge = number(0.0, 2.0);
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
    const Checked checked = prove(scene, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
  }
  EXPECT_GT(covered, test::rounds(2000u));
  EXPECT_GT(useful, test::rounds(20u));
  EXPECT_GT(fewer, test::rounds(20u));
}

// A rotation and a translation.
Mat4 placement(const Vec3d& forward, const Vec3d& up, const Vec3d& origin) {
  View axes;
  setOrientation(axes, forward, up);
  Mat4 m;
  const Vec3d columns[] = {axes.right, axes.up, -axes.forward, origin};
  for (int column = 0; column < 4; ++column) {
    m(0, column) = columns[column].x;
    m(1, column) = columns[column].y;
    m(2, column) = columns[column].z;
  }
  return m;
}

// The view that sees the moved surfaces where they are before they are moved.
View movedBack(const View& view, const Mat4& m) {
  const auto turned = [&](const Vec3d& v) {
    return Vec3d(m(0, 0) * v.x + m(1, 0) * v.y + m(2, 0) * v.z, m(0, 1) * v.x + m(1, 1) * v.y + m(2, 1) * v.z,
                 m(0, 2) * v.x + m(1, 2) * v.y + m(2, 2) * v.z);
  };
  View back = view;
  back.eye = turned(view.eye - Vec3d(m(0, 3), m(1, 3), m(2, 3)));
  back.right = turned(view.right);
  back.up = turned(view.up);
  back.forward = turned(view.forward);
  return back;
}

TEST_P(RandomSurfaces, HideWhatTheyCoverWhereverTheyAreMoved) {
  std::size_t covered = 0;
  Rasteriser raster({.width = 24, .height = 24});
  for (std::uint64_t seed = 0; seed < test::rounds(30u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    const auto anywhere = [&](double size) {
      return Vec3d(number(-size, size), number(-size, size), number(-size, size));
    };
    const Scene scene = sheet(
        6, 40.0f, 12.0f, [&](float x, float y) { return 2.0f * std::sin(0.3f * x) * std::cos(0.4f * y); },
        [&](std::uint32_t) { return number(0.0, 1.0) < 0.05; });
    const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 30});
    const Mat4 m = placement(anywhere(1.0), anywhere(1.0), anywhere(seed % 3 == 0 ? 1e5 : 50.0));
    View view = frontView();
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    view.eye = transformPoint(m, anywhere(4.0));
    setOrientation(view, transformDirection(m, Vec3d(0.0, 0.0, -1.0) + anywhere(0.6)), anywhere(1.0));
    raster.begin(view);
    raster.draw(MovingSurfaces{&surfaces, m}, kEverything);
    const Checked checked = prove(scene, movedBack(view, m), raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
  }
  EXPECT_GT(covered, test::rounds(3000u));
}

// The scene with each point where the matrix takes it, and the fronts of triangles still fronts. Exact if all
// coordinates and elements have few binary digits.
Scene transformed(Scene scene, const Mat4& m) {
  for (Vec3f& p : scene.positions) {
    p = Vec3f(transformPoint(m, Vec3d(p)));
  }
  for (std::size_t i = 0; determinant3(m) < 0.0 && i < scene.indices.size(); i += 3) {
    std::swap(scene.indices[i], scene.indices[i + 1]);
  }
  updateBounds(scene);
  return scene;
}

TEST_P(RandomSurfaces, HideWhatTheyCoverHoweverTheyAreStretchedAndMirrored) {
  std::size_t covered = 0, of_the_transformed = 0, mirrored = 0;
  Rasteriser raster({.width = 24, .height = 24});
  for (std::uint64_t seed = 0; seed < test::rounds(40u); ++seed) {
    std::mt19937 engine(static_cast<std::mt19937::result_type>(seed));
    const auto number = test::numbersFrom<double>(engine);
    // Numbers of few binary digits, so that transformed points are exact in single precision.
    const auto eighths = [&](double size) { return std::floor(8.0 * number(-size, size)) / 8.0; };
    Scene scene = sheet(
        6, 40.0f, 12.0f,
        [&](float x, float y) {
          return std::round(32.0f * 2.0f * std::sin(0.3f * x) * std::cos(0.4f * y)) / 32.0f;
        },
        [&](std::uint32_t) { return number(0.0, 1.0) < 0.05; });
    for (Vec3f& p : scene.positions) {
      p = {std::round(32.0f * p.x) / 32.0f, std::round(32.0f * p.y) / 32.0f, std::round(32.0f * p.z) / 32.0f};
    }
    updateBounds(scene);
    Mat4 m;
    do {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          m(row, column) = seed % 4 == 0 ? (row == column ? (row == 2 ? 0.125 : 4.0) : 0.0) : eighths(2.0);
        }
        m(row, 3) = eighths(20.0);
      }
      if (seed % 8 == 0) {
        m(0, 0) = -m(0, 0);
      }
    } while (std::abs(determinant3(m)) < 0.2);
    mirrored += determinant3(m) < 0.0 ? 1 : 0;
    const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 30});
    const Scene world = transformed(scene, m);
    View view = frontView();
    view.orthographic = GetParam();
    view.ortho_height = 20.0;
    view.z_near = seed % 3 == 0 ? 3.0 : view.z_near;
    view.eye = transformPoint(m, {eighths(4.0), eighths(4.0), 0.0});
    setOrientation(view, transformDirection(m, Vec3d(eighths(0.5), eighths(0.5), -1.0)),
                   {number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)});
    raster.begin(view);
    raster.draw(MovingSurfaces{&surfaces, m}, kEverything);
    const Checked checked = prove(world, view, raster.depthBuffer());
    EXPECT_TRUE(checked.right()) << "seed " << seed;
    covered += checked.covered;
    of_the_transformed += check(world, view, 24, 24, {.part_triangles = 30}).covered;
  }
  EXPECT_GT(mirrored, test::rounds(10u));
  EXPECT_GT(covered, test::rounds(3000u));
  EXPECT_GT(static_cast<double>(covered), 0.9 * static_cast<double>(of_the_transformed));
}

TEST(MovingSurfaces, AreDrawnWithAffineMatricesOnly) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), 0.0f, -50.0f, 50.0f, -50.0f, 50.0f);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Rasteriser raster({.width = 16, .height = 16});
  const auto coveredWith = [&](const Mat4& m) {
    raster.begin(frontView());
    raster.draw(MovingSurfaces{&surfaces, m}, kEverything);
    std::size_t count = 0;
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t x = 0; x < 16; ++x) {
        count += raster.depthBuffer().covered(x, y) ? 1 : 0;
      }
    }
    return count;
  };
  const Mat4 rigid = placement({0.2, 0.1, -1.0}, {0.3, 1.0, 0.0}, {0.0, 0.0, -10.0});
  EXPECT_EQ(coveredWith(rigid), 256u);
  Mat4 scaled = rigid, mirrored = rigid, sheared = rigid, not_a_number = rigid, far = rigid, halved = rigid,
       projected = rigid, flat = rigid, thin = rigid, endless = rigid, tiny = rigid;
  for (int row = 0; row < 3; ++row) {
    scaled(row, 0) *= 100.0;
    mirrored(row, 0) *= -1.0;
    sheared(row, 0) += 0.5 * rigid(row, 1);
    flat(row, 1) = 0.0;
    thin(row, 1) *= 1e-5;
    endless(row, 1) = std::numeric_limits<double>::infinity();
    for (int column = 0; column < 3; ++column) {
      tiny(row, column) *= 1e-30;
    }
  }
  not_a_number(1, 3) = std::numeric_limits<double>::quiet_NaN();
  far(0, 3) = 1e18;
  halved(3, 3) = 0.5;
  projected(3, 2) = std::numeric_limits<double>::quiet_NaN();
  for (const Mat4& m : {scaled, mirrored, sheared}) {
    EXPECT_EQ(coveredWith(m), 256u);
  }
  for (const Mat4& m : {not_a_number, far, halved, projected, flat, thin, endless, tiny}) {
    EXPECT_EQ(coveredWith(m), 0u);
  }
  raster.begin(frontView());
  raster.draw(MovingSurfaces{}, kEverything);
  EXPECT_FALSE(raster.depthBuffer().covered(8, 8));
}

TEST(MovingSurfaces, ADoorHidesTheRoomWhileItIsShut) {
  Scene door, scene;
  addWall(door, addMaterial(door, Opacity::kOpaque, true), 0.0f, -20.0f, 20.0f, -20.0f, 20.0f);
  const SurfaceSet surfaces = findSurfaces(door.view());
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), -20.0f, -1.0f, 1.0f, -1.0f, 1.0f);
  const std::vector<Box> bounds{scene.objects[0].bounds};
  const Hierarchy hierarchy = buildHierarchy(bounds, {});
  const Mat4 shut = placement({0, 0, -1}, {0, 1, 0}, {0, 0, -10}),
             open = placement({-1, 0, 0}, {0, 1, 0}, {-5, 0, -10});
  for (const bool pyramid : {false, true}) {
    OpacityMapMethodSettings drawing;
    drawing.surfaces = SurfaceUse::kAlone;
    Culler culler({.hierarchy = &hierarchy, .object_bounds = bounds},
                  pyramid ? depthPyramid() : opacityMap(drawing));
    for (const bool is_shut : {true, false, true, true}) {
      const MovingSurfaces moving{&surfaces, is_shut ? shut : open};
      culler.cull(frontView(), bounds, nullptr, std::span(&moving, 1));
      EXPECT_EQ(culler.visible().empty(), is_shut) << pyramid;
      EXPECT_EQ(culler.dynamicStates()[0] == Visibility::kHidden, is_shut) << pyramid;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Views, RandomSurfaces, testing::Bool(),
                         [](const auto& shown) { return shown.param ? "Orthographic" : "Perspective"; });

}  // namespace
}  // namespace sightline
