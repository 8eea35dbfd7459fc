// The shadow tree must give the same result as testing each box alone, with every instruction set.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/pvs/convex_scenes.h"
#include "tests/support/instruction_sets.h"

namespace sightline {
namespace {

using namespace test;

// A shadow of random planes that belong to no occluder.
Shadow randomShadow(Random& random, std::uint32_t count) {
  Shadow shadow;
  shadow.eye = random.point(5.0);
  shadow.count = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3d normal = randomDirection(random) * random.in(0.01, 10.0);
    normal.x = std::abs(normal.x) * 3.0;  // so that some boxes are behind all planes
    shadow.nx[i] = normal.x;
    shadow.ny[i] = normal.y;
    shadow.nz[i] = normal.z;
    shadow.offset[i] = random.in(0.01, 1.0);
  }
  return shadow;
}

// Depth of the box's outermost corner behind all planes, in extended precision.
long double depthBehind(const Shadow& shadow, const Box& box) {
  using Vec3l = Vec3<long double>;
  long double least = INFINITY;
  for (std::uint32_t i = 0; i < shadow.count; ++i) {
    const Vec3l normal(shadow.nx[i], shadow.ny[i], shadow.nz[i]);
    for (const Vec3d& corner : cornersOf(box)) {
      least = std::min(
          least, dot(normal, Vec3l(corner) - Vec3l(shadow.eye)) - static_cast<long double>(shadow.offset[i]));
    }
  }
  return least;
}

std::vector<Box> randomBoxes(Random& random, std::uint32_t count) {
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double size = std::pow(10.0, random.in(-3.0, 0.5));
    const Vec3d half(size * random.in(0.0, 1.0), random.below(4) == 0 ? 0.0 : size, size);
    boxes.push_back(boxAround(random.point(20.0), half));
  }
  return boxes;
}

void expectRunsInOrder(std::span<const ObjectRun> runs, std::size_t objects, std::uint64_t seed) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_LT(runs[i].begin, runs[i].end) << "seed " << seed;
    EXPECT_LE(runs[i].end, objects) << "seed " << seed;
    EXPECT_TRUE(i == 0 || runs[i - 1].end < runs[i].begin) << "seed " << seed;
  }
}

TEST(ShadowTree, HidesWhatItsBoxesAloneAreBehind) {
  std::size_t hidden_count = 0, seen_count = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const std::vector<Box> boxes = randomBoxes(random, 1 + random.below(seed % 10 == 0 ? 600 : 60));
    const BoxTree tree = halvedTree(boxes, 1 + random.below(14));
    const ShadowTree shadow_tree(tree.view());
    const Shadow shadow = randomShadow(random, seed % 7 == 0 ? 96 : 1 + random.below(8));
    std::vector<ObjectRun> runs;
    shadow_tree.hiddenBy(shadow, runs);
    expectRunsInOrder(runs, boxes.size(), seed);
    const std::set<std::uint32_t> hidden = idsOf(tree, runs);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const long double depth = depthBehind(shadow, boxes[i]);
      ++(depth > 0 ? hidden_count : seen_count);
      if (std::abs(depth) > 1e-9L) {
        EXPECT_EQ(hidden.contains(i), depth > 0) << "seed " << seed << ", box " << i;
      }
    }
  }
  EXPECT_GT(hidden_count, 1000u);
  EXPECT_GT(seen_count, 1000u);
}

TEST(ShadowTree, HidesABoxOnlyIfNoneOfItReachesOverAPlane) {
  Shadow shadow;
  shadow.count = 1;
  shadow.nx[0] = 1.0;
  shadow.ny[0] = shadow.nz[0] = 0.0;
  shadow.offset[0] = 2.0;
  const float beyond = std::nextafter(2.0f, 3.0f), before = std::nextafter(2.0f, 0.0f);
  const std::vector<Box> boxes{{{beyond, 0, 0}, {3, 1, 1}},
                               {{before, 0, 0}, {3, 1, 1}},
                               {{before, 5, 5}, {before, 5, 5}},
                               {{2, 5, 5}, {2, 5, 5}},
                               {{-900, 0, 0}, {900, 1, 1}}};
  const BoxTree tree = halvedTree(boxes);
  std::vector<ObjectRun> runs;
  ShadowTree(tree.view()).hiddenBy(shadow, runs);
  EXPECT_EQ(idsOf(tree, runs), (std::set<std::uint32_t>{0, 3}));
}

