#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "tests/scenes/moving_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

std::vector<MovingScene> someScenes() {
  std::vector<MovingScene> scenes;
  scenes.push_back(makeToothpicks({.count = 12}));
  scenes.push_back(makeCanyon({.grid = 3}));
  return scenes;
}

TEST(MovingScene, PlacesObjectsWhereTheirPosesPutThem) {
  for (const MovingScene& scene : someScenes()) {
    std::vector<Mat4> first(scene.parts.size()), now(scene.parts.size()), placed;
    scene.pose(0, first);
    scene.pose(131, now);
    placements(scene, 131, placed);
    ASSERT_EQ(placed.size(), scene.scene.objects.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      for (const Vec3d& p : scene.hulls[scene.parts[i].hulls[0]].vertices) {
        const Vec3d moved = transformPoint(placed[i], transformPoint(first[i], p));
        EXPECT_LT(length(moved - transformPoint(now[i], p)), 1e-11) << scene.parts[i].name;
      }
    }
  }
}

TEST(MovingScene, PlacementsAreInSceneSpaceWhereverItsOriginIs) {
  MovingScene scene = makeToothpicks({.count = 5});
  std::vector<Mat4> in_world, in_scene;
  placements(scene, 77, in_world);
  const Vec3d origin(10.0, -20.0, 30.0);
  scene.scene.origin = origin;
  placements(scene, 77, in_scene);
  for (std::size_t i = 0; i < in_world.size(); ++i) {
    const Vec3d p(0.25, 0.5, 0.75);  // in the scene
    const Vec3d world = transformPoint(in_world[i], p + origin);
    EXPECT_LT(length(transformPoint(in_scene[i], p) + origin - world), 1e-12) << i;
  }
}

TEST(MovingScene, WhatHasNotMovedIsPlacedByTheIdentityToTheLastBit) {
  const Mat4 identity;
  for (MovingScene& scene : someScenes()) {
    std::vector<Mat4> placed;
    placements(scene, 0, placed);
    for (const Mat4& m : placed) {
      EXPECT_EQ(m.m, identity.m);
    }
    placements(scene, 200, placed);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      moved += placed[i].m == identity.m ? 0 : 1;
      EXPECT_TRUE(!scene.parts[i].settings.is_static || placed[i].m == identity.m) << scene.parts[i].name;
    }
    EXPECT_GE(moved, 12u);
    scene.pose = nullptr;
    placements(scene, 200, placed);
    ASSERT_EQ(placed.size(), scene.scene.objects.size());
    for (const Mat4& m : placed) {
      EXPECT_EQ(m.m, identity.m);
    }
  }
}

// Corner positions, in the order of the indices.
std::vector<Vec3f> corners(const Scene& scene) {
  std::vector<Vec3f> all;
  for (const std::uint32_t index : scene.indices) {
    all.push_back(scene.positions[index]);
  }
  return all;
}

TEST(MovingScene, PosedSceneHasEveryCornerWhereItIsInThatFrame) {
  for (const MovingScene& scene : someScenes()) {
    Scene posed;
    posedScene(scene, 0, posed);
    EXPECT_EQ(corners(posed), corners(scene.scene));
    posedScene(scene, 90, posed);
    std::vector<Mat4> first(scene.parts.size()), now(scene.parts.size());
    scene.pose(0, first);
    scene.pose(90, now);
    ASSERT_EQ(posed.objects.size(), scene.scene.objects.size());
    ASSERT_EQ(posed.indices.size(), scene.scene.indices.size());
    for (std::size_t i = 0; i < posed.objects.size(); ++i) {
      const Object& object = posed.objects[i];
      EXPECT_EQ(object.first_index, scene.scene.objects[i].first_index);
      EXPECT_EQ(object.material, scene.scene.objects[i].material);
      Box bounds;
      for (std::uint32_t k = object.first_index; k < object.first_index + object.index_count; ++k) {
        const Vec3f& at = posed.positions[posed.indices[k]];
        const Vec3d local = partFromWorld(first[i], Vec3d(scene.scene.positions[scene.scene.indices[k]]));
        const Vec3d expected = transformPoint(now[i], local);
        EXPECT_LE(length(Vec3d(at) - expected), 1e-6 * (1.0 + length(expected))) << scene.parts[i].name;
        bounds.extend(at);
      }
      EXPECT_EQ(object.bounds, bounds);
    }
  }
}

TEST(MovingScene, ObjectsOfAPosedSceneShareNoPositionAndUseAll) {
  for (const MovingScene& scene : someScenes()) {
    Scene posed;
    posedScene(scene, 33, posed);
    std::map<std::uint32_t, std::size_t> user_of;
    for (std::size_t i = 0; i < posed.objects.size(); ++i) {
      for (const std::uint32_t index : posed.view().indicesOf(posed.objects[i])) {
        EXPECT_EQ(user_of.try_emplace(index, i).first->second, i);
      }
    }
    EXPECT_EQ(user_of.size(), posed.positions.size());
    EXPECT_EQ(user_of.rbegin()->first + 1, posed.positions.size());
  }
}

// Objects share indices when they are instances of one mesh.
TEST(MovingScene, ObjectsThatShareTheirIndicesGoEachWhereItIs) {
  MovingScene scene = makeToothpicks({.count = 2});
  std::vector<Object>& objects = scene.scene.objects;
  objects[1].first_index = objects[0].first_index;
  objects[1].index_count = objects[0].index_count;
  std::vector<Mat4> placed;
  placements(scene, 60, placed);
  Scene posed;
  posedScene(scene, 60, posed);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::span<const std::uint32_t> stored = scene.scene.view().indicesOf(objects[i]),
                                         now = posed.view().indicesOf(posed.objects[i]);
    ASSERT_EQ(now.size(), stored.size());
    for (std::size_t k = 0; k < now.size(); ++k) {
      EXPECT_EQ(posed.positions[now[k]],
                Vec3f(transformPoint(placed[i], Vec3d(scene.scene.positions[stored[k]]))));
    }
  }
}

}  // namespace
}  // namespace sightline
