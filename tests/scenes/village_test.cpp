#include <gtest/gtest.h>

#include <set>
#include <string>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

std::size_t housesIn(const Scene& scene) {
  return namesThatEndWith(scene, " walls").size() - 1;  // the church has walls too
}

TEST(Village, IsInOrder) {
  for (const VillageOptions& options : {VillageOptions{}, VillageOptions{.houses = 1, .seed = 2},
                                        VillageOptions{.houses = 1000, .seed = 77}}) {
    const Scene scene = makeVillage(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_EQ(degenerateShare(scene), 0.0) << "seed " << options.seed;
  }
}

TEST(Village, HasAsManyHousesAsAskedForWhereThereIsRoom) {
  EXPECT_EQ(housesIn(makeVillage({.houses = 1})), 1u);
  EXPECT_EQ(housesIn(makeVillage({.houses = 30})), 30u);
  const std::size_t most = housesIn(makeVillage({.houses = 1000}));
  EXPECT_GT(most, 100u);
  EXPECT_LT(most, 1000u);
}

TEST(Village, TheDefaultOneHasThousandsOfObjects) {
  const Scene scene = makeVillage({});
  EXPECT_GE(scene.objects.size(), 2000u);
  EXPECT_LE(scene.objects.size(), 8000u);
  const std::set<std::string> names(scene.object_names.begin(), scene.object_names.end());
  EXPECT_EQ(names.size(), scene.object_names.size());
}

TEST(Village, EverythingButGroundAndLeavesIsASolidWithItsFrontsOutside) {
  const Scene scene = makeVillage({.seed = 3});
  EXPECT_EQ(countSheet(scene, "ground ").pieces, 1u);
  const std::size_t leaves = countSeeThrough(scene);
  const SolidCounts solids = countSolids(scene);
  EXPECT_EQ(solids.closed, scene.objects.size() - leaves - countNamed(scene, "ground ").objects);
  EXPECT_EQ(solids.inside_out, 0u);
}

// Their lowest corners are below the ground all around, and most of the walls are above it.
TEST(Village, HousesStandPartlyInTheGround) {
  const Scene scene = makeVillage({.houses = 60, .seed = 5});
  for (const std::size_t i : namesThatEndWith(scene, " walls")) {
    const Box& box = scene.objects[i].bounds;
    for (const std::uint32_t index : scene.view().indicesOf(scene.objects[i])) {
      const Vec3f& corner = scene.positions[index];
      // The corners of the foot.
      if (corner.y == box.min.y) {
        const double height = heightOf(scene, "ground ", Vec3d(corner));
        EXPECT_GT(height, corner.y) << scene.object_names[i];
        EXPECT_LT(height, box.max.y - 3.0) << scene.object_names[i];
      }
    }
  }
}

TEST(Village, WallsAndRoofsAreSeveralQuads) {
  const Scene scene = makeVillage({.houses = 20});
  for (const std::size_t i : namesThatEndWith(scene, " walls")) {
    EXPECT_GT(scene.objects[i].triangleCount(), 60u) << scene.object_names[i];
  }
  for (const std::size_t i : namesThatEndWith(scene, " roof")) {
    EXPECT_GT(scene.objects[i].triangleCount(), 30u) << scene.object_names[i];
  }
}

TEST(Village, TheWalkTouchesNothing) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    const Scene scene = makeVillage({.houses = 1000, .seed = seed});
    EXPECT_EQ(
        whatIsWrongWithWalk(
            scene,
            {.clearance = 0.3, .ground = "ground ", .most_height = 1.9, .turn_cosine = 0.97, .step = 1.5}),
        "")
        << "seed " << seed;
  }
}

TEST(Village, TheSameOptionsGiveTheSameBitsEverywhereAndAnotherSeedOthers) {
  const VillageOptions options{.houses = 20};
  EXPECT_EQ(hashOf(makeVillage(options)), hashOf(makeVillage(options)));
  EXPECT_NE(hashOf(makeVillage(options)), hashOf(makeVillage({.houses = 20, .seed = 2})));
  EXPECT_EQ(hashOf(makeVillage(options)), 16964607605489769577ull);
}

TEST(Village, IsADemoScene) {
  const Result<Scene> scene = makeDemoScene("demo:village?houses=12&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeVillage({.houses = 12, .seed = 9})));
  EXPECT_FALSE(makeDemoScene("demo:village?houses=0"));
}

}  // namespace
}  // namespace sightline
