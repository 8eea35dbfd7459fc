#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

bool beginsWith(const std::string& name, const char* prefix) {
  return name.rfind(prefix, 0) == 0;
}

// Bounds of the objects whose names begin with the prefix.
std::vector<Box> boundsOf(const Scene& scene, const char* prefix) {
  std::vector<Box> bounds;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (beginsWith(scene.object_names[i], prefix)) {
      bounds.push_back(scene.objects[i].bounds);
    }
  }
  return bounds;
}

// True if the boxes share more than a face.
bool interpenetrate(const Box& a, const Box& b) {
  const Box common = intersection(a, b);
  return common.min.x < common.max.x && common.min.y < common.max.y && common.min.z < common.max.z;
}

TEST(BoxCity, HasAsManyBuildingsAndSmallBoxesAsAskedForAndAGround) {
  for (const auto& [buildings, boxes] : {std::pair{1u, 0u}, {1u, 5u}, {8u, 0u}, {9u, 7u}, {1003u, 5011u}}) {
    const Scene scene = makeBoxCity({.buildings = buildings, .boxes = boxes});
    EXPECT_EQ(boundsOf(scene, "building ").size(), buildings);
    EXPECT_EQ(boundsOf(scene, "box ").size(), boxes);
    EXPECT_EQ(scene.objects.size(), 1u + buildings + boxes);
    EXPECT_EQ(scene.triangleCount(), 2u + 12u * (buildings + boxes));
    EXPECT_EQ(whatIsWrong(scene), "");
    EXPECT_EQ(degenerateShare(scene), 0.0);
  }
}

TEST(BoxCity, EveryBoxIsClosedAndOutward) {
  const Scene scene = makeBoxCity({.buildings = 500, .boxes = 2500, .seed = 5});
  const SolidCounts counts = countSolids(scene);
  EXPECT_EQ(counts.closed, 3000u);
  EXPECT_EQ(counts.inside_out, 0u);
  for (const Object& object : scene.objects) {
    const Vec3d size(object.bounds.extent());
    const double volume = size.x * size.y * size.z;
    EXPECT_NEAR(volumeOf(scene, object), volume, 1e-4 * volume);
  }
}

TEST(BoxCity, BoxesStandOnTheGroundWithTheSizesThatAreDocumented) {
  const Scene scene = makeBoxCity({.buildings = 2000, .boxes = 10000, .seed = 3});
  for (const Box& box : boundsOf(scene, "building ")) {
    EXPECT_EQ(box.min.y, 0.0f);
    EXPECT_GE(box.max.y, 8.0f);
    EXPECT_LE(box.max.y, 60.0f);
    EXPECT_GE(std::min(box.extent().x, box.extent().z), 8.0f);
  }
  for (const Box& box : boundsOf(scene, "box ")) {
    EXPECT_EQ(box.min.y, 0.0f);
    for (const float side : {box.extent().x, box.extent().y, box.extent().z}) {
      EXPECT_GE(side, 0.299f);
      EXPECT_LE(side, 3.001f);
    }
  }
}

TEST(BoxCity, NothingStandsInABuilding) {
  for (const std::uint32_t seed : {1u, 2u, 77u}) {
    const Scene scene = makeBoxCity({.buildings = 203, .boxes = 3000, .seed = seed});
    const std::vector<Box> buildings = boundsOf(scene, "building "), boxes = boundsOf(scene, "box ");
    for (std::size_t i = 0; i < buildings.size(); ++i) {
      for (std::size_t k = i + 1; k < buildings.size(); ++k) {
        EXPECT_FALSE(interpenetrate(buildings[i], buildings[k])) << "seed " << seed << ": " << i << ", " << k;
      }
      for (std::size_t k = 0; k < boxes.size(); ++k) {
        EXPECT_FALSE(overlaps(buildings[i], boxes[k])) << "seed " << seed << ": " << i << ", box " << k;
      }
    }
  }
}

TEST(BoxCity, WalksAreThoseThatAreDocumented) {
  const Scene scene = makeBoxCity({.buildings = 1000, .boxes = 0});
  ASSERT_EQ(scene.paths.size(), 2u);
  EXPECT_EQ(scene.paths[0].name, "smooth");
  EXPECT_EQ(scene.paths[0].frames.size(), 400u);
  EXPECT_LT(longestStep(scene.paths[0]), 0.5);
  EXPECT_GT(smallestTurnCosine(scene.paths[0]), 0.985);  // 10 degrees
  EXPECT_EQ(scene.paths[1].name, "views");
  EXPECT_EQ(scene.paths[1].frames.size(), 20u);
  const Box city = sceneBounds(scene.view());
  for (const CameraPath& path : scene.paths) {
    EXPECT_EQ(path.z_near, 0.1);
    EXPECT_GT(path.z_far, length(Vec3d(city.extent())));
    for (const CameraFrame& frame : path.frames) {
      EXPECT_NEAR(frame.eye.y, 1.7, 1e-9);
    }
  }
}

