#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

bool isPlant(const std::string& name) {
  return name.compare(0, 6, "plant ") == 0;
}

TEST(Building, TheDefaultOneHasTheSizeThatIsPromised) {
  const Scene scene = makeBuilding({.plants = 100});
  EXPECT_GT(scene.objects.size(), 1500u);
  EXPECT_GT(scene.triangleCount(), 60000u);
  EXPECT_LT(scene.triangleCount(), 170000u);
  EXPECT_EQ(whatIsWrong(scene), "");
  EXPECT_LT(degenerateShare(scene), 0.0001);
  std::set<std::string> rooms;
  for (const std::string& name : scene.object_names) {
    if (name.compare(0, 12, "floor 1 room") == 0) {
      rooms.insert(name.substr(0, name.find(' ', 13)));
    }
  }
  EXPECT_GE(rooms.size(), 20u);
  EXPECT_LE(rooms.size(), 40u);
}

TEST(Building, PlantsAreDetailObjectsOf644TrianglesAndChangeNothingElse) {
  const Scene without = makeBuilding({.floors = 2}), with = makeBuilding({.floors = 2, .plants = 25});
  ASSERT_EQ(with.objects.size(), without.objects.size() + 25);
  for (std::size_t i = 0; i < with.objects.size(); ++i) {
    if (i < without.objects.size()) {
      EXPECT_EQ(with.object_names[i], without.object_names[i]);
      EXPECT_EQ(with.objects[i].bounds, without.objects[i].bounds);
    } else {
      EXPECT_TRUE(isPlant(with.object_names[i]));
      EXPECT_EQ(with.objects[i].triangleCount(), 644u);
      EXPECT_LT(maxComponent(with.objects[i].bounds.extent()), 1.4f);
    }
  }
}

TEST(Building, PlantsStandOnFloorsInsideTheBuilding) {
  const Scene scene = makeBuilding({.plants = 500});
  Box walls;
  std::set<float> heights;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.object_names[i].find("wall") != std::string::npos) {
      walls.extend(scene.objects[i].bounds);
    }
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (isPlant(scene.object_names[i])) {
      EXPECT_TRUE(contains(walls, scene.objects[i].bounds));
      heights.insert(scene.objects[i].bounds.min.y);
    }
  }
  EXPECT_EQ(heights, (std::set<float>{0.0f, 3.25f, 6.5f, 9.75f}));
}

TEST(Building, SolidsAreOutward) {
  const Scene scene = makeBuilding({});
  const SolidCounts counts = countSolids(scene);
  EXPECT_EQ(counts.inside_out, 0u);
  EXPECT_GT(counts.closed, scene.objects.size() / 2);
}

TEST(Building, WallsAndSlabsAreClosedSolids) {
  const Scene scene = makeBuilding({.floors = 3});
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.object_names[i];
    const bool structure = name.find(" wall ") != std::string::npos ||
                           name.find(" slab ") != std::string::npos ||
                           name.find("flight") != std::string::npos;
    if (structure && name.find("window") == std::string::npos && name.find("rail") == std::string::npos) {
      EXPECT_TRUE(isClosed(scene, scene.objects[i])) << name;
    }
  }
}

TEST(Building, TheWalkClimbsToTheNextFloor) {
  const Scene scene = makeBuilding({});
  ASSERT_EQ(scene.paths.size(), 1u);
  const CameraPath& path = scene.paths[0];
  EXPECT_EQ(path.name, "smooth");
  ASSERT_EQ(path.frames.size(), 400u);
  EXPECT_NEAR(path.frames.front().eye.y, 1.7, 1e-9);
  EXPECT_NEAR(path.frames.back().eye.y, 1.7 + 3.25, 1e-9);
  EXPECT_LT(longestStep(path), 0.4);
}

TEST(Building, TheWalkTurnsSmoothly) {
  for (const std::uint32_t floors : {1u, 4u}) {
    EXPECT_GT(smallestTurnCosine(makeBuilding({.floors = floors}).paths[0]), 0.96) << floors;  // 16 degrees
  }
}

TEST(Building, TheWalkTouchesNothing) {
  for (const std::uint32_t floors : {1u, 2u, 4u}) {
    for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u}) {
      const Scene scene = makeBuilding({.floors = floors, .plants = 300, .seed = seed});
      EXPECT_EQ(whatIsHit(scene, scene.paths[0], 0.16), "") << floors << " floors, seed " << seed;
    }
  }
}

TEST(Building, TheSameOptionsGiveTheSameBitsEverywhere) {
  const BuildingOptions options{.floors = 2, .plants = 10, .seed = 3};
  EXPECT_EQ(hashOf(makeBuilding(options)), hashOf(makeBuilding(options)));
  EXPECT_EQ(hashOf(makeBuilding(options)), 94273542374084554ull);
  EXPECT_EQ(hashOf(makeBuilding({.floors = 1, .seed = 4000000000u})), 12325457895473154713ull);
}

}  // namespace
}  // namespace sightline
