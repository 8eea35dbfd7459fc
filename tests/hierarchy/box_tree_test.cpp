#include "sightline/hierarchy/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "scenes/procedural.h"
#include "sightline/hierarchy/hierarchy.h"
#include "tests/hierarchy/box_families.h"
#include "tests/support/object_arrays.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace box_families;

constexpr std::uint32_t kMaxTriangles = 0xffffffffu;

// Reads a tree by its links alone, from the last node to the first, and compares all that the header
// promises. Empty when nothing is wrong.
std::string whatIsWrong(const BoxTree& built, std::span<const Box> boxes,
                        std::span<const std::uint32_t> triangles = {}) {
  const BoxTreeView tree = built.view();
  std::string findings;
  const auto expect = [&](bool right, const char* what, std::size_t where) {
    if (!right && findings.size() < 300) {
      findings += std::string(what) + " (" + std::to_string(where) + "); ";
    }
  };
  std::vector<std::uint32_t> named(boxes.size(), 0);
  for (const ObjectId object : tree.objects) {
    expect(object.value < boxes.size(), "no such object", object.value);
    ++named[object.value];
  }
  for (std::size_t i = 0; i < named.size(); ++i) {
    expect(named[i] == 1, "object not named once", i);
  }
  if (boxes.empty()) {
    expect(tree.nodes.empty(), "nodes without objects", 0);
    return findings;
  }
  const auto count = static_cast<std::uint32_t>(tree.nodes.size());
  if (count == 0 || tree.nodes[0].end != count) {
    return "no root of all nodes";
  }
  std::uint32_t next_object = 0;  // of the leaves, in their order
  for (std::uint32_t n = 0; n < count; ++n) {
    const BoxNode& node = tree.nodes[n];
    expect(node.end > n && node.end <= count, "wrong end", n);
    expect(node.first_object == next_object, "objects not leaf after leaf", n);
    if (tree.leaf(n)) {
      expect(node.object_count == 1, "leaf without one object", n);
      const ObjectId object = tree.objectsBelow(n)[0];
      const Box& box = boxes[object.value];
      const bool infinite = std::isinf(node.bounds.min.x) && std::isinf(node.bounds.max.x) &&
                            std::isinf(node.bounds.min.y) && std::isinf(node.bounds.max.y) &&
                            std::isinf(node.bounds.min.z) && std::isinf(node.bounds.max.z);
      expect(box.wellFormed() ? node.bounds == box : infinite, "wrong box of a leaf", n);
      expect(node.triangles == (triangles.empty() ? 1 : triangles[object.value]), "wrong triangles", n);
      ++next_object;
      continue;
    }
    Box bounds;
    std::uint64_t objects = 0, sum = 0, children = 0;
    for (std::uint32_t child = n + 1; child < node.end; child = tree.nodes[child].end) {
      bounds.extend(tree.nodes[child].bounds);
      objects += tree.nodes[child].object_count;
      sum += tree.nodes[child].triangles;
      expect(tree.nodes[child].end > child && tree.nodes[child].end <= node.end, "child leaves its parent",
             child);
      ++children;
      if (tree.nodes[child].end <= child) {
        return findings;
      }
    }
    expect(children >= 2, "inner node with one child", n);
    expect(bounds == node.bounds, "bounds not those of the children", n);
    expect(objects == node.object_count, "wrong number of objects", n);
    expect(std::min<std::uint64_t>(sum, kMaxTriangles) == node.triangles, "wrong sum of triangles", n);
  }
  return findings;
}

// Children of the inner nodes, and levels.
struct Shape {
  std::uint32_t max_children = 0, depth = 0;
};
Shape shapeOf(const BoxTree& tree) {
  Shape shape;
  std::vector<std::uint32_t> level(tree.nodes.size(), 1);
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    shape.depth = std::max(shape.depth, level[n]);
    std::uint32_t children = 0;
    for (std::uint32_t c = n + 1; c < tree.nodes[n].end; c = tree.nodes[c].end) {
      level[c] = level[n] + 1;
      ++children;
    }
    shape.max_children = std::max(shape.max_children, children);
  }
  return shape;
}

// Boxes that a random ray through the root is expected to be compared with.
double costOf(const BoxTree& tree) {
  double cost = 0.0;
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    for (std::uint32_t c = n + 1; c < tree.nodes[n].end; c = tree.nodes[c].end) {
      cost += surfaceArea(tree.nodes[n].bounds) / surfaceArea(tree.nodes[0].bounds);
    }
  }
  return cost;
}
double costOf(const Hierarchy& hierarchy) {
  double cost = 0.0;
  for (const HierarchyNode& node : hierarchy.nodes) {
    cost += node.leaf() ? 0.0 : 2.0 * surfaceArea(node.bounds) / surfaceArea(hierarchy.nodes[0].bounds);
  }
  return cost;
}

