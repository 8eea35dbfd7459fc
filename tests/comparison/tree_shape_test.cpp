#include "sightline/comparison/tree_shape.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sightline/occlusion/occlusion_tree.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

constexpr Family kMetres{"metres", 1.0, 0.0, false};

TEST(TreeShape, HasTheNodesAndLeavesOfTheTree) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomScene scene(kMetres, seed);
    const OccluderSet set = setOf(scene.polygons);
    for (const bool modified : {false, true}) {
      OcclusionTree tree({.variant = modified ? OcclusionTreeVariant::kFME : OcclusionTreeVariant::kFSE});
      tree.build(scene.view, set, all(set));
      const TreeShape shape = shapeOfTree(scene.view, set, all(set), modified);
      EXPECT_EQ(shape.nodes.size(), tree.stats().nodes) << "seed " << seed;
      EXPECT_EQ(shape.leaves.size(), tree.stats().leaves) << "seed " << seed;
      EXPECT_EQ(shape.frustum_nodes, 4u);
    }
  }
}

// Where a point relative to the eye ends up: it follows the planes down, and is hidden behind the occluder of
// a leaf in shadow.
Visibility at(const TreeShape& tree, const Vec3d& point) {
  TreeBranch branch = tree.root;
  while (branch.kind == TreeBranch::Kind::kNode) {
    const TreeShapeNode& node = tree.nodes[branch.index];
    branch = node.plane.evaluate(point) > 0.0 ? node.front : node.back;
  }
  const bool hidden =
      branch.kind == TreeBranch::Kind::kShadow && tree.leaves[branch.index].support.evaluate(point) < -1e-6;
  return hidden ? Visibility::kHidden : Visibility::kVisible;
}

TEST(TreeShape, TellsOfEveryPointWhatRaysTell) {
  int hidden = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    RandomScene scene(kMetres, seed);
    if (scene.view.orthographic) {
      continue;
    }
    const OccluderSet set = setOf(scene.polygons);
    const std::vector<PreparedPolygon> polygons = prepared(scene.polygons);
    const Frustum frustum = frustumOf(scene.view);
    for (const bool modified : {false, true}) {
      const TreeShape tree = shapeOfTree(scene.view, set, all(set), modified);
      for (int i = 0; i < 400; ++i) {
        const Vec3d point = scene.origin + scene.random.point(20.0);
        if (!insideView(frustum, point)) {
          continue;
        }
        // Outlines are drawn in by less than this margin, which leaves such rays undecided.
        RayAnswer answer = RayAnswer::kClear;
        for (const PreparedPolygon& polygon : polygons) {
          const RayAnswer one =
              castAt(polygon, scene.view.eye, point, scene.view.z_near, scene.view.forward, 1e-3);
          answer = one == RayAnswer::kBlocked || answer == RayAnswer::kBlocked ? RayAnswer::kBlocked
                   : one == RayAnswer::kUndecided                              ? one
                                                                               : answer;
        }
        if (answer == RayAnswer::kUndecided) {
          continue;
        }
        const bool blocked = answer == RayAnswer::kBlocked;
        EXPECT_EQ(at(tree, point - scene.view.eye) == Visibility::kHidden, blocked)
            << "seed " << seed << (modified ? ", modified" : ", standard");
        (blocked ? hidden : seen) += 1;
      }
    }
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(seen, 200);
}

TEST(TreeShape, TheModifiedTreeHasTheStandardOnesPlanesWithoutTheRepeatedOnes) {
  int repeated = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomScene scene(kMetres, seed);
    const OccluderSet set = setOf(scene.polygons);
    const TreeShape standard = shapeOfTree(scene.view, set, all(set), false);
    const TreeShape modified = shapeOfTree(scene.view, set, all(set), true);
    const auto isRepeated = [](const TreeShapeNode& node) { return node.repeated; };
    EXPECT_TRUE(std::none_of(modified.nodes.begin(), modified.nodes.end(), isRepeated));
    const auto flagged = std::count_if(standard.nodes.begin(), standard.nodes.end(), isRepeated);
    EXPECT_EQ(modified.nodes.size(), standard.nodes.size() - static_cast<std::size_t>(flagged))
        << "seed " << seed;
    EXPECT_EQ(modified.leaves.size(), standard.leaves.size()) << "seed " << seed;
    repeated += static_cast<int>(flagged);
  }
  EXPECT_GT(repeated, 40);
}

TEST(TreeShape, ComparingWithPlanesAloneFindsNoMoreHiddenThanTheLibrary) {
  int partial = 0, hidden = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RandomScene scene(kMetres, seed);
    if (scene.view.orthographic) {
      continue;
    }
    const OccluderSet set = setOf(scene.polygons);
    const TreeShape shape = shapeOfTree(scene.view, set, all(set), true);
    OcclusionTree tree({.variant = OcclusionTreeVariant::kFMC});
    tree.build(scene.view, set, all(set));
    for (int i = 0; i < 100; ++i) {
      const Box box = scene.randomBox();
      const Visibility by_planes = classifyUncut(shape, scene.view.eye, box);
      if (by_planes == Visibility::kHidden) {
        std::mt19937_64 random(seed);
        EXPECT_FALSE(lookAt(box, scene.view, scene.polygons, 200, random).seen) << "seed " << seed;
      }
      const Visibility here = tree.classify(box);
      hidden += here == Visibility::kHidden ? 1 : 0;
      partial += here == Visibility::kHidden && by_planes != Visibility::kHidden ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 100);
  EXPECT_GT(partial, 0) << "no box shows the difference";
}

TEST(TreeShape, NamesTheLeavesThatASearchReaches) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -4)};
  const OccluderSet set = setOf(walls);
  const TreeShape tree = shapeOfTree(kLookingBack, set, all(set), true);
  const auto reached = [&](const Box& box) {
    std::vector<TreePlace> leaves;
    classifyUncut(tree, kLookingBack.eye, box, &leaves);
    return leaves;
  };
  const std::vector<TreePlace> behind = reached({{-0.1f, -0.1f, -9.0f}, {0.1f, 0.1f, -8.0f}});
  ASSERT_EQ(behind.size(), 1u);
  EXPECT_EQ(tree.at(behind.front()).kind, TreeBranch::Kind::kShadow);
  // Across the wall's right edge: the shadow, and the light beside it.
  EXPECT_EQ(reached({{1.0f, -0.1f, -8.0f}, {3.0f, 0.1f, -7.0f}}).size(), 2u);
  EXPECT_EQ(tree.at({}).kind, TreeBranch::Kind::kNode) << "above the root";
}

}  // namespace
}  // namespace sightline
