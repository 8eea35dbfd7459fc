#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace scene_checks;

TEST(Cave, IsInOrder) {
  for (const CaveOptions& options :
       {CaveOptions{}, CaveOptions{.halls = 4, .triangles = 10000, .seed = 2},
        CaveOptions{.halls = 50, .triangles = test::rounds(200000u), .seed = 77}}) {
    const Scene scene = makeCave(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_LT(degenerateShare(scene), 0.001) << "seed " << options.seed;
  }
}

TEST(Cave, TheDefaultOneHasManyThingsInManyPieces) {
  const Scene scene = makeCave({});
  const std::size_t rocks = countNamed(scene, "rock ").objects;
  EXPECT_GT(rocks, 100u);
  EXPECT_GE(scene.objects.size(), rocks + 800);
  EXPECT_LE(scene.objects.size(), 8000u);
}

TEST(Cave, TheRockHasAboutAsManyTrianglesAsAskedFor) {
  for (const std::uint32_t triangles : {10000u, 30000u, test::rounds(300000u)}) {
    const NamedCounts rock = countNamed(makeCave({.triangles = triangles}), "rock ");
    EXPECT_NEAR(static_cast<double>(rock.triangles), triangles, 0.2 * triangles);
  }
}

TEST(Cave, TheRockIsOneClosedSurface) {
  for (const CaveOptions& options :
       {CaveOptions{}, CaveOptions{.halls = 9, .triangles = 30000, .seed = 2},
        CaveOptions{.halls = 4, .triangles = test::rounds(400000u), .seed = 3}}) {
    const SheetCounts rock = countSheet(makeCave(options), "rock ");
    EXPECT_EQ(rock.open_edges, 0u) << "seed " << options.seed;
    EXPECT_EQ(rock.crowded_edges, 0u) << "seed " << options.seed;
    EXPECT_EQ(rock.pieces, 1u) << "seed " << options.seed;
  }
}

// The sum over the pieces, all relative to one point, is the volume of the rock's inside, which is empty.
TEST(Cave, TheRockIsSeenFromInside) {
  const Scene scene = makeCave({.halls = 6, .triangles = 20000});
  Object all = scene.objects.front();
  for (std::size_t i = 1; i < scene.objects.size() && scene.object_names[i].rfind("rock ", 0) == 0; ++i) {
    all.index_count += scene.objects[i].index_count;
  }
  EXPECT_TRUE(isClosed(scene, all));
  EXPECT_LT(volumeOf(scene, all), -1000.0);
}

TEST(Cave, EverythingButTheRockIsASolidWithItsFrontsOutside) {
  const Scene scene = makeCave({.seed = 4});
  std::size_t solids = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.object_names[i].rfind("rock ", 0) != 0) {
      EXPECT_TRUE(isClosed(scene, scene.objects[i])) << scene.object_names[i];
      EXPECT_GT(volumeOf(scene, scene.objects[i]), 0.0) << scene.object_names[i];
      ++solids;
    }
  }
  EXPECT_GT(solids, 500u);
}

TEST(Cave, TheWalkTouchesNothing) {
  for (const std::uint32_t triangles : {20000u, test::rounds(100000u)}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const Scene scene = makeCave({.triangles = triangles, .seed = seed});
      EXPECT_EQ(
          whatIsWrongWithWalk(
              scene,
              {.clearance = 0.3, .ground = "rock ", .most_height = 2.6, .turn_cosine = 0.9, .step = 1.5}),
          "")
          << triangles << " triangles, seed " << seed;
    }
  }
}

TEST(Cave, TheSameOptionsGiveTheSameBitsEverywhereAndAnotherSeedOthers) {
  const CaveOptions options{.halls = 5, .triangles = 12000};
  EXPECT_EQ(hashOf(makeCave(options)), hashOf(makeCave(options)));
  EXPECT_NE(hashOf(makeCave(options)), hashOf(makeCave({.halls = 5, .triangles = 12000, .seed = 2})));
  EXPECT_EQ(hashOf(makeCave(options)), 17799387010994816229ull);
}

TEST(Cave, IsADemoScene) {
  const Result<Scene> scene = makeDemoScene("demo:cave?halls=5&triangles=10000&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeCave({.halls = 5, .triangles = 10000, .seed = 9})));
  EXPECT_FALSE(makeDemoScene("demo:cave?halls=3"));
}

}  // namespace
}  // namespace sightline