TEST(ShadowTree, BoundsTheCornersOfTheLeavesBelow) {
  Random random(5);
  std::vector<Box> boxes = randomBoxes(random, 300);
  for (const std::size_t broken : {7u, 8u, 150u}) {
    boxes[broken].max.x = std::numeric_limits<float>::quiet_NaN();
  }
  const BoxTree tree = buildBoxTree(boxes, {});
  const ShadowTree shadow_tree(tree.view());
  for (std::uint32_t node = 0; node < shadow_tree.nodes().size(); ++node) {
    const ObjectRun& objects = shadow_tree.nodes()[node].objects;
    for (std::uint32_t i = 0; i < 8; ++i) {
      std::vector<Vec3d> corners;
      for (std::uint32_t at = objects.begin; at < objects.end; ++at) {
        const Box& box = boxes[tree.objects[at].value];
        if (box.wellFormed()) {
          corners.push_back(pvs::CellBox{Vec3d(box.min), Vec3d(box.max)}.corner(i));
        }
      }
      ASSERT_EQ(shadow_tree.mayHoldHidden(node), !corners.empty());
      if (corners.empty()) {
        continue;
      }
      const pvs::CellBox found = shadow_tree.cornersBelow(node, i);
      const pvs::CellBox bounds = pvs::boundsOf(corners);
      EXPECT_TRUE(found.min == bounds.min && found.max == bounds.max) << "node " << node << " corner " << i;
    }
  }
}

TEST(ShadowTree, AppendsToWhatIsThere) {
  const std::vector<Box> boxes{{{2, 0, 0}, {3, 1, 1}}};
  const BoxTree tree = halvedTree(boxes);
  Random random(1);
  Shadow shadow = randomShadow(random, 1);
  shadow.eye = {-1e3, 0, 0};
  std::vector<ObjectRun> runs{{7, 9}, {0, 0}};
  ShadowTree(tree.view()).hiddenBy(shadow, runs);
  ShadowTree(tree.view()).hiddenBy(shadow, runs);
  EXPECT_EQ(runs, (std::vector<ObjectRun>{{7, 9}, {0, 0}, {0, 1}, {0, 1}}));
}

TEST(ShadowTree, NeverHidesBoxesThatAreEmptyOrNotFinite) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Shadow shadow;
  shadow.count = 2;
  for (std::uint32_t i = 0; i < 2; ++i) {
    shadow.nx[i] = i == 0 ? 1.0 : 0.5;
    shadow.ny[i] = shadow.nz[i] = 0.0;  // zero times infinity is NaN
    shadow.offset[i] = 1.0;
  }
  const std::vector<Box> bad{{{2, -kInfinity, 0}, {3, kInfinity, 1}},
                             {{2, 0, 0}, {kInfinity, 1, 1}},
                             {{kNan, 0, 0}, {3, 1, 1}},
                             {{2, 0, 0}, {3, kNan, 1}},
                             {{4, 0, 0}, {3, 1, 1}},
                             Box()};
  for (const Box& box : bad) {
    std::vector<Box> boxes(20, Box{{5, 0, 0}, {6, 1, 1}});
    boxes[13] = box;
    BoxTree tree = halvedTree(boxes);
    std::vector<ObjectRun> runs;
    ShadowTree(tree.view()).hiddenBy(shadow, runs);
    EXPECT_EQ(idsOf(tree, runs).size(), 19u);
    EXPECT_FALSE(idsOf(tree, runs).contains(13));
    // The same must hold if the tree gives other boxes for the nodes above.
    for (BoxNode& node : tree.nodes) {
      const bool has_it =
          std::ranges::count(tree.view().objectsBelow(static_cast<std::uint32_t>(&node - tree.nodes.data())),
                             ObjectId(13u)) > 0;
      node.bounds = node.object_count > 1 || !has_it ? Box{{5, 0, 0}, {6, 1, 1}} : box;
    }
    runs.clear();
    ShadowTree(tree.view()).hiddenBy(shadow, runs);
    EXPECT_EQ(idsOf(tree, runs).size(), 19u);
    EXPECT_FALSE(idsOf(tree, runs).contains(13));
  }
}

