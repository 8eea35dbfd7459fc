#include "sightline/scene/object_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "scenes/landscapes.h"
#include "scenes/procedural.h"
#include "tests/support/cut_work.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::vector<Triangle> trianglesOf(const SceneView& scene, const Object& object) {
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  }
  return triangles;
}

TEST(ObjectClusters, HaveEachTriangleOfTheirObjectOnceInABoxThatHoldsIt) {
  const Scene scene = makeTerrain({.triangles = test::rounds(20000u)});
  for (const std::uint32_t most : {1u, 100u, 1024u, 1u << 30}) {
    const ObjectClusters found = findObjectClusters(scene.view(), {.max_triangles = most});
    const SceneView clusters = found.view(scene.view());
    ASSERT_EQ(found.first.size(), scene.objects.size() + 1);
    ASSERT_EQ(found.object_of.size(), found.clusters.size());
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      std::vector<Triangle> together;
      for (std::uint32_t c = found.first[o]; c < found.first[o + 1]; ++c) {
        const Object& cluster = found.clusters[c];
        EXPECT_EQ(found.object_of[c], ObjectId(o));
        EXPECT_EQ(cluster.material, object.material);
        EXPECT_LE(cluster.triangleCount(), most);
        EXPECT_TRUE(contains(object.bounds, cluster.bounds));
        for (const Triangle& triangle : trianglesOf(clusters, cluster)) {
          together.push_back(triangle);
          for (const std::uint32_t index : triangle) {
            EXPECT_TRUE(contains(cluster.bounds, Box{scene.positions[index], scene.positions[index]}));
          }
        }
      }
      std::vector<Triangle> given = trianglesOf(scene.view(), object);
      std::sort(given.begin(), given.end());
      std::sort(together.begin(), together.end());
      EXPECT_EQ(together, given);
      EXPECT_TRUE(object.triangleCount() > most || found.first[o + 1] - found.first[o] == 1);
    }
  }
}

TEST(ObjectClusters, AreSmallAgainstTheirObject) {
  const Scene scene = makeTerrain({.triangles = 20000});
  const ObjectClusters found = findObjectClusters(scene.view(), {.max_triangles = 100});
  const auto largest = static_cast<std::uint32_t>(
      std::max_element(scene.objects.begin(), scene.objects.end(),
                       [](const Object& a, const Object& b) { return a.index_count < b.index_count; }) -
      scene.objects.begin());
  ASSERT_GT(scene.objects[largest].triangleCount(), 200u) << "there is one to divide";
  for (std::uint32_t c = found.first[largest]; c < found.first[largest + 1]; ++c) {
    EXPECT_LT(length(found.clusters[c].bounds.extent()), length(scene.objects[largest].bounds.extent()));
    EXPECT_GT(found.clusters[c].triangleCount(), 25u) << "halves are of the same size";
  }
}

TEST(ObjectClusters, DoNotDependOnTheThreads) {
  const Scene scene = makeTerrain({.triangles = test::rounds(20000u)});
  const ObjectClusters serial = findObjectClusters(scene.view(), {.max_triangles = 64});
  for (const ParallelFor& parallel_for : {backwardsBy(1), onThreads(4)}) {
    const ObjectClusters other = findObjectClusters(scene.view(), {.max_triangles = 64}, parallel_for);
    EXPECT_EQ(serial.indices, other.indices);
    EXPECT_EQ(serial.first, other.first);
    EXPECT_EQ(serial.object_of, other.object_of);
  }
}

// Four triangles along an axis, as one object.
Scene row() {
  Scene scene;
  scene.materials.push_back({.name = "plain"});
  for (int i = 0; i < 4; ++i) {
    const auto x = static_cast<float>(10 * i);
    scene.positions.insert(scene.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
  }
  for (std::uint32_t i = 0; i < 12; ++i) {
    scene.indices.push_back(i);
  }
  scene.objects.push_back({.index_count = 12, .material = MaterialId{0u}, .bounds = {{0, 0, 0}, {31, 1, 0}}});
  scene.object_names.emplace_back("row");
  return scene;
}

std::size_t clustersOf(const Scene& scene, double margin = 0.0) {
  return findObjectClusters(scene.view(), {.max_triangles = 1, .margin = margin}).clusters.size();
}

TEST(ObjectClusters, ObjectsWhoseBoundsAreNotThoseOfTheirTrianglesStayWhole) {
  EXPECT_EQ(clustersOf(row()), 4u);
  Scene wide = row();
  wide.objects[0].bounds.max.y = 2.0f;
  EXPECT_EQ(clustersOf(wide), 1u);
  Scene infinite = row();
  infinite.positions[4].y = std::numeric_limits<float>::infinity();
  infinite.objects[0].bounds.max.y = std::numeric_limits<float>::infinity();
  EXPECT_EQ(clustersOf(infinite), 1u);
  Scene closed = row();
  closed.objects[0].bounds = widened(closed.objects[0].bounds, 0.25);
  EXPECT_EQ(clustersOf(closed), 1u);
  EXPECT_EQ(clustersOf(closed, 0.25), 4u);
  const ObjectClusters found = findObjectClusters(closed.view(), {.max_triangles = 1, .margin = 0.25});
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_LE(found.clusters[c].bounds.min.x, 10.0f * static_cast<float>(c) - 0.25f);
    EXPECT_GE(found.clusters[c].bounds.max.x, 10.0f * static_cast<float>(c) + 1.25f);
  }
}

TEST(ObjectClusters, AnObjectIsVisibleWhereAnyOfItsClustersIs) {
  ObjectClusters clusters;
  clusters.object_of = {ObjectId{0u}, ObjectId{0u}, ObjectId{1u}, ObjectId{2u}, ObjectId{2u}};
  std::vector<ObjectId> objects{ObjectId{7u}};
  const std::vector<ObjectId> seen{ObjectId{0u}, ObjectId{1u}, ObjectId{4u}};
  clusters.objectsOf(seen, objects);
  EXPECT_EQ(objects, (std::vector<ObjectId>{ObjectId{0u}, ObjectId{2u}}));
  clusters.objectsOf({}, objects);
  EXPECT_TRUE(objects.empty());
}

}  // namespace
}  // namespace sightline
