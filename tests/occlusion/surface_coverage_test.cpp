// What surfaces of many shapes cover, against exact proofs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/occlusion/surface_proofs.h"
#include "tests/support/hand_made.h"
#include "tests/support/made_surfaces.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using hand_made::frontView;
using test::appendBox;
using test::appendQuad;
using test::drawAndProve;
using test::kDrawAll;
using test::noTriangle;
using test::ProvedPixels;
using test::provePixels;
using test::sceneOfCorners;
using test::sheet;

TEST(Surfaces, ASheetOfSmallTrianglesCoversAllThatLiesWithinItsOutline) {
  const Scene scene = sheet(
      40, 30.0f, 10.0f, [](float x, float y) { return 0.2f * std::sin(3 * x) * y * 0.1f; }, noTriangle);
  const ProvedPixels checked = drawAndProve(scene, frontView(), 16, 16, {.part_triangles = 4000});
  EXPECT_EQ(checked.covered, 16u * 16u);
  EXPECT_EQ(checked.wrong + checked.undecided, 0u);
}

TEST(Surfaces, OneMissingTriangleLeavesItsPixelsOpen) {
  for (const std::uint32_t missing : {0u, 399u, 1000u, 3199u}) {
    const Scene scene = sheet(
        40, 24.0f, 10.0f, [](float, float) { return 0.0f; }, [&](std::uint32_t t) { return t == missing; });
    const ProvedPixels checked = drawAndProve(scene, frontView(), 32, 32);
    EXPECT_EQ(checked.wrong + checked.undecided, 0u);
    EXPECT_GT(checked.covered, 800u);
  }
}

TEST(Surfaces, BoundariesOfPatchesWithinASheetAreNone) {
  const Scene scene = sheet(
      12, 24.0f, 10.0f, [](float x, float y) { return std::cos(x) * std::cos(y); }, noTriangle);
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

// Level and upright edges, many of them exactly along rows, columns and centres of pixels.
TEST(SurfaceProbes, BoxesInAxisAlignedViews) {
  for (const bool orthographic : {false, true}) {
    for (std::uint32_t step = 0; step < 8; ++step) {
      std::vector<Vec3f> corners;
      const float shift = static_cast<float>(step) / 8.0f;
      appendBox(corners, {-4.0f + shift, -3.0f, -12.0f}, {1.0f, 2.0f + shift, -10.0f}, false);
      appendBox(corners, {1.5f, -6.0f, -30.0f}, {6.0f, 3.0f - shift, -20.0f}, false);
      View view = frontView();
      view.orthographic = orthographic;
      view.ortho_height = 16.0;
      for (const std::uint32_t size : {1u, 16u, 33u}) {
        const ProvedPixels checked = drawAndProve(sceneOfCorners(corners), view, size, size);
        EXPECT_TRUE(checked.right()) << step << ", " << size;
        EXPECT_TRUE(size == 1 || checked.covered > 4);
      }
    }
  }
}

TEST(SurfaceProbes, AClosedRoomHidesAllThatLiesBehindItsWalls) {
  std::vector<Vec3f> corners;
  appendBox(corners, {-5.0f, -4.0f, -7.0f}, {6.0f, 3.0f, 8.0f}, true);
  View view = frontView();
  view.eye = {0.25, -0.5, 1.0};
  for (const double near : {0.01, 0.1, 2.0, 7.5}) {
    view.z_near = near;
    const ProvedPixels checked = drawAndProve(sceneOfCorners(corners), view, 24, 24);
    EXPECT_TRUE(checked.right());
    EXPECT_TRUE(checked.covered == 24u * 24u || near > 7.0) << "the near plane leaves a corner of the room";
  }
  // From the back, its walls hide nothing.
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::swap(corners[i + 1], corners[i + 2]);
  }
  view.z_near = 0.1;
  EXPECT_EQ(drawAndProve(sceneOfCorners(corners), view, 24, 24).covered, 0u);
}

// Two sheets with a slit between them; where they only almost meet, the slit is one unit in the last place.
TEST(SurfaceProbes, SlitsAndCracksStayOpen) {
  for (const float gap : {1e-4f, 0.0f}) {
    std::vector<Vec3f> corners;
    const float right = gap > 0.0f ? gap : std::nextafter(1.0f, 2.0f) - 1.0f;
    appendQuad(corners, {-9.0f, -9.0f, -10.0f}, {1.0f, -9.0f, -10.0f}, {1.0f, 9.0f, -10.0f},
               {-9.0f, 9.0f, -10.0f});
    appendQuad(corners, {1.0f + right, -9.0f, -10.0f}, {9.0f, -9.0f, -10.0f}, {9.0f, 9.0f, -10.0f},
               {1.0f + right, 9.0f, -10.0f});
    const ProvedPixels checked = drawAndProve(sceneOfCorners(corners), frontView(), 32, 32);
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
      appendQuad(corners, a, b, c, d);
    }
  }
  return corners;
}

