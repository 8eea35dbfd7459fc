// When the baker divides a cell, and what it looks at to decide it.

#include <gtest/gtest.h>

#include <span>
#include <utility>
#include <vector>

#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/cell_sets.h"
#include "src/pvs/bake/cell_tree.h"
#include "tests/pvs/bake_scenes.h"

namespace sightline {
namespace {

using test::allOccluders;
using test::block;
using test::sceneOf;
using test::Solid;

// A root of 8 m, in which no set is small enough. With so small an occluder size all occluders are of use to
// it.
const BakeSettings kRoot{.triangle_budget = 1,
                         .max_depth = 6,
                         .near_distance = 0.1,
                         .viewers = {{{0, 0, 0}, {8, 8, 8}}},
                         .occluder_size = 1e-4};

// What baking the root alone gives.
struct Root {
  PartTask task;
  std::vector<PartTask> below;  // none if the root is a leaf
  BakeStats stats;

  Root(const Scene& scene, const BakeSettings& settings) {
    const Result<Bake> bake = Bake::plan(scene.view(), allOccluders(scene), settings);
    EXPECT_TRUE(bake) << bake.error().message;
    Bake::Worker worker(*bake);
    task = bake->firstPart();
    below = bake->partsBelow(worker.bake(task));
    stats = worker.stats();
  }
};

// 16 crates around (x, y, z), in a plane across the first axis.
void addCrates(std::vector<Solid>& solids, float x, float y, float z) {
  for (int i = 0; i < 16; ++i) {
    const Vec3f at(x, y + 1.5f * static_cast<float>(i % 4) - 3.0f,
                   z + 1.5f * static_cast<float>(i / 4) - 3.0f);
    solids.push_back(block(at, at + Vec3f(0.8f, 0.8f, 0.8f)));
  }
}

TEST(Dividing, DoesNotHappenWhereNoPointSeesLess) {
  std::vector<Solid> solids;
  addCrates(solids, -20, 4, 4);
  addCrates(solids, 28, 4, 4);
  EXPECT_TRUE(Root(sceneOf(solids), kRoot).below.empty());
}

TEST(Dividing, HappensWhereOnlyTheCentresOfChildrenSeeLess) {
  // The screen is 0.4 m from the centre of the first child, (2, 2, 2), and hides all crates from it. From the
  // root's corners and its centre it hides none.
  std::vector<Solid> solids{block({1.5f, 1, 1}, {1.6f, 3, 3})};
  addCrates(solids, -20, 0, 0);
  EXPECT_EQ(Root(sceneOf(solids), kRoot).below.size(), 8u);
}

TEST(Dividing, ChildrenLookAsFarAsTheirParentHadTo) {
  // Within 2 m of the root, but not within 1 m, are a wall that hides half of the crates from all of it, and
  // one that hides the others from its lower half.
  std::vector<Solid> solids{block({9.5f, -40, -40}, {9.6f, 48, 48}),
                            block({-1.6f, -40, -40}, {-1.5f, 4, 48})};
  addCrates(solids, 20, 4, 4);
  addCrates(solids, -20, -4, 4);
  BakeSettings settings = kRoot;
  settings.search_distance = 1.0;
  const Root root(sceneOf(solids), settings);
  EXPECT_EQ(root.task.search_distance, 1.0);
  ASSERT_EQ(root.below.size(), 8u);
  for (const PartTask& child : root.below) {
    EXPECT_EQ(child.search_distance, 2.0);
  }
}

TEST(Dividing, CellsOfOnePartLookAsFarAsTheirParentHadTo) {
  // As above, and 10 m from the root a wall that hides further crates. Cells that begin with the distance of
  // the root, 2 m, see nothing gained at 4 m and look no farther; an eighth of the diagonal would reach it.
  std::vector<Solid> solids{block({9.5f, -40, -40}, {9.6f, 48, 48}), block({-1.6f, -40, -40}, {-1.5f, 4, 48}),
                            block({-40, 18, -40}, {48, 18.1f, 48})};
  addCrates(solids, 20, 4, 4);
  addCrates(solids, -20, -4, 4);
  addCrates(solids, 4, 40, 4);
  const Scene scene = sceneOf(solids);
  BakeSettings settings = kRoot;
  settings.search_distance = 1.0;
  settings.max_depth = 1;
  const OccluderSet occluders = allOccluders(scene);
  const pvs::BakeScene bake(scene.view(), occluders, settings, serialFor);
  ASSERT_GT(0.125 * bake.diagonal, 10.0);
  pvs::CellBaker baker(bake);
  pvs::CellOutcome outcome = pvs::decide(baker, bake, {.search_distance = 1.0});
  ASSERT_FALSE(outcome.leaf);
  const pvs::BakedCell cell = pvs::bakeBelow(baker, bake, {}, std::move(outcome));
  ASSERT_EQ(cell.children.size(), 8u);
  for (const pvs::BakedCell& child : cell.children) {
    for (std::size_t crate = scene.objects.size() - 16; crate < scene.objects.size(); ++crate) {
      const pvs::ObjectRun run{bake.position_of[crate], bake.position_of[crate] + 1};
      pvs::Runs seen;
      pvs::intersect(child.sets.whole, std::span(&run, 1), seen);
      EXPECT_FALSE(seen.empty());
    }
  }
}

TEST(Dividing, OccludersThatAreTooSmallForACellAreLeftToSmallerOnes) {
  // A wall with a crate behind it and many before it.
  std::vector<Solid> solids{block({12, -8, -8}, {12.5f, 16, 16}), block({14, 3, 3}, {15, 4, 4})};
  for (int i = 0; i < 10; ++i) {
    addCrates(solids, 9.0f + 0.1f * static_cast<float>(i), 2.0f + 0.1f * static_cast<float>(i), 4);
  }
  BakeSettings settings = kRoot;
  settings.occluder_size = 1.0;
  settings.triangle_budget = 1'000'000;
  const Root root(sceneOf(solids), settings);
  EXPECT_TRUE(root.below.empty());
  EXPECT_EQ(root.stats.shadows, 8u) << "of the wall, from each corner";
}

}  // namespace
}  // namespace sightline