TEST(BoxCity, ViewsAreSpreadOverTheCityAndLookInAllFourDirections) {
  const Scene scene = makeBoxCity({.buildings = 10000, .boxes = 0});
  Box eyes;
  int north = 0, south = 0, east = 0, west = 0;
  for (const CameraFrame& frame : scene.paths[1].frames) {
    eyes.extend(Vec3f(frame.eye));
    east += frame.forward.x > 0.9, west += frame.forward.x < -0.9;
    south += frame.forward.z > 0.9, north += frame.forward.z < -0.9;
  }
  EXPECT_EQ(north, 5);
  EXPECT_EQ(south, 5);
  EXPECT_EQ(east, 5);
  EXPECT_EQ(west, 5);
  const Box city = sceneBounds(scene.view());
  EXPECT_GT(eyes.extent().x, 0.6f * city.extent().x);
  EXPECT_GT(eyes.extent().z, 0.6f * city.extent().z);
}

TEST(BoxCity, WalksTouchNothing) {
  for (const std::uint32_t buildings : {1u, 9u, 200u, 1000u}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const Scene scene = makeBoxCity({.buildings = buildings, .boxes = 30 * buildings, .seed = seed});
      EXPECT_EQ(whatIsHit(scene, scene.paths[0], 0.5), "") << buildings << " buildings, seed " << seed;
      // The views are not a continuous path, so no motion between them is checked.
      for (const CameraFrame& frame : scene.paths[1].frames) {
        CameraPath view;
        view.frames = {frame};
        EXPECT_EQ(whatIsHit(scene, view, 0.15), "") << buildings << " buildings, seed " << seed;
      }
    }
  }
}

TEST(BoxCity, NoEyeIsInABox) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = makeBoxCity({.buildings = 300, .boxes = 9000, .seed = seed, .walled = seed == 3});
    for (const CameraPath& path : scene.paths) {
      for (const CameraFrame& frame : path.frames) {
        Box eye;
        eye.extend(Vec3f(frame.eye));
        for (const Object& object : scene.objects) {
          ASSERT_FALSE(contains(object.bounds, eye)) << "seed " << seed << ", " << path.name;
        }
      }
    }
  }
}

// Where a ray from inside, level with the ground, leaves a box: 0 if it does not meet it.
double leavesAt(const Box& box, const Vec3d& from, const Vec3d& direction) {
  double enters = 0.0, leaves = 1e30;
  for (const int axis : {0, 2}) {
    const double a = (box.min[axis] - from[axis]) / direction[axis],
                 b = (box.max[axis] - from[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters < leaves ? leaves : 0.0;
}

TEST(BoxCity, WallsHigherThanAllBuildingsSurroundTheQuarterOfTheWalk) {
  for (const std::uint32_t buildings : {1000u, 4321u, 20000u}) {
    const Scene scene = makeBoxCity({.buildings = buildings, .boxes = 10, .walled = true});
    const std::size_t first_wall = 1 + buildings + 10;
    ASSERT_GT(scene.objects.size(), first_wall);
    float highest = 0.0f, lowest_wall = 1e30f;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      float& limit = o < first_wall ? highest : lowest_wall;
      const float top = scene.objects[o].bounds.max.y;
      limit = o < first_wall ? std::max(limit, top) : std::min(limit, top);
    }
    EXPECT_GT(lowest_wall, highest);
    for (std::size_t f = 0; f < scene.paths[0].frames.size(); f += 57) {
      const Vec3d eye = scene.paths[0].frames[f].eye;
      for (int i = 0; i < 720; ++i) {
        const double angle = (i + 0.5) / 360.0 * 3.14159265358979;
        double nearest = 1e30;
        for (std::size_t o = first_wall; o < scene.objects.size(); ++o) {
          const double at = leavesAt(scene.objects[o].bounds, eye, {std::cos(angle), 0.0, std::sin(angle)});
          nearest = at > 0.0 ? std::min(nearest, at) : nearest;
        }
        EXPECT_LT(nearest, 4 * 82.0 * 1.5) << buildings << " buildings, frame " << f << ", direction " << i;
      }
    }
  }
}

TEST(BoxCity, TheSameOptionsGiveTheSameBits) {
  const BoxCityOptions options{.buildings = 100, .boxes = 500, .seed = 4000000000u};
  const std::uint64_t hash = hashOf(makeBoxCity(options));
  EXPECT_EQ(hash, hashOf(makeBoxCity(options)));
  EXPECT_NE(hash, hashOf(makeBoxCity({.buildings = 100, .boxes = 500, .seed = 4000000001u})));
}

TEST(BoxCity, MoreSmallBoxesLeaveTheBuildingsAlone) {
  const Scene few = makeBoxCity({.buildings = 100, .boxes = 3});
  const Scene many = makeBoxCity({.buildings = 100, .boxes = 900});
  EXPECT_EQ(boundsOf(few, "building "), boundsOf(many, "building "));
}

}  // namespace
}  // namespace sightline
