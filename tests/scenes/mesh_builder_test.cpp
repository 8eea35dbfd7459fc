#include "scenes/mesh_builder.h"

#include <gtest/gtest.h>

#include <array>

#include "scenes/random.h"
#include "tests/scenes/scene_checks.h"

namespace sightline::scenes {
namespace {

const std::vector<Point2> kL = {{0, 0}, {5, 0}, {5, 2}, {2, 2}, {2, 6}, {0, 6}};  // area 18

// Builds one object with `make`, at a placement turned by an odd angle.
template <typename Make>
Scene sceneOf(Make make) {
  Scene scene;
  scene.materials.emplace_back();
  {
    MeshBuilder mesh(scene);
    mesh.place(Placement{}.moved({3.3, -2.1, 0.7}).turned(0.137));
    mesh.startObject("made", MaterialId{0u});
    make(mesh);
  }
  weldPositions(scene);
  updateBounds(scene);
  return scene;
}

template <typename Make>
void expectSolid(double volume, Make make) {
  const Scene scene = sceneOf(make);
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_TRUE(scene_checks::isClosed(scene, scene.objects[0]));
  EXPECT_NEAR(scene_checks::volumeOf(scene, scene.objects[0]), volume, 1e-4);
  EXPECT_EQ(scene_checks::whatIsWrong(scene), "");
}

TEST(MeshBuilder, ABoxIsClosedAndOutward) {
  expectSolid(6.0, [](MeshBuilder& mesh) { mesh.box({0, 0, 0}, {1, 2, 3}); });
}

TEST(MeshBuilder, APrismOverAnLIsClosedAndOutward) {
  expectSolid(18.0 * 2.0, [](MeshBuilder& mesh) { mesh.prism(kL, 1.0, 3.0); });
}

TEST(MeshBuilder, ARingIsClosedAndOutward) {
  // The L moved outwards by one: 7 by 8 without a notch of 3 by 4.
  expectSolid(44.0 - 18.0, [](MeshBuilder& mesh) { mesh.ring(outset(kL, 1.0), kL, 0.0, 1.0); });
}

TEST(MeshBuilder, ALatheIsClosedAndOutward) {
  const Scene scene = sceneOf([](MeshBuilder& mesh) {
    mesh.lathe(std::array<Point2, 4>{{{0, 0}, {2, 0}, {1, 3}, {0, 4}}}, 9);
  });
  EXPECT_TRUE(scene_checks::isClosed(scene, scene.objects[0]));
  EXPECT_GT(scene_checks::volumeOf(scene, scene.objects[0]), 15.0);
  EXPECT_EQ(scene.triangleCount(), 9u * 4u);
}

TEST(MeshBuilder, ATubeIsClosedAndOutward) {
  // A column of 2 by 2 and 3 high, and a frustum of a pyramid of 2 by 2 and 4 by 4 at its ends, 1 high.
  const auto ring = [](double half, double z) {
    return std::array<Vec3d, 4>{{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}};
  };
  std::vector<Vec3d> points;
  for (const auto& corners : {ring(1.0, 0.0), ring(1.0, 3.0), ring(2.0, 4.0)}) {
    points.insert(points.end(), corners.begin(), corners.end());
  }
  expectSolid(12.0 + 28.0 / 3.0, [&](MeshBuilder& mesh) { mesh.tube(points, 4); });
}

TEST(MeshBuilder, AMeshHasTheTrianglesThatAreGiven) {
  const std::array<Vec3d, 4> points{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
  const std::array<std::uint32_t, 12> indices{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  expectSolid(1.0, [&](MeshBuilder& mesh) { mesh.mesh(points, indices); });
}

TEST(MeshBuilder, APlateWithOpeningsIsClosedAndOutwardAndConforming) {
  const std::vector<Rectangle> openings = {{{1, 0}, {2, 2}}, {{3, 1}, {4, 2}}, {{6, 0.5}, {7.5, 2.5}}};
  expectSolid((10.0 * 3.0 - 2.0 - 1.0 - 3.0) * 0.25, [&](MeshBuilder& mesh) {
    mesh.plate({{0, 0}, {10, 3}}, 0.0, 0.25, openings);
  });
}

TEST(MeshBuilder, ARidgeRoofIsClosedAndOutwardEitherWayAround) {
  const double volume = 0.5 * 4.0 * 2.0 * 10.0;
  expectSolid(volume, [](MeshBuilder& mesh) { mesh.ridgeRoof({{0, 0}, {10, 4}}, 1.0, 2.0, 0.0); });
  expectSolid(volume, [](MeshBuilder& mesh) { mesh.ridgeRoof({{0, 0}, {4, 10}}, 1.0, 2.0, 0.0); });
}

TEST(MeshBuilder, AnObjectWithoutTrianglesIsLeftOut) {
  const Scene scene = sceneOf([](MeshBuilder& mesh) {
    mesh.startObject("empty", MaterialId{0u});
    mesh.startObject("box", MaterialId{0u});
    mesh.box({0, 0, 0}, {1, 1, 1});
  });
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.object_names[0], "box");
}

TEST(Placement, UnitVectorsAreExactAtQuartersAndOfUnitLengthBetween) {
  EXPECT_EQ(unitVector(0.0), (Point2{1, 0}));
  EXPECT_EQ(unitVector(0.25).y, 1.0);
  EXPECT_EQ(unitVector(-0.5).x, -1.0);
  for (int i = -40; i < 40; ++i) {
    EXPECT_NEAR(length(unitVector(i * 0.0371)), 1.0, 1e-15);
  }
  EXPECT_NEAR(unitVector(0.125).x, std::sqrt(0.5), 1e-15);
}

TEST(Placement, AWallsFrameLooksOutOfAnAnticlockwiseFigure) {
  const Placement wall = Placement{}.onWall({0, 0}, {4, 0}, 1.0);
  EXPECT_EQ(wall.point({1, 2, 3}), Vec3d(1, -3, 3));
}

TEST(Random, NumbersAreThoseOfSplitMix64) {
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317ull);
  EXPECT_EQ(random.next(), 3203168211198807973ull);
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform();
    EXPECT_TRUE(u >= 0.0 && u < 1.0);
    EXPECT_LT(random.below(7), 7u);
  }
}

}  // namespace
}  // namespace sightline::scenes