TEST(SurfaceProbes, PanelsWhoseCornersLieOnEdgesJoin) {
  for (const bool leaning : {false, true}) {
    std::size_t covered[3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const Scene scene = sceneOfCorners(panels(leaning, i == 2 ? 0x1p-20f : 0.0f));
      const SurfaceSettings settings{.part_triangles = 4096, .join_edges = i > 0};
      const ProvedPixels checked = drawAndProve(scene, frontView(), 40, 40, settings);
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
          const ProvedPixels checked =
              drawAndProve(sceneOfCorners(corners, double_sided), frontView(), 20, 20,
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
      appendQuad(strip, edge(i, -1.0f), edge(i, 1.0f), edge(i + 1, 1.0f), edge(i + 1, -1.0f));
    }
    appendQuad(folded, {-6, -5, -10}, {5, -5, -10}, {5, 5, -10}, {-6, 5, -10});
    appendQuad(folded, {5, -5, -10}, {5, 5, -10}, {-4, 4, -8}, {-4, -4, -8});
    appendQuad(folded, {-4, -4, -8}, {-4, 4, -8}, {6, 3, -6}, {6, -3, -6});
    for (const std::uint32_t size : {1u, 5u, 1024u}) {
      const SurfaceSettings settings{.cluster_triangles = size, .max_angle_deg = 180.0};
      EXPECT_TRUE(drawAndProve(sceneOfCorners(strip, double_sided), frontView(), 32, 32, settings).right());
      const ProvedPixels checked =
          drawAndProve(sceneOfCorners(folded, double_sided), frontView(), 32, 32, settings);
      EXPECT_TRUE(checked.right());
      EXPECT_GT(checked.covered, 50u);
    }
  }
}

TEST(SurfaceProbes, ABudgetThatRunsOutCoversLess) {
  const Scene scene = sheet(
      24, 40.0f, 12.0f, [](float x, float y) { return 3.0f * std::sin(x) * std::cos(0.7f * y); }, noTriangle);
  const SurfaceSettings settings{.part_triangles = 60};
  SurfaceDrawing drawing = kDrawAll;
  std::size_t last = 0;
  for (const std::uint32_t budget : {0u, 1u, 100u, 400u, 1000u, 1'000'000u}) {
    drawing.limits.budget = budget;
    const ProvedPixels checked = drawAndProve(scene, frontView(), 40, 40, settings, drawing);
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
  const Scene scene = sceneOfCorners(corners);
  raster.begin(frontView());
  const SurfaceSet surfaces = findSurfaces(scene.view());
  raster.draw(surfaces, surfaces.objects, kDrawAll);
  EXPECT_TRUE(provePixels(scene, frontView(), raster.depthBuffer(), 16).right());
}

TEST(SurfaceProbes, MapsOfManySizes) {
  const Scene scene = sheet(
      16, 30.0f, 10.0f, [](float x, float y) { return 2.0f * std::sin(x) * std::cos(y); },
      [](std::uint32_t t) { return t == 200; });
  for (const auto& [width, height] : {std::pair(1u, 1u), {1u, 64u}, {7u, 3u}, {1000u, 8u}, {4096u, 4096u}}) {
    Rasteriser raster({.width = width, .height = height});
    raster.begin(frontView());
    const SurfaceSet surfaces = findSurfaces(scene.view());
    raster.draw(surfaces, surfaces.objects, kDrawAll);
    const ProvedPixels checked =
        provePixels(scene, frontView(), raster.depthBuffer(), std::max(1u, width * height / 2000));
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
    appendQuad(corners, at(-half, -1e4), at(half, -1e4), at(half, 4.25 + rise), at(-half, 4.25 - rise));
    const ProvedPixels checked = drawAndProve(sceneOfCorners(corners), view, kWidth, kHeight);
    EXPECT_TRUE(checked.right()) << half;
    // The top edge lies within the fifth row of pixels, or begins to do so in the map's middle.
    EXPECT_GE(checked.covered, 4 * kWidth - 2);
    EXPECT_LE(checked.covered, 5 * kWidth);
  }
}

TEST(SurfaceProbes, HostileInputHidesNothing) {
  constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  std::vector<Vec3f> corners{
      {kNotANumber, 0, -10}, {1, 0, -10},           {0, 1, -10},          {-kInf, -5, -10}, {5, -5, -10},
      {0, kInf, -10},        {-3e38f, -3e38f, -10}, {3e38f, -3e38f, -10}, {0, 3e38f, -10},  {1, 1, -10},
      {1, 1, -10},           {2, 2, -10},           {0, 0, -10},          {1, 0, -10},      {2, 0, -10}};
  EXPECT_TRUE(drawAndProve(sceneOfCorners(corners), frontView(), 16, 16).right());
  EXPECT_EQ(findSurfaces(Scene().view()).parts.size(), 0u);
  Rasteriser raster({.width = 8, .height = 8});
  const Scene scene = sheet(
      4, 30.0f, 10.0f, [](float, float) { return 0.0f; }, noTriangle);
  const SurfaceSet surfaces = findSurfaces(scene.view());
  View view = frontView();
  view.eye.x = std::numeric_limits<double>::quiet_NaN();
  raster.begin(view);
  raster.draw(surfaces, surfaces.objects, kDrawAll);
  EXPECT_FALSE(raster.depthBuffer().covered(4, 4));
}

class RandomSurfaces : public testing::TestWithParam<bool> {};

TEST_P(RandomSurfaces, HideWhatTheyCover) {
  ProvedPixels all;
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
    const ProvedPixels checked =
        drawAndProve(scene, view, 1 + static_cast<std::uint32_t>(number(0.0, 40.0)), 24);
    EXPECT_EQ(checked.wrong + checked.undecided, 0u) << "seed " << seed;
    all.covered += checked.covered;
  }
  EXPECT_GT(all.covered, test::rounds(4000u));
}

INSTANTIATE_TEST_SUITE_P(Views, RandomSurfaces, testing::Bool(),
                         [](const auto& shown) { return shown.param ? "Orthographic" : "Perspective"; });

}  // namespace
}  // namespace sightline
