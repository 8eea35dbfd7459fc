// That surfaces are the same however the work is cut, and how positions become vertices.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "sightline/occluders/surface_set.h"
#include "tests/support/cut_work.h"

namespace sightline {
namespace {

LargeVector<std::byte> bytesOf(const Scene& scene, const SurfaceSettings& settings,
                               const ParallelFor& parallel_for) {
  return surfaceBytes(findSurfaces(scene.view(), settings, parallel_for));
}

// The same scene with three positions of its own for each triangle, in random places of the array, some of
// them with -0 for 0; some triangles are not finite.
Scene takenApart(const Scene& scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene apart = scene;
  std::vector<std::uint32_t> place(scene.indices.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    place[i] = i;
  }
  std::shuffle(place.begin(), place.end(), random);
  apart.positions.resize(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    Vec3f p = scene.positions[scene.indices[i]];
    p.x = p.x == 0.0f && random() % 2 == 0 ? -0.0f : p.x;
    p.y = random() % 5000 == 0 ? std::numeric_limits<float>::infinity() : p.y;
    apart.positions[place[i]] = p;
    apart.indices[i] = place[i];
  }
  return apart;
}

TEST(FindSurfaces, DoNotDependOnHowTheWorkIsCut) {
  std::vector<Scene> scenes;
  scenes.push_back(makeCity({.copies = 3}));
  scenes.push_back(takenApart(makeBuilding({.floors = 2, .plants = 20}), 1));
  scenes.push_back(makeTerrain({.triangles = 20000}));
  for (const Scene& scene : scenes) {
    ASSERT_GT(scene.triangleCount(), 20000u);  // several parts of each step
    for (const SurfaceSettings& settings :
         {SurfaceSettings{},
          SurfaceSettings{.part_triangles = 50, .cluster_triangles = 3, .join_edges = false}}) {
      const LargeVector<std::byte> serial = bytesOf(scene, settings, serialFor);
      EXPECT_EQ(serial, bytesOf(scene, settings, backwardsBy(1)));
      EXPECT_EQ(serial, bytesOf(scene, settings, backwardsBy(5)));
      EXPECT_EQ(serial, bytesOf(scene, settings, onThreads(4)));
    }
  }
}

TEST(FindSurfaces, HaveAVertexForEachDifferentPositionInTheOrderOfUse) {
  const Scene scene = takenApart(makeBuilding({.floors = 2, .plants = 20}), 2);
  const SurfaceSet set = findSurfaces(scene.view(), {.join_edges = false}, onThreads(3));
  std::map<std::tuple<float, float, float>, std::size_t> numbers;  // -0 and 0 are the same key
  std::vector<Vec3f> expected;
  std::size_t triangles = 0;
  for (const Object& object : scene.objects) {
    for (std::uint32_t t = 0; scene.materials[object.material.value].opaque() && t < object.triangleCount();
         ++t) {
      const std::uint32_t* corners = &scene.indices[object.first_index + 3 * t];
      const Vec3f a = scene.positions[corners[0]], b = scene.positions[corners[1]],
                  c = scene.positions[corners[2]];
      if (object.mark == OccluderMark::kNever || !isFinite(a) || !isFinite(b) || !isFinite(c)) {
        continue;
      }
      triangles += a != b && b != c && c != a ? 1 : 0;
      for (const Vec3f& p : {a, b, c}) {
        if (numbers.emplace(std::tuple(p.x, p.y, p.z), expected.size()).second) {
          expected.push_back(p);
        }
      }
    }
  }
  EXPECT_LT(expected.size(), scene.positions.size() / 2);
  EXPECT_TRUE(std::equal(set.vertices.begin(), set.vertices.end(), expected.begin(), expected.end()));
  EXPECT_EQ(set.triangles.size(), 3 * triangles);
}

}  // namespace
}  // namespace sightline
