// Surfaces that are written as bytes and read again.

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "scenes/procedural.h"
#include "sightline/occluders/surface_set.h"
#include "tests/occluders/triangle_soup.h"
#include "tests/support/cut_off.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

struct Village {
  Scene scene = *makeDemoScene("demo:city?copies=1");
  SurfaceSet surfaces = findSurfaces(scene.view());
  std::uint32_t objects = static_cast<std::uint32_t>(scene.objects.size());
};

TEST(SurfaceBytes, AreReadAsTheyWereWritten) {
  const Village village;
  const LargeVector<std::byte> bytes = surfaceBytes(village.surfaces);
  const Result<SurfaceSet> read = surfacesFrom({bytes}, village.objects);
  ASSERT_TRUE(read) << read.error().message;
  const SurfaceSet& set = village.surfaces;
  EXPECT_EQ(read->vertices, set.vertices);
  EXPECT_EQ(read->triangles, set.triangles);
  EXPECT_EQ(read->of_object, set.of_object);
  EXPECT_EQ(read->chain_vertices, set.chain_vertices);
  EXPECT_EQ(read->part_bounds, set.part_bounds);
  EXPECT_EQ(read->bounds, set.bounds);
  ASSERT_EQ(read->clusters.size(), set.clusters.size());
  for (std::size_t c = 0; c < set.clusters.size(); ++c) {
    EXPECT_EQ(read->clusters[c].support.offset, set.clusters[c].support.offset);
    EXPECT_EQ(read->clusters[c].double_sided, set.clusters[c].double_sided);
  }
  EXPECT_EQ(surfaceBytes(*read), bytes);
  const LargeVector<std::byte> none = surfaceBytes(findSurfaces({}));
  EXPECT_TRUE(surfacesFrom({none}, 0)) << "a scene without triangles";
  EXPECT_FALSE(surfacesFrom({none}, 1)) << "of another number of objects";
  EXPECT_FALSE(surfacesFrom({bytes}, village.objects + 1));
}

TEST(SurfaceBytes, CutOffAnywhereTheyAreRefused) {
  const Village village;
  const LargeVector<std::byte> bytes = surfaceBytes(village.surfaces);
  test::expectCutOffIsRefused(bytes, "find them again", [&](std::span<const std::byte> cut) {
    return surfacesFrom({cut}, village.objects);
  });
}

// Whatever is read can be walked through: every index stays within its array.
void walkThrough(const SurfaceSet& set) {
  double sum = 0.0;
  for (std::uint32_t object = 0; object + 1 < set.first_of_object.size(); ++object) {
    for (const std::uint32_t part : set.partsOf(ObjectId(object))) {
      sum += static_cast<double>(set.adjoiningOf(part).size()) + set.part_bounds[part].min.x;
    }
  }
  for (const SurfacePart& part : set.parts) {
    for (const SurfacePatch& patch : set.patchesOf(part)) {
      for (const PatchChain& use : set.chainsOf(patch)) {
        const SurfaceChain& chain = set.chains[use.chain];
        sum += set.verticesOf(chain).back().x + static_cast<float>(set.usesOf(chain).front().value);
      }
      for (std::uint32_t c = patch.first_cluster; c < patch.first_cluster + patch.cluster_count; ++c) {
        for (const std::uint32_t vertex : set.trianglesOf(set.clusters[c])) {
          sum += set.vertices[vertex].x;
        }
        for (const std::uint32_t chain : set.chainsOf(set.clusters[c])) {
          sum += set.chains[chain].use_count;
        }
        sum += set.clusters[c].double_sided ? 1.0 : 0.0;
      }
    }
  }
  EXPECT_TRUE(sum == sum || sum != sum);
}

// Few surfaces, so that a changed byte is seldom one of very many that are alike.
TEST(SurfaceBytes, WithAnyBytesChangedTheyAreRefusedOrHarmless) {
  constexpr std::uint32_t kObjects = 5;
  const Scene scene = test::sceneOf(test::greedyVoxels(1, 5), kObjects);
  const SurfaceSet surfaces = findSurfaces(scene.view(), {.part_triangles = 20, .cluster_triangles = 4});
  const LargeVector<std::byte> bytes = surfaceBytes(surfaces);
  std::mt19937 random(1);
  std::size_t refused = 0;
  for (int i = 0; i < test::rounds(3000); ++i) {
    LargeVector<std::byte> changed = bytes;
    for (int k = 0; k < 3; ++k) {
      changed[random() % changed.size()] = static_cast<std::byte>(random());
    }
    const Result<SurfaceSet> read = surfacesFrom({changed}, kObjects);
    refused += read ? 0 : 1;
    if (read) {
      walkThrough(*read);
    }
  }
  EXPECT_GT(refused, test::rounds(300u));
  EXPECT_LT(refused, test::rounds(2700u));
}

TEST(SurfaceBytes, WithNumbersThatDrawingCannotComputeWithTheyAreRefused) {
  const Village village;
  const auto refuses = [&](auto&& change) {
    SurfaceSet set = village.surfaces;
    change(set);
    const LargeVector<std::byte> bytes_of_set = surfaceBytes(set);
    return !surfacesFrom({bytes_of_set}, village.objects);
  };
  constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  EXPECT_FALSE(refuses([](SurfaceSet&) {}));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.chain_vertices.back().x = kFloatNan; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.chain_vertices.back().x = 1e30f; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.vertices[0].y = -1.0f / 0.0f; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.part_bounds[0].max.z = kFloatNan; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.clusters[0].support.offset = double{kFloatNan}; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.patches[0].cone_cosine = 2.0f; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.uses[0].value = kLeast; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.patch_chains[0].value = 0; }));
  EXPECT_TRUE(refuses([](SurfaceSet& set) { set.patch_chains[0].value = 1 << 20; }));
}

}  // namespace
}  // namespace sightline
