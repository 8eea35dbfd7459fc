// What rays that are traced together hit.

#include "oracle/ray_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

// A row of panes, one before each ray of a batch. The rays start in different octants and run in different
// directions, so that Embree may sort them.
TEST(RayScene, SaysWhichRayOfABatchHitAPane) {
  for (const Opacity opacity : {Opacity::kOpaque, Opacity::kBlended}) {
    Scene scene;
    const MaterialId material = addMaterial(scene, opacity, true);
    RayScene::Batch batch;
    for (std::uint32_t i = 0; i < RayScene::kBatch; ++i) {
      const float x = 4.0f * static_cast<float>(i) - 30.0f, z = i % 3 == 0 ? -2.0f : 2.0f;
      addWall(scene, material, z, x - 1.0f, x + 1.0f, -1.0f, 1.0f);
      const float aside = i % 2 == 0 ? -0.25f : 0.25f;
      batch[i] = {{x, 0.5f, 0.0f}, {aside, 0.125f, z}, 2.0f};
    }
    const RayScene rays(scene.view());
    for (const std::uint32_t count : {1u, 7u, RayScene::kBatch}) {
      for (const bool coherent : {false, true}) {
        std::vector<RayHit> hits;
        rays.trace(batch, count, coherent, hits);
        std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.ray < b.ray; });
        ASSERT_EQ(hits.size(), count);
        for (std::uint32_t i = 0; i < count; ++i) {
          EXPECT_EQ(hits[i].ray, i);
          EXPECT_EQ(hits[i].object, ObjectId(i));
          EXPECT_FLOAT_EQ(hits[i].t, 1.0f);
          EXPECT_EQ(hits[i].opaque, opacity == Opacity::kOpaque);
        }
      }
    }
  }
}

// The pane behind an opaque wall is not hit, and neither is one beyond the end of a ray.
TEST(RayScene, SeesThroughPanesUpToTheFirstWall) {
  Scene scene;
  const MaterialId opaque = addMaterial(scene, Opacity::kOpaque, true);
  const MaterialId glass = addMaterial(scene, Opacity::kBlended, true);
  addWall(scene, glass, -1.0f, -9.0f, 9.0f, -9.0f, 9.0f);
  addWall(scene, opaque, -2.0f, -9.0f, 0.0f, -9.0f, 9.0f);
  addWall(scene, glass, -3.0f, -9.0f, 9.0f, -9.0f, 9.0f);
  addWall(scene, glass, -5.0f, -9.0f, 9.0f, -9.0f, 9.0f);
  RayScene::Batch batch;
  batch[0] = {{-1.0f, 0.5f, 0.0f}, {0.0f, 0.0f, -1.0f}, 4.0f};
  batch[1] = {{1.0f, 0.5f, 0.0f}, {0.0f, 0.0f, -1.0f}, 4.0f};
  const RayScene rays(scene.view());
  std::vector<RayHit> hits;
  rays.trace(batch, 2, false, hits);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;  // ray and object
  for (const RayHit& hit : hits) {
    found.emplace_back(hit.ray, hit.object.value);
  }
  std::sort(found.begin(), found.end());
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected{{0, 0}, {0, 1}, {1, 0}, {1, 2}};
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace sightline