// The cost of a balanced tree of eight children a node over the boxes in this order.
double costInOrder(std::span<const Box> boxes, double root_area) {
  if (boxes.size() < 2) {
    return 0.0;
  }
  Box all;
  for (const Box& box : boxes) {
    all.extend(box);
  }
  const std::size_t parts = std::min<std::size_t>(8, boxes.size());
  double cost = static_cast<double>(parts) * surfaceArea(all) / root_area;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t begin = boxes.size() * i / parts, end = boxes.size() * (i + 1) / parts;
    cost += costInOrder(boxes.subspan(begin, end - begin), root_area);
  }
  return cost;
}

bool same(const BoxTree& a, const BoxTree& b) {
  return a.objects == b.objects &&
         std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(),
                    [](const BoxNode& x, const BoxNode& y) {
                      return x.bounds == y.bounds && x.end == y.end && x.first_object == y.first_object &&
                             x.object_count == y.object_count && x.triangles == y.triangles;
                    });
}

constexpr const char* kScenes[] = {"demo:city?copies=3", "demo:building",
                                   "demo:boxes?buildings=400&boxes=4000", "demo:ship"};

TEST(BoxTree, OfNothingIsEmptyAndOfOneObjectIsALeaf) {
  EXPECT_TRUE(buildBoxTree({}, {}).nodes.empty());
  EXPECT_TRUE(buildBoxTree({}, {}).objects.empty());
  const std::vector<Box> one{{{0, 0, 0}, {1, 2, 3}}};
  const std::vector<std::uint32_t> triangles{7};
  const BoxTree tree = buildBoxTree(one, triangles);
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_TRUE(tree.view().leaf(0));
  EXPECT_EQ(whatIsWrong(tree, one, triangles), "");
}

TEST(BoxTree, OfTwoObjectsIsARootAndTwoLeaves) {
  const std::vector<Box> two{{{0, 0, 0}, {1, 1, 1}}, {{5, 0, 0}, {6, 1, 1}}};
  const BoxTree tree = buildBoxTree(two, {});
  EXPECT_EQ(tree.nodes.size(), 3u);
  EXPECT_EQ(whatIsWrong(tree, two), "");
}

// Objects are not moved after they are inserted, so that the first ones may stay in bad company.
TEST(BoxTree, HardlyAnyNodeMixesDistantClusters) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    // A hundred metres apart; objects of even numbers are in the one, the others in the other.
    Random random(seed);
    std::vector<Box> boxes;
    for (std::uint32_t i = 0; i < 100; ++i) {
      boxes.push_back(around(random.point(1.0) + Vec3d(i % 2 == 0 ? -50.0 : 50.0, 0, 0), {0.2, 0.2, 0.2}));
    }
    const BoxTree tree = buildBoxTree(boxes, {});
    ASSERT_EQ(whatIsWrong(tree, boxes), "") << "seed " << seed;
    std::size_t mixing = 0;
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
      const auto below = tree.view().objectsBelow(n);
      mixing += std::any_of(below.begin(), below.end(),
                            [&](ObjectId object) { return object.value % 2 != below[0].value % 2; });
    }
    EXPECT_LE(mixing, 4u) << "seed " << seed;
  }
}

TEST(BoxTree, EveryFamilyOfBoxesKeepsWhatTheHeaderPromises) {
  for (const Family family : kFamilies) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      Random random(seed);
      const std::vector<Box> boxes = boxesOf(family, 1 + random.below(700), random);
      std::vector<std::uint32_t> triangles;
      for (std::size_t i = 0; i < boxes.size() && seed % 2 == 0; ++i) {
        triangles.push_back(static_cast<std::uint32_t>(random.below(900)));
      }
      const BoxTree tree = buildBoxTree(boxes, triangles);
      EXPECT_EQ(whatIsWrong(tree, boxes, triangles), "")
          << "family " << static_cast<int>(family) << " seed " << seed;
      EXPECT_LE(shapeOf(tree).max_children, 8u) << "family " << static_cast<int>(family) << " seed " << seed;
    }
  }
}

TEST(BoxTree, HoldsTheDemoScenesAtACostNearThatOfASurfaceAreaHierarchy) {
  for (const char* url : kScenes) {
    const test::ObjectArrays scene(makeDemoScene(url).value());
    const BoxTree tree = buildBoxTree(scene.boxes, scene.triangles);
    EXPECT_EQ(whatIsWrong(tree, scene.boxes, scene.triangles), "") << url;
    const double cost = costOf(tree);
    const double by_area = costOf(buildHierarchy(scene.boxes, {}, {.max_leaf_objects = 1}));
    // Any order: that of the scene is no random one.
    std::vector<Box> shuffled = scene.boxes;
    Random random(9);
    for (std::size_t i = shuffled.size(); i > 1; --i) {
      std::swap(shuffled[i - 1], shuffled[random.below(static_cast<std::uint32_t>(i))]);
    }
    const double at_random = costInOrder(shuffled, surfaceArea(tree.nodes[0].bounds));
    EXPECT_LT(cost, 1.5 * by_area) << url;
    EXPECT_LT(cost, 0.2 * at_random) << url << " of " << at_random;
  }
}

