// A file that was baked, in use by a world that changes: whatever is left out is proved hidden.

#include <gtest/gtest.h>

#include <random>

#include "sightline/pvs/query/set_query.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/sight_checks.h"

namespace sightline {
namespace {

using test::block;
using test::Solid;

// Walls in a grid with crates between them.
std::vector<Solid> yards(std::mt19937& random) {
  std::vector<Solid> solids{block({-1, -1, -1}, {25, 0, 25})};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const Vec3f at(static_cast<float>(6 * i), 0, static_cast<float>(6 * j));
      solids.push_back(block(at, at + (random() % 2 == 0 ? Vec3f(5.75f, 4, 0.25f) : Vec3f(0.25f, 4, 5.75f))));
      const Vec3f crate = at + Vec3f(1.0f + static_cast<float>(random() % 4), 0, 2.0f);
      solids.push_back(block(crate, crate + Vec3f(0.5f, 0.5f, 0.5f)));
    }
  }
  return solids;
}

TEST(WorldSets, OfARealBakeSurviveEdits) {
  std::size_t left_out = 0, judged = 0;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    std::vector<Solid> solids = yards(random);
    const Scene scene = test::sceneOf(solids);
    const auto bytes = sight_test::bytesOf(test::baked(scene, {.max_depth = 4, .near_distance = 0.1}));
    SetQuery query(*sight_test::opened(bytes));
    World world;
    std::vector<InstanceId> ids;
    for (const Object& object : scene.objects) {
      const MeshView mesh{.positions = scene.positions.data(),
                          .vertex_count = static_cast<std::uint32_t>(scene.positions.size()),
                          .indices = scene.indices.data() + object.first_index,
                          .index_count = object.index_count};
      ids.push_back(world.add({.mesh = world.addMesh(*makeMesh(mesh))}));
    }
    const SetsId sets = world.addSets(ids, query.boxes());
    EXPECT_EQ(world.tombstones(sets), 0u);
    WorldCuller culler({.occlusion = false}), plain({.occlusion = false});
    culler.useSets(sets, &query);
    for (int frame = 0; frame < 60; ++frame) {
      View view;
      view.eye = {0.25 * static_cast<double>(random() % 96), 1.0 + 0.25 * static_cast<double>(random() % 4),
                  0.25 * static_cast<double>(random() % 96) + 0.125};
      setOrientation(view,
                     {static_cast<double>(random() % 5) - 2.0, 0, static_cast<double>(random() % 5) - 2.25},
                     {0, 1, 0});
      view.z_near = 0.0625;
      culler.cull(world, view);
      plain.cull(world, view);
      left_out += plain.visible().size() - culler.visible().size();
      // The scene as it is now.
      std::vector<Solid> now;
      std::vector<ObjectId> culled;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        if (world.has(ids[i])) {
          if (!std::binary_search(culler.visible().begin(), culler.visible().end(), ids[i])) {
            culled.emplace_back(now.size());
          }
          now.push_back(solids[i]);
        }
      }
      const Scene judged_scene = test::sceneOf(now);
      const ExactVisibility exact(judged_scene.view());
      for (const Decision& decision : exact.decide(view, culled, 50'000)) {
        EXPECT_EQ(decision.verdict, Verdict::kHidden) << seed << " " << frame;
        ++judged;
      }
      // Something goes in every tenth frame.
      if (frame % 10 == 9) {
        world.remove(ids[random() % ids.size()]);
      }
    }
  }
  EXPECT_GT(judged, 1000u);
  EXPECT_GT(left_out, 180u);  // of 180 frames, more than one in each
}

}  // namespace
}  // namespace sightline
