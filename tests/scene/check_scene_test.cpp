#include "sightline/scene/check_scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/procedural.h"
#include "tests/support/not_finite.h"

namespace sightline {
namespace {

// Two objects of one and two triangles, with a material each. Position 5 belongs to none.
Scene soundScene() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 3}, {99, 99, 99}};
  scene.indices = {0, 1, 2, 1, 3, 2, 3, 4, 2};
  scene.materials = {{.name = "stone"}, {.name = "glass", .opacity = Opacity::kBlended}};
  scene.objects = {{.first_index = 0, .index_count = 3, .material = MaterialId(0u)},
                   {.first_index = 3, .index_count = 6, .material = MaterialId(1u)}};
  updateBounds(scene);
  return scene;
}

// The message; empty if nothing is wrong.
std::string checkedScene(const Scene& scene) {
  const Status status = checkScene(scene.view());
  return status ? "" : status.error().message;
}

TEST(CheckScene, AcceptsWhatKeepsTheRules) {
  EXPECT_EQ(checkedScene({}), "");
  EXPECT_EQ(checkedScene(soundScene()), "");
  const Result<Scene> city = makeDemoScene("demo:city");
  ASSERT_TRUE(city);
  EXPECT_EQ(checkedScene(*city), "");
}

TEST(CheckScene, AcceptsWiderBoundsAndObjectsWithoutTriangles) {
  Scene scene = soundScene();
  scene.objects[0].bounds.min.x = -1000.0f;
  scene.objects.push_back({.first_index = 9, .index_count = 0, .material = MaterialId(0u)});
  EXPECT_EQ(checkedScene(scene), "");
}

TEST(CheckScene, LeavesOutPositionsThatNoObjectHas) {
  Scene scene = soundScene();
  scene.positions[5].x = static_cast<float>(test::kNan);
  EXPECT_EQ(checkedScene(scene), "");
}

TEST(CheckScene, SaysWhichObjectBreaksWhichRule) {
  using Break = std::function<void(Scene&)>;
  const std::vector<std::pair<Break, std::string>> broken{
      {[](Scene& s) { s.indices[7] = 6; }, "object 1: indices[7] is 6, but the scene has 6 positions"},
      {[](Scene& s) { s.indices[0] = 0xffffffffu; },
       "object 0: indices[0] is 4294967295, but the scene has 6 positions"},
      {[](Scene& s) { s.objects[1].first_index = 6; },
       "object 1: first_index + index_count is 12, but the scene has 9 indices"},
      // In 32 bits the sum would be 2.
      {[](Scene& s) { s.objects[1].first_index = 0xfffffffcu; },
       "object 1: first_index + index_count is 4294967298, but the scene has 9 indices"},
      {[](Scene& s) { s.objects[0].index_count = 4; },
       "object 0: index_count is 4; it must be a multiple of 3"},
      {[](Scene& s) { s.objects[1].material = MaterialId(); },
       "object 1: it has no material; set Object::material"},
      {[](Scene& s) { s.objects[1].material = MaterialId(2u); },
       "object 1: its material is 2, but the scene has 2 materials"},
      {[](Scene& s) { s.objects[1].bounds.max.z = 2.5f; }, "object 1: its bounds do not hold position 4"},
      {[](Scene& s) { s.objects[0].bounds = {}; }, "object 0: its bounds do not hold position 0"},
      {[](Scene& s) { s.objects[0].bounds.min.y = static_cast<float>(test::kNan); },
       "object 0: its bounds do not hold position 0"},
      {[](Scene& s) { s.positions[1].y = static_cast<float>(test::kNan); },
       "object 0: position 1 is not finite"},
      {[](Scene& s) {
         s.positions[4].x = static_cast<float>(test::kInfinity);
         updateBounds(s);
       },
       "object 1: position 4 is not finite"}};
  for (const auto& [breakIt, message] : broken) {
    Scene scene = soundScene();
    breakIt(scene);
    EXPECT_EQ(checkedScene(scene).substr(0, message.size()), message);
  }
}

}  // namespace
}  // namespace sightline
