// Tests scenes whose large meshes are cut into overlapping pieces.

#include "scenes/split_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using hand_made::addMaterial;
using hand_made::addWall;

double areaOf(const Scene& scene, const Object& object) {
  double area = 0.0;
  const std::span<const std::uint32_t> indices = scene.view().indicesOf(object);
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const Vec3d a(scene.positions[indices[i]]), b(scene.positions[indices[i + 1]]),
        c(scene.positions[indices[i + 2]]);
    area += 0.5 * length(cross(b - a, c - a));
  }
  return area;
}

TEST(SplitScene, CutsWhatIsWiderThanACellIntoOverlappingPieces) {
  Scene scene;
  const MaterialId stone = addMaterial(scene, Opacity::kOpaque, true),
                   glass = addMaterial(scene, Opacity::kBlended, true);
  addWall(scene, stone, -1.0f, 0.0f, 0.5f, 0.0f, 0.5f);  // fits into a cell
  addWall(scene, stone, -2.0f, 0.0f, 4.0f, 0.0f, 1.0f);
  addWall(scene, glass, -3.0f, 0.0f, 4.0f, 0.0f, 1.0f);
  const SplitScene split = splitScene(scene, 1.0, 0.25);
  const Scene& cut = split.scene;
  ASSERT_EQ(cut.objects.size(), 6u);
  EXPECT_EQ(cut.object_names[0], "object 0");
  EXPECT_EQ(cut.object_names[1], "object 1, cell 0");
  EXPECT_EQ(cut.object_names[5], "object 2");
  for (const std::size_t whole : {std::size_t{0}, std::size_t{5}}) {
    EXPECT_EQ(cut.objects[whole].bounds, scene.objects[whole == 0 ? 0 : 2].bounds);
  }
  for (std::uint32_t cell = 0; cell < 4; ++cell) {
    const Object& piece = cut.objects[1 + cell];
    const auto left = static_cast<float>(cell);
    EXPECT_EQ(piece.material, stone);
    EXPECT_FLOAT_EQ(piece.bounds.min.x, cell == 0 ? 0.0f : left - 0.125f);
    EXPECT_FLOAT_EQ(piece.bounds.max.x, cell == 3 ? 4.0f : left + 1.125f);
    EXPECT_NEAR(areaOf(cut, piece), cell % 3 == 0 ? 1.125 : 1.25, 1e-6);
  }
  // Neighbours alone touch, and the plane between them lies between their cells.
  ASSERT_EQ(split.planes.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Plane& plane = split.planes[i].rule.plane;
    EXPECT_EQ(split.planes[i].first, 1 + i);
    EXPECT_EQ(split.planes[i].second, 2 + i);
    EXPECT_NEAR(plane.evaluate({i + 1.0, 0.5, -2.0}), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(plane.normal.x), 1.0, 1e-12);
  }
}

TEST(SplitScene, AnObjectThatWouldHaveTooManyCellsHasWiderOnes) {
  Scene scene;
  addWall(scene, addMaterial(scene, Opacity::kOpaque, true), 0.0f, 0.0f, 100.0f, 0.0f, 100.0f);
  EXPECT_EQ(splitScene(scene, 100.0 / 32.0, 0.0).scene.objects.size(), 1024u);
  EXPECT_EQ(splitScene(scene, 100.0 / 64.0, 0.0).scene.objects.size(), 1024u);
  const std::size_t pieces = splitScene(scene, 1e-30, 0.0).scene.objects.size();
  EXPECT_GT(pieces, 200u);
  EXPECT_LE(pieces, 1024u);
}

}  // namespace
}  // namespace sightline
