#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

// The buttes themselves, without what grows on them.
std::vector<std::size_t> buttesIn(const Scene& scene) {
  std::vector<std::size_t> buttes;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.object_names[i];
    if (name.rfind("butte ", 0) == 0 && name.find(' ', 6) == std::string::npos) {
      buttes.push_back(i);
    }
  }
  return buttes;
}

TEST(Jungle, IsInOrder) {
  for (const JungleOptions& options : {JungleOptions{}, JungleOptions{.buttes = 0, .trees = 0, .seed = 2},
                                       JungleOptions{.buttes = 100, .trees = 4000, .seed = 77}}) {
    const Scene scene = makeJungle(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_LT(degenerateShare(scene), 0.0001) << "seed " << options.seed;
  }
}

TEST(Jungle, TheDefaultOneHasThousandsOfObjectsMostOfThemSeeThrough) {
  const Scene scene = makeJungle({});
  EXPECT_GE(scene.objects.size(), 3000u);
  EXPECT_LE(scene.objects.size(), 8000u);
  EXPECT_GT(countSeeThrough(scene), scene.objects.size() / 3);
}

TEST(Jungle, ButtesAndTreesAreAsManyAsAskedFor) {
  EXPECT_EQ(buttesIn(makeJungle({.buttes = 0})).size(), 0u);
  EXPECT_EQ(buttesIn(makeJungle({.buttes = 12})).size(), 12u);
  EXPECT_GT(buttesIn(makeJungle({})).size(), 30u);
  const std::size_t none = namesThatEndWith(makeJungle({.buttes = 5, .trees = 0}), " trunk").size();
  EXPECT_EQ(namesThatEndWith(makeJungle({.buttes = 5, .trees = 70}), " trunk").size(), none + 70);
}

TEST(Jungle, EachButteIsOneClosedPieceOfSmallTriangles) {
  const Scene scene = makeJungle({.seed = 3});
  for (const std::size_t i : buttesIn(scene)) {
    const Object& butte = scene.objects[i];
    EXPECT_TRUE(isClosed(scene, butte)) << scene.object_names[i];
    EXPECT_GT(volumeOf(scene, butte), 1000.0) << scene.object_names[i];
    EXPECT_EQ(countSheet(scene, scene.object_names[i], true).pieces, 1u);
    EXPECT_GT(butte.triangleCount(), 800u) << scene.object_names[i];
  }
}

TEST(Jungle, EverythingButGroundAndLeavesIsASolidWithItsFrontsOutside) {
  const Scene scene = makeJungle({.seed = 4});
  const std::size_t leaves = countSeeThrough(scene);
  const SolidCounts solids = countSolids(scene);
  EXPECT_EQ(solids.closed, scene.objects.size() - leaves - countNamed(scene, "ground ").objects);
  EXPECT_EQ(solids.inside_out, 0u);
}

TEST(Jungle, TheWalkTouchesNothing) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    const Scene scene = makeJungle({.buttes = 100, .trees = 3000, .seed = seed});
    EXPECT_EQ(
        whatIsWrongWithWalk(
            scene,
            {.clearance = 0.3, .ground = "ground ", .most_height = 1.9, .turn_cosine = 0.97, .step = 2.5}),
        "")
        << "seed " << seed;
  }
}

TEST(Jungle, TheSameOptionsGiveTheSameBitsEverywhereAndAnotherSeedOthers) {
  const JungleOptions options{.buttes = 5, .trees = 50};
  EXPECT_EQ(hashOf(makeJungle(options)), hashOf(makeJungle(options)));
  EXPECT_NE(hashOf(makeJungle(options)), hashOf(makeJungle({.buttes = 5, .trees = 50, .seed = 2})));
  EXPECT_EQ(hashOf(makeJungle(options)), 15115883986591291981ull);
}

TEST(Jungle, IsADemoScene) {
  const Result<Scene> scene = makeDemoScene("demo:jungle?buttes=4&trees=20&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeJungle({.buttes = 4, .trees = 20, .seed = 9})));
  EXPECT_FALSE(makeDemoScene("demo:jungle?buttes=101"));
}

}  // namespace
}  // namespace sightline