TEST(ShadowTree, IsEmptyWithoutObjectsAndHidesNothingWithoutPlanes) {
  std::vector<ObjectRun> runs;
  Random random(1);
  ShadowTree(BoxTreeView()).hiddenBy(randomShadow(random, 3), runs);
  EXPECT_TRUE(runs.empty());
  const std::vector<Box> boxes = randomBoxes(random, 5);
  ShadowTree(halvedTree(boxes).view()).hiddenBy(randomShadow(random, 0), runs);
  EXPECT_TRUE(runs.empty());
}

// A chain of a thousand nodes, each with one leaf and one inner node.
TEST(ShadowTree, HidesWhatIsDeepDown) {
  constexpr std::uint32_t kCount = 1000;
  Random random(4);
  const std::vector<Box> boxes = randomBoxes(random, kCount);
  BoxTree tree;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    BoxNode inner, leaf;
    leaf.bounds = boxes[i];
    for (std::uint32_t j = i; j < kCount; ++j) {
      inner.bounds.extend(boxes[j]);
    }
    inner.first_object = leaf.first_object = i;
    inner.object_count = kCount - i;
    leaf.object_count = 1;
    inner.end = 2 * kCount - 1;
    if (i + 1 < kCount) {
      tree.nodes.push_back(inner);
    }
    leaf.end = static_cast<std::uint32_t>(tree.nodes.size()) + 1;
    tree.nodes.push_back(leaf);
    tree.objects.emplace_back(i);
  }
  ASSERT_EQ(tree.nodes.size(), 2 * kCount - 1);
  const ShadowTree shadow_tree(tree.view());
  std::size_t hidden_count = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Shadow shadow = randomShadow(random, 3);
    std::vector<ObjectRun> runs;
    shadow_tree.hiddenBy(shadow, runs);
    expectRunsInOrder(runs, kCount, 4);
    const std::set<std::uint32_t> hidden = idsOf(tree, runs);
    hidden_count += hidden.size();
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const long double depth = depthBehind(shadow, boxes[i]);
      if (std::abs(depth) > 1e-9L) {
        EXPECT_EQ(hidden.contains(i), depth > 0) << "trial " << trial << ", box " << i;
      }
    }
  }
  EXPECT_GT(hidden_count, 500u);
}

TEST(ShadowTree, GivesTheSameRunsFromEveryInstructionSet) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
  std::size_t run_count = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    // Box coordinates are multiples of a quarter and planes multiples of a half, which gives many ties.
    std::vector<Box> boxes = randomBoxes(random, 200);
    Shadow shadow = randomShadow(random, 1 + random.below(9));
    if (seed % 2 == 0) {
      const auto rounded = [](double v) { return std::round(v * 4.0) / 4.0; };
      for (Box& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
          box.min[axis] = static_cast<float>(rounded(static_cast<double>(box.min[axis])));
          box.max[axis] = static_cast<float>(rounded(static_cast<double>(box.max[axis])));
        }
      }
      shadow.eye = {rounded(shadow.eye.x), rounded(shadow.eye.y), rounded(shadow.eye.z)};
      for (std::uint32_t i = 0; i < shadow.count; ++i) {
        shadow.nx[i] = rounded(shadow.nx[i]);
        shadow.ny[i] = rounded(shadow.ny[i]);
        shadow.nz[i] = rounded(shadow.nz[i]);
        shadow.offset[i] = rounded(shadow.offset[i]) + 0.25;
      }
    }
    const BoxTree tree = halvedTree(boxes, 1 + random.below(14));
    const ShadowTree shadow_tree(tree.view());
    std::vector<ObjectRun> first;
    shadow_tree.hiddenBy(shadow, first);
    run_count += first.size();
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      std::vector<ObjectRun> runs;
      shadow_tree.hiddenBy(shadow, runs);
      EXPECT_EQ(runs, first) << "seed " << seed << ", " << hwy::TargetName(target);
    }
  }
  EXPECT_GT(run_count, 200u);
}

}  // namespace
}  // namespace sightline
