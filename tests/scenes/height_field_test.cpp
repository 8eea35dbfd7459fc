#include "scenes/height_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/noise.h"
#include "scenes/random.h"
#include "tests/scenes/scene_checks.h"

namespace sightline::scenes {
namespace {

using namespace scene_checks;

constexpr Rectangle kArea{{-30.0, 10.0}, {50.0, 90.0}};

HeightField rough(std::uint32_t quads, std::uint64_t seed) {
  return {kArea, quads, [&](Point2 p) { return 20.0 * fractalNoise(p / 15.0, 3, seed); }};
}

Scene drawn(const HeightField& field, std::uint32_t tiles) {
  Scene scene;
  scene.materials.resize(1);
  {
    MeshBuilder mesh(scene);
    field.addTiles(mesh, tiles, "tile", [](Point2) { return MaterialId{0u}; });
  }
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

TEST(HeightField, HeightsAreThoseOfTheTriangles) {
  const HeightField field = rough(17, 3);
  const Scene scene = drawn(field, 4);
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const double x = random.range(kArea.min.x + 0.01, kArea.max.x - 0.01);
    const double y = random.range(kArea.min.y + 0.01, kArea.max.y - 0.01);
    EXPECT_NEAR(heightOf(scene, "tile ", worldFromPlan({x, y, 0.0})), field.height({x, y}), 1e-4);
  }
}

TEST(HeightField, OutsideOfTheAreaTheHeightIsThatOfTheBorder) {
  const HeightField field = rough(9, 4);
  EXPECT_EQ(field.height({-100.0, 40.0}), field.height({-30.0, 40.0}));
  EXPECT_EQ(field.height({70.0, 400.0}), field.height({50.0, 90.0}));
}

TEST(HeightField, TilesAreOneSheetEvenIfTheyDiffer) {
  for (const std::uint32_t quads : {8u, 13u, 30u}) {
    const Scene scene = drawn(rough(quads, 5), 4);
    const NamedCounts tiles = countNamed(scene, "tile ");
    EXPECT_EQ(tiles.objects, 16u);
    EXPECT_EQ(tiles.triangles, 2 * quads * quads);
    const SheetCounts sheet = countSheet(scene, "tile ");
    EXPECT_EQ(sheet.open_edges, 4 * quads);
    EXPECT_EQ(sheet.pieces, 1u);
  }
}

TEST(HeightField, SlopeIsTheRisePerMetre) {
  const HeightField field(kArea, 40, [](Point2 p) { return 0.3 * p.x - 0.4 * p.y; });
  EXPECT_NEAR(field.slope({10.0, 50.0}), 0.5, 1e-9);
  EXPECT_NEAR(field.lowest({10.0, 50.0}, 4.0), field.height({10.0, 50.0}) - 2.0, 0.1);
  EXPECT_NEAR(field.highest({10.0, 50.0}, 4.0), field.height({10.0, 50.0}) + 2.0, 0.1);
}

TEST(HeightField, ALineOverGroundKeepsItsHeight) {
  const HeightField field = rough(30, 6);
  const Vec3d line[] = {{-20, 20, 7}, {40, 30, 0}, {10, 80, -5}};
  const std::vector<Vec3d> over = overGround(field, line, 1.7);
  for (std::size_t i = 0; i < over.size(); ++i) {
    EXPECT_NEAR(over[i].z - field.height({over[i].x, over[i].y}), 1.7, 1e-9);
    const Vec3d step = over[i] - over[i > 0 ? i - 1 : 0];
    EXPECT_LE(length(Point2{step.x, step.y}), 0.5 + 1e-9);
  }
  EXPECT_EQ(over.front().x, -20.0);
  EXPECT_EQ(over.back().y, 80.0);
}

TEST(Noise, IsSmoothAndZeroAtWholeCoordinates) {
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.range(-50, 50), y = random.range(-50, 50), z = random.range(-50, 50);
    const Vec3d p(x, y, z), q(x + 1e-4, y, z);
    EXPECT_LT(std::abs(noise(p, 3)), 1.5);
    EXPECT_LT(std::abs(noise(p, 3) - noise(q, 3)), 1e-3);
    EXPECT_LT(std::abs(noise(Point2{x, y}, 3) - noise(Point2{x, y + 1e-4}, 3)), 1e-3);
    EXPECT_EQ(noise(Vec3d(std::floor(x), std::floor(y), std::floor(z)), 3), 0.0);
    const double ridge = ridgedNoise({x, y}, 4, 3);
    EXPECT_GE(ridge, 0.0);
    EXPECT_LE(ridge, 1.0);
  }
}

}  // namespace
}  // namespace sightline::scenes