TEST(BoxTree, ObjectsWithEmptyOrNonFiniteBoxesAreInfiniteLeavesBelowTheRoot) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Box bad[] = {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{0, 0, 0}, {1, inf, 1}},
                     Box{{2, 0, 0}, {1, 1, 1}}, Box{{nan, nan, nan}, {nan, nan, nan}}};
  for (const std::size_t good : {0u, 1u, 2u, 50u}) {
    Random random(5 + good);
    std::vector<Box> boxes = boxesOf(Family::kScattered, good, random);
    for (const Box& box : bad) {
      const std::uint32_t at = random.below(static_cast<std::uint32_t>(boxes.size()) + 1);
      boxes.insert(boxes.begin() + static_cast<std::ptrdiff_t>(at), box);
    }
    const BoxTree tree = buildBoxTree(boxes, {});
    EXPECT_EQ(whatIsWrong(tree, boxes), "") << "with " << good << " good boxes";
    std::size_t broken = 0, finite = 0;
    for (std::uint32_t c = 1; c < tree.nodes[0].end; c = tree.nodes[c].end) {
      const bool infinite = std::isinf(tree.nodes[c].bounds.max.x);
      EXPECT_TRUE(tree.view().leaf(c) || !infinite);
      broken += infinite ? 1 : 0;
      finite += infinite ? 0 : tree.nodes[c].object_count;
    }
    EXPECT_EQ(broken, std::size(bad)) << "with " << good << " good boxes";
    EXPECT_EQ(finite, good);
    EXPECT_TRUE(std::isinf(tree.nodes[0].bounds.min.y));
  }
  const std::vector<Box> lone{Box{}};
  const BoxTree tree = buildBoxTree(lone, {});
  EXPECT_EQ(tree.nodes.size(), 1u);
  EXPECT_EQ(whatIsWrong(tree, lone), "");
}

TEST(BoxTree, BoxesWhoseExtentOverflowsKeepTheStructure) {
  const float most = std::numeric_limits<float>::max();
  std::vector<Box> boxes;
  for (int i = 0; i < 60; ++i) {
    boxes.push_back({{-most, -most, -most}, {most, most / static_cast<float>(1 + i % 7), most}});
    boxes.push_back({{most, 0, 0}, {most, 0, 0}});
  }
  const BoxTree tree = buildBoxTree(boxes, {});
  EXPECT_EQ(whatIsWrong(tree, boxes), "");
  EXPECT_LE(shapeOf(tree).depth, 10u);
}

TEST(BoxTree, CountsOfTrianglesSaturate) {
  const std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}, {{9, 0, 0}, {10, 1, 1}}};
  const std::vector<std::uint32_t> triangles{3000000000u, 3000000000u, 5u};
  const BoxTree tree = buildBoxTree(boxes, triangles);
  EXPECT_EQ(whatIsWrong(tree, boxes, triangles), "");
  EXPECT_EQ(tree.nodes[0].triangles, kMaxTriangles);
}

// What makes trees deep, wide, or slow to build where nothing bounds them.
TEST(BoxTree, NoInputMakesItDeepOrWide) {
  const std::size_t count = test::rounds<std::size_t>(60000);
  Random random(31);
  std::vector<std::pair<const char*, std::vector<Box>>> inputs;
  inputs.emplace_back("identical", std::vector<Box>(count, Box{{1, 1, 1}, {2, 2, 2}}));
  inputs.emplace_back("points in one place", std::vector<Box>(count, Box{{1, 1, 1}, {1, 1, 1}}));
  inputs.emplace_back("nested", boxesOf(Family::kNested, count, random));
  inputs.emplace_back("scattered", boxesOf(Family::kScattered, count, random));
  inputs.emplace_back("large", boxesOf(Family::kLarge, count, random));
  std::vector<Box> line, doubling, corner;
  for (std::size_t i = 0; i < count; ++i) {
    const double k = static_cast<double>(i), exponent = k * 120.0 / static_cast<double>(count);
    line.push_back(around({k, 0, 0}, {0.4, 0, 0}));
    doubling.push_back(around(Vec3d(1, 0, 0) * std::exp2(exponent), {0.1, 0.1, 0.1}));
    corner.push_back({{0, 0, 0}, Vec3f(Vec3d(1, 1, 1) * std::exp2(exponent))});
  }
  inputs.emplace_back("line", std::move(line));
  inputs.emplace_back("doubling distances", std::move(doubling));
  inputs.emplace_back("doubling boxes with one corner", std::move(corner));
  for (const auto& [name, boxes] : inputs) {
    const BoxTree tree = buildBoxTree(boxes, {});
    EXPECT_EQ(whatIsWrong(tree, boxes), "") << name;
    EXPECT_LE(shapeOf(tree).max_children, 8u) << name;
    EXPECT_LE(shapeOf(tree).depth, 64u) << name;
  }
}

TEST(BoxTree, IsTheSameWhenBuiltTwice) {
  for (const Family family : kFamilies) {
    Random random(23);
    const std::vector<Box> boxes = boxesOf(family, 500, random);
    EXPECT_TRUE(same(buildBoxTree(boxes, {}), buildBoxTree(boxes, {}))) << static_cast<int>(family);
  }
}

}  // namespace
}  // namespace sightline
