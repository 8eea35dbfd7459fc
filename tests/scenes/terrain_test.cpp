#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

TEST(Terrain, IsInOrder) {
  for (const TerrainOptions& options :
       {TerrainOptions{}, TerrainOptions{.triangles = 10000, .seed = 2}, TerrainOptions{.seed = 77}}) {
    const Scene scene = makeTerrain(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_EQ(degenerateShare(scene), 0.0) << "seed " << options.seed;
    EXPECT_GE(scene.objects.size(), 1000u);
    EXPECT_LE(scene.objects.size(), 8000u);
  }
}

TEST(Terrain, TheGroundHasAboutAsManyTrianglesAsAskedForAndNothingElseChanges) {
  const auto others = static_cast<double>(makeTerrain({}).objects.size());
  for (const std::uint32_t triangles : {10000u, 20000u, 300000u}) {
    const Scene scene = makeTerrain({.triangles = triangles});
    const NamedCounts ground = countNamed(scene, "ground ");
    EXPECT_NEAR(static_cast<double>(ground.triangles), triangles, 0.02 * triangles);
    EXPECT_EQ(ground.objects, 256u);
    EXPECT_NEAR(static_cast<double>(scene.objects.size()), others, 0.1 * others);
  }
}

TEST(Terrain, TheTilesAreOneSheetWithoutGaps) {
  const Scene scene = makeTerrain({.triangles = 30000});
  const SheetCounts ground = countSheet(scene, "ground ");
  const std::uint64_t triangles = countNamed(scene, "ground ").triangles;
  const auto quads_per_side =
      static_cast<std::uint64_t>(std::lround(std::sqrt(static_cast<double>(triangles / 2))));
  EXPECT_EQ(ground.open_edges, 4 * quads_per_side);
  EXPECT_EQ(ground.pieces, 1u);
}

TEST(Terrain, EverythingButGroundAndLeavesIsASolidWithItsFrontsOutside) {
  const Scene scene = makeTerrain({.triangles = 10000});
  const SolidCounts solids = countSolids(scene);
  const std::size_t leaves = countSeeThrough(scene);
  EXPECT_GT(leaves, 50u);
  EXPECT_EQ(solids.closed, scene.objects.size() - leaves - 256);
  EXPECT_EQ(solids.inside_out, 0u);
}

TEST(Terrain, TheWalkTouchesNothing) {
  for (const std::uint32_t triangles : {10000u, 100000u}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const Scene scene = makeTerrain({.triangles = triangles, .seed = seed});
      EXPECT_EQ(
          whatIsWrongWithWalk(
              scene,
              {.clearance = 0.5, .ground = "ground ", .most_height = 1.9, .turn_cosine = 0.97, .step = 2.5}),
          "")
          << triangles << " triangles, seed " << seed;
    }
  }
}

TEST(Terrain, TheSameOptionsGiveTheSameBitsEverywhereAndAnotherSeedOthers) {
  const TerrainOptions options{.triangles = 12000};
  EXPECT_EQ(hashOf(makeTerrain(options)), hashOf(makeTerrain(options)));
  EXPECT_NE(hashOf(makeTerrain(options)), hashOf(makeTerrain({.triangles = 12000, .seed = 2})));
  EXPECT_EQ(hashOf(makeTerrain(options)), 7508150224099888364ull);
}

TEST(Terrain, IsADemoScene) {
  const Result<Scene> scene = makeDemoScene("demo:terrain?triangles=10000&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeTerrain({.triangles = 10000, .seed = 9})));
  EXPECT_FALSE(makeDemoScene("demo:terrain?triangles=9999"));
  EXPECT_FALSE(makeDemoScene("demo:terrain?triangles=10000001"));
}

}  // namespace
}  // namespace sightline
