#include "scenes/boiler_house.h"

#include <gtest/gtest.h>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

TEST(BoilerHouse, IsInOrder) {
  for (const BoilerHouseOptions& options :
       {BoilerHouseOptions{}, BoilerHouseOptions{.boilers = 1, .pipes = 50, .seed = 2}}) {
    const Scene scene = makeBoilerHouse(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_EQ(degenerateShare(scene), 0.0);
  }
}

TEST(BoilerHouse, ConsistsOfClosedSolidsPanesAndGratings) {
  const Scene scene = makeBoilerHouse({});
  std::size_t solids = 0, panes = 0, gratings = 0;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Material& material = scene.materials[scene.objects[o].material.value];
    if (material.opacity == Opacity::kOpaque) {
      ++solids;
      EXPECT_TRUE(isClosed(scene, scene.objects[o])) << scene.object_names[o];
      EXPECT_GT(volumeOf(scene, scene.objects[o]), 0.0) << scene.object_names[o];
    }
    panes += material.opacity == Opacity::kBlended ? 1 : 0;
    gratings += material.opacity == Opacity::kAlphaTested ? 1 : 0;
  }
  EXPECT_GT(solids, 3000u);
  EXPECT_GT(panes, 100u);
  EXPECT_GT(gratings, 30u);
}

TEST(BoilerHouse, TheWalkTouchesNothing) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = makeBoilerHouse({.seed = seed});
    EXPECT_EQ(
        whatIsWrongWithWalk(
            scene, {.clearance = 0.3, .ground = "", .most_height = 3.0, .turn_cosine = 0.9, .step = 1.5}),
        "")
        << "seed " << seed;
  }
}

TEST(BoilerHouse, IsADemoSceneThatDependsOnItsSeed) {
  const Result<Scene> scene = makeDemoScene("demo:boilerhouse?boilers=2&pipes=99&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeBoilerHouse({.boilers = 2, .pipes = 99, .seed = 9})));
  EXPECT_NE(hashOf(*scene), hashOf(makeBoilerHouse({.boilers = 2, .pipes = 99, .seed = 8})));
  EXPECT_FALSE(makeDemoScene("demo:boilerhouse?boilers=0"));
}

}  // namespace
}  // namespace sightline
