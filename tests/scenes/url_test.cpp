#include <gtest/gtest.h>

#include <string>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

std::string errorOf(std::string_view url) {
  const Result<Scene> scene = makeDemoScene(url);
  return scene ? "" : scene.error().message;
}

void expectError(std::string_view url, std::initializer_list<const char*> parts) {
  const std::string message = errorOf(url);
  ASSERT_NE(message, "") << url;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  for (const char* part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
  }
}

TEST(DemoUrl, IsKnownByItsPrefix) {
  EXPECT_TRUE(isDemoUrl("demo:city"));
  EXPECT_TRUE(isDemoUrl("demo:nonsense"));
  EXPECT_FALSE(isDemoUrl("demo"));
  EXPECT_FALSE(isDemoUrl("city.glb"));
}

TEST(DemoUrl, GivesTheSceneOfItsOptions) {
  const Result<Scene> city = makeDemoScene("demo:city?copies=2&seed=7");
  ASSERT_TRUE(city);
  EXPECT_EQ(scene_checks::hashOf(*city), scene_checks::hashOf(makeCity({.copies = 2, .seed = 7})));
  const Result<Scene> building = makeDemoScene("demo:building?plants=3&seed=9&floors=1");
  ASSERT_TRUE(building);
  EXPECT_EQ(scene_checks::hashOf(*building),
            scene_checks::hashOf(makeBuilding({.floors = 1, .plants = 3, .seed = 9})));
  const Result<Scene> shut = makeDemoScene("demo:building?floors=1&doors=shut");
  ASSERT_TRUE(shut);
  EXPECT_EQ(scene_checks::hashOf(*shut),
            scene_checks::hashOf(makeBuilding({.floors = 1, .shut_doors = true})));
  EXPECT_NE(scene_checks::hashOf(*shut), scene_checks::hashOf(makeBuilding({.floors = 1})));
  const Result<Scene> boxes = makeDemoScene("demo:boxes?boxes=30&buildings=20&seed=3");
  ASSERT_TRUE(boxes);
  EXPECT_EQ(scene_checks::hashOf(*boxes),
            scene_checks::hashOf(makeBoxCity({.buildings = 20, .boxes = 30, .seed = 3})));
  EXPECT_EQ(errorOf("demo:building"), "");
  EXPECT_EQ(errorOf("demo:building?floors=1&seed=4294967295"), "");
}

TEST(DemoUrl, AnUnknownSceneIsAnErrorThatListsTheScenes) {
  expectError("demo:castle", {"castle", "city", "building", "boxes", "terrain", "cave", "village", "jungle",
                              "voxels", "boilerhouse"});
  expectError("demo:", {"city", "building"});
  expectError("city", {"demo:"});
}

TEST(DemoUrl, AnUnknownKeyIsAnErrorThatListsTheKeys) {
  expectError("demo:city?plants=3", {"plants", "copies", "seed"});
  expectError("demo:building?copies=3", {"copies", "floors", "plants", "seed"});
  expectError("demo:boxes?floors=3", {"floors", "buildings", "boxes", "quarters", "open or walled", "seed"});
  expectError("demo:boxes?quarters=3", {"quarters", "open or walled"});
  expectError("demo:city?copies", {"key=number", "copies"});
}

TEST(DemoUrl, ABadOrOutOfRangeNumberIsAnErrorWithTheRange) {
  for (const char* url : {"demo:city?copies=0", "demo:city?copies=2001", "demo:city?copies=-1",
                          "demo:city?copies=", "demo:city?copies=3x", "demo:city?copies= 3",
                          "demo:city?copies=99999999999999999999"}) {
    expectError(url, {"copies", "1 to 2000"});
  }
  expectError("demo:building?floors=21", {"floors", "1 to 20"});
  expectError("demo:building?plants=10001", {"plants", "0 to 10000"});
  expectError("demo:boxes?buildings=0", {"buildings", "1 to 100000"});
  expectError("demo:boxes?boxes=1000001", {"boxes", "0 to 1000000"});
  expectError("demo:city?seed=4294967296", {"seed", "0 to 4294967295"});
}

TEST(DemoUrl, AKeyGivenTwiceIsAnError) {
  expectError("demo:city?copies=1&copies=1", {"copies", "twice"});
}

}  // namespace
}  // namespace sightline
