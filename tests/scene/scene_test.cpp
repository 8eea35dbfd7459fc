#include "sightline/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace sightline {
namespace {

Object objectOf(std::uint32_t first_index, std::uint32_t index_count) {
  Object object;
  object.first_index = first_index;
  object.index_count = index_count;
  object.material = MaterialId(0u);
  return object;
}

std::vector<Vec3f> cornersOf(const Scene& scene) {
  std::vector<Vec3f> corners;
  for (const std::uint32_t index : scene.indices) {
    corners.push_back(scene.positions[index]);
  }
  return corners;
}

TEST(WeldPositions, StoresEqualPositionsOnceInOrderOfFirstUse) {
  Scene scene;
  scene.positions = {{9, 9, 9}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  scene.indices = {4, 2, 1, 3, 5, 4};
  weldPositions(scene);
  EXPECT_EQ(scene.positions, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}))
      << "the unused one is dropped";
  EXPECT_EQ(scene.indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 0}));
}

TEST(WeldPositions, TakesMinusZeroForZero) {
  Scene scene;
  scene.positions = {{0.0f, -0.0f, 1}, {-0.0f, 0.0f, 1}, {-0.0f, -0.0f, 1}};
  scene.indices = {0, 1, 2};
  weldPositions(scene);
  ASSERT_EQ(scene.positions.size(), 1u);
  EXPECT_FALSE(std::signbit(scene.positions[0].x));
  EXPECT_FALSE(std::signbit(scene.positions[0].y));
}

TEST(WeldPositions, KeepsPositionsApartThatDifferInTheLastBit) {
  const float next = std::nextafter(1.0f, 2.0f);
  const float tiny = std::numeric_limits<float>::denorm_min();
  Scene scene;
  scene.positions = {{1, 0, 0}, {next, 0, 0}, {1, tiny, 0}};
  scene.indices = {0, 1, 2};
  weldPositions(scene);
  EXPECT_EQ(scene.positions.size(), 3u);
}

TEST(WeldPositions, ChangesNoCorner) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    Scene scene;
    for (int i = 0; i < 300; ++i) {
      // Few distinct coordinates, so that many positions are equal.
      scene.positions.emplace_back(static_cast<float>(random() % 4), static_cast<float>(random() % 4),
                                   static_cast<float>(random() % 4));
      scene.indices.push_back(static_cast<std::uint32_t>(random() % 300));
    }
    for (std::uint32_t& index : scene.indices) {
      index %= static_cast<std::uint32_t>(scene.positions.size());
    }
    const std::vector<Vec3f> before = cornersOf(scene);
    weldPositions(scene);
    EXPECT_EQ(cornersOf(scene), before) << "seed " << seed;
    EXPECT_LE(scene.positions.size(), 64u) << "seed " << seed;
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
      for (std::size_t j = i + 1; j < scene.positions.size(); ++j) {
        EXPECT_FALSE(scene.positions[i] == scene.positions[j]) << "seed " << seed;
      }
    }
  }
}

TEST(WeldPositions, AcceptsAnEmptyScene) {
  Scene scene;
  weldPositions(scene);
  scene.positions = {{1, 2, 3}};
  weldPositions(scene);
  EXPECT_TRUE(scene.positions.empty());
}

TEST(UpdateBounds, AreThoseOfTheUsedVerticesOnly) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 2, 3}, {-1, 5, 0}, {100, 100, 100}, {7, 8, 9}};
  scene.indices = {0, 1, 2, 4, 4, 4};
  scene.objects = {objectOf(0, 3), objectOf(3, 3), objectOf(6, 0)};
  scene.objects[0].bounds = Box{{-1000, 0, 0}, {1000, 0, 0}};
  updateBounds(scene);
  EXPECT_EQ(scene.objects[0].bounds, (Box{{-1, 0, 0}, {1, 5, 3}}));
  EXPECT_EQ(scene.objects[1].bounds, (Box{{7, 8, 9}, {7, 8, 9}}));
  EXPECT_TRUE(scene.objects[2].bounds.empty());
  EXPECT_EQ(sceneBounds(scene.view()), (Box{{-1, 0, 0}, {7, 8, 9}}));
}

TEST(UpdateBounds, AreEmptyWhereAVertexIsNotFinite) {
  for (const float odd : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {odd, 5, 0}};
    scene.indices = {0, 1, 2};
    scene.objects = {objectOf(0, 3)};
    updateBounds(scene);
    EXPECT_TRUE(scene.objects[0].bounds.empty()) << "it is never culled";
  }
}

TEST(SceneBounds, AreThoseOfTheFiniteBoxes) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.objects.resize(3);
  scene.objects[0].bounds = {{-kInfinite, 0, 0}, {kInfinite, 1, 1}};
  scene.objects[1].bounds = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(sceneBounds(scene.view()), (Box{{1, 2, 3}, {4, 5, 6}}));
}

TEST(SceneBounds, AreEmptyWithoutTriangles) {
  EXPECT_TRUE(sceneBounds(Scene{}.view()).empty());
}

TEST(SceneView, GivesAnObjectsIndicesAndMaterial) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2, 2, 1, 0};
  scene.objects = {objectOf(0, 3), objectOf(3, 3)};
  scene.materials = {Material{}, Material{}};
  scene.objects[1].material = MaterialId(1u);
  const SceneView view = scene.view();
  const auto indices = view.indicesOf(view.objects[1]);
  EXPECT_EQ(std::vector<std::uint32_t>(indices.begin(), indices.end()),
            (std::vector<std::uint32_t>{2, 1, 0}));
  EXPECT_EQ(&view.materialOf(view.objects[1]), &scene.materials[1]);
  EXPECT_EQ(scene.triangleCount(), 2u);
}

}  // namespace
}  // namespace sightline
