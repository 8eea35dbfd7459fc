#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;
using Corner = std::array<int, 3>;

bool isRock(const Scene& scene, std::size_t object) {
  return scene.object_names[object].rfind("rock ", 0) == 0;
}

// The faces of cubes that the rock's rectangles consist of: by their corner with the least coordinates, axis
// and side, how often each occurs; and the length of the rectangles' longest side.
struct Faces {
  std::map<std::tuple<Corner, int, int>, int> counts;
  std::size_t rectangles = 0;
  int longest = 0;
  bool whole = true;  // all corners have whole coordinates, and all rectangles lie across an axis
};

Faces facesOf(const Scene& scene) {
  Faces faces;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    for (std::uint32_t i = 0; isRock(scene, o) && i < object.index_count; i += 6) {
      Box box;
      for (std::uint32_t k = 0; k < 6; ++k) {
        box.extend(scene.positions[scene.indices[object.first_index + i + k]]);
      }
      const auto at = [&](std::uint32_t k) {
        return Vec3d(scene.positions[scene.indices[object.first_index + i + k]]);
      };
      const Vec3d normal = cross(at(1) - at(0), at(2) - at(0));
      int axis = 0;
      for (int a = 0; a < 3; ++a) {
        axis = box.min[a] == box.max[a] ? a : axis;
        faces.whole =
            faces.whole && box.min[a] == std::floor(box.min[a]) && box.max[a] == std::floor(box.max[a]);
      }
      faces.whole = faces.whole && box.min[axis] == box.max[axis];
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (float x = box.min[u]; x < box.max[u]; ++x) {
        for (float y = box.min[v]; y < box.max[v]; ++y) {
          Corner corner{};
          corner[axis] = static_cast<int>(box.min[axis]);
          corner[u] = static_cast<int>(x);
          corner[v] = static_cast<int>(y);
          ++faces.counts[{corner, axis, normal[axis] > 0.0 ? 1 : -1}];
        }
      }
      ++faces.rectangles;
      faces.longest = std::max(faces.longest, static_cast<int>(box.max[u] - box.min[u]));
    }
  }
  return faces;
}

TEST(Voxels, IsInOrder) {
  for (const VoxelOptions& options : {VoxelOptions{}, VoxelOptions{.halls = 4, .seed = 2}}) {
    const Scene scene = makeVoxels(options);
    EXPECT_EQ(whatIsWrong(scene), "") << "seed " << options.seed;
    EXPECT_EQ(degenerateShare(scene), 0.0);
  }
}

TEST(Voxels, TheRockIsOneClosedSurfaceOfMergedFaces) {
  for (const std::uint32_t seed : {1u, 2u}) {
    const Faces faces = facesOf(makeVoxels({.halls = 6, .seed = seed}));
    EXPECT_TRUE(faces.whole);
    EXPECT_LT(2 * faces.rectangles, faces.counts.size()) << "they are merged";
    EXPECT_GT(faces.longest, 8);
    EXPECT_LE(faces.longest, 16) << "a chunk's side";
    // What is left of each edge of a cube after both directions have cancelled.
    std::map<std::pair<Corner, int>, int> edges;
    for (const auto& [face, count] : faces.counts) {
      const auto& [corner, axis, side] = face;
      EXPECT_EQ(count, 1);
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Corner beside_u = corner, beside_v = corner;
      ++beside_u[v];
      ++beside_v[u];
      edges[{corner, u}] += side;
      edges[{beside_v, v}] += side;
      edges[{beside_u, u}] -= side;
      edges[{corner, v}] -= side;
    }
    for (const auto& [edge, left] : edges) {
      ASSERT_EQ(left, 0);
    }
  }
}

TEST(Voxels, CornersLieInsideEdges) {
  const SheetCounts rock = countSheet(makeVoxels({.halls = 6}), "rock ");
  EXPECT_GT(rock.open_edges, 1000u) << "of which the surface has none: they are T-junctions";
}

TEST(Voxels, ThingsStandOnTheFloor) {
  const Scene scene = makeVoxels({});
  std::size_t things = 0;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    if (!isRock(scene, o)) {
      ++things;
      EXPECT_TRUE(isClosed(scene, scene.objects[o]));
      EXPECT_GT(volumeOf(scene, scene.objects[o]), 0.0);
      EXPECT_EQ(scene.objects[o].bounds.min.y, std::floor(scene.objects[o].bounds.min.y));
    }
  }
  EXPECT_GT(things, 300u);
}

TEST(Voxels, TheWalkTouchesNothing) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = makeVoxels({.seed = seed});
    EXPECT_EQ(whatIsWrongWithWalk(
                  scene,
                  {.clearance = 0.3, .ground = "rock ", .most_height = 3.6, .turn_cosine = 0.9, .step = 1.5}),
              "")
        << "seed " << seed;
  }
}

TEST(Voxels, IsADemoSceneThatDependsOnItsSeed) {
  const Result<Scene> scene = makeDemoScene("demo:voxels?halls=5&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeVoxels({.halls = 5, .seed = 9})));
  EXPECT_NE(hashOf(*scene), hashOf(makeVoxels({.halls = 5, .seed = 8})));
  EXPECT_FALSE(makeDemoScene("demo:voxels?halls=3"));
}

}  // namespace
}  // namespace sightline
