#include "sightline/hierarchy/hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "scenes/procedural.h"
#include "tests/hierarchy/box_families.h"
#include "tests/support/object_arrays.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace box_families;

constexpr HierarchyKind kKinds[] = {HierarchyKind::kKdTree, HierarchyKind::kBvh};

std::string nameOf(HierarchyKind kind) {
  return kind == HierarchyKind::kKdTree ? "kd-tree" : "bvh";
}

// Walks the nodes as their links say and compares all that is promised of them. Empty when nothing is wrong.
class Inspector {
 public:
  Inspector(const Hierarchy& hierarchy, std::span<const Box> boxes, std::span<const std::uint32_t> cost)
      : hierarchy_(hierarchy), boxes_(boxes), cost_(cost), entries_(boxes.size(), 0) {}

  std::string findings() {
    if (hierarchy_.object_count != boxes_.size()) {
      return "wrong number of objects";
    }
    if (boxes_.empty()) {
      return hierarchy_.nodes.empty() && hierarchy_.objects.empty() ? "" : "nodes without objects";
    }
    if (hierarchy_.nodes.empty()) {
      return "no nodes";
    }
    visit(NodeIndex(0u), 1);
    expect(next_node_ == hierarchy_.nodes.size(), "nodes outside the tree", 0);
    expect(next_entry_ == hierarchy_.objects.size(), "entries outside the leaves", 0);
    expect(depth_ == hierarchy_.depth, "wrong depth", 0);
    std::uint32_t duplicates = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      expect(entries_[i] > 0, "object in no leaf", i);
      expect(entries_[i] == 1 || hierarchy_.kind == HierarchyKind::kKdTree, "object in two leaves", i);
      duplicates += entries_[i] - std::min(entries_[i], 1u);
    }
    expect(duplicates == hierarchy_.duplicates(), "wrong number of duplicates", 0);
    return findings_;
  }

 private:
  void expect(bool right, const char* what, std::size_t where) {
    if (!right && findings_.size() < 200) {
      findings_ += std::string(what) + " (" + std::to_string(where) + "); ";
    }
  }

  // Returns the entries below the node, as its leaves name them.
  std::vector<ObjectId> visit(NodeIndex index, std::uint32_t level) {
    expect(index.value == next_node_++, "not in depth-first order", index.value);
    depth_ = std::max(depth_, level);
    const HierarchyNode& node = hierarchy_.nodes[index.value];
    std::vector<ObjectId> below;
    if (node.leaf()) {
      expect(node.link == next_entry_, "entries not leaf after leaf", index.value);
      for (const ObjectId object : hierarchy_.objectsBelow(index)) {
        below.push_back(object);
        ++entries_[object.value];
        const Box& box = boxes_[object.value];
        expect(!box.wellFormed() || overlaps(node.bounds, box), "leaf far from its object", index.value);
        expect(box.wellFormed() || surfaceArea(node.bounds) == std::numeric_limits<double>::infinity(),
               "bad box in a finite leaf", index.value);
      }
      expect(!below.empty(), "empty leaf", index.value);
      next_entry_ += static_cast<std::uint32_t>(below.size());
    } else {
      for (const NodeIndex child : {hierarchy_.left(index), hierarchy_.right(index)}) {
        expect(contains(node.bounds, hierarchy_.nodes[child.value].bounds), "child outside its parent",
               child.value);
        const std::vector<ObjectId> part = visit(child, level + 1);
        below.insert(below.end(), part.begin(), part.end());
      }
    }
    expect(hierarchy_.end(index) == next_node_, "wrong end", index.value);
    const std::span<const ObjectId> claimed = hierarchy_.objectsBelow(index);
    expect(std::equal(claimed.begin(), claimed.end(), below.begin(), below.end()), "wrong objectsBelow",
           index.value);
    expect(node.cost == costOf(below), "wrong cost", index.value);
    return below;
  }

  std::uint32_t costOf(std::vector<ObjectId> objects) const {
    std::sort(objects.begin(), objects.end());
    objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
    std::uint64_t sum = 0;
    for (const ObjectId object : objects) {
      sum += cost_.empty() ? 1 : cost_[object.value];
    }
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, 0x7fffffff));
  }

  const Hierarchy& hierarchy_;
  std::span<const Box> boxes_;
  std::span<const std::uint32_t> cost_;
  std::vector<std::uint32_t> entries_;  // by object
  std::uint32_t next_node_ = 0, next_entry_ = 0, depth_ = 0;
  std::string findings_;
};

std::string whatIsWrong(const Hierarchy& hierarchy, std::span<const Box> boxes,
                        std::span<const std::uint32_t> cost = {}) {
  return Inspector(hierarchy, boxes, cost).findings();
}

bool inside(const Box& box, const Vec3d& p) {
  return box.min.x <= p.x && p.x <= box.max.x && box.min.y <= p.y && p.y <= box.max.y && box.min.z <= p.z &&
         p.z <= box.max.z;
}

// The number of sampled points of the objects' boxes that lie in no leaf that names the object.
std::size_t uncoveredPoints(const Hierarchy& hierarchy, std::span<const Box> boxes, int samples,
                            Random& random) {
  std::vector<std::vector<std::uint32_t>> leaves_of(boxes.size());
  for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.leaf()) {
      for (const ObjectId object : hierarchy.objectsBelow(NodeIndex(n))) {
        leaves_of[object.value].push_back(n);
      }
    }
  }
  std::size_t uncovered = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int s = 0; s < samples; ++s) {
      const Vec3d p = s == 0   ? Vec3d(boxes[i].min)
                      : s == 1 ? Vec3d(boxes[i].max)
                               : pointWithin(boxes[i], random);
      uncovered += std::none_of(leaves_of[i].begin(), leaves_of[i].end(),
                                [&](std::uint32_t n) { return inside(hierarchy.nodes[n].bounds, p); })
                       ? 1
                       : 0;
    }
  }
  return uncovered;
}

bool sameBits(const Hierarchy& a, const Hierarchy& b) {
  return a.nodes.size() == b.nodes.size() && a.objects == b.objects && a.depth == b.depth &&
         std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(HierarchyNode)) == 0;
}

TEST(Hierarchy, NodesAreThirtyTwoBytes) {
  EXPECT_EQ(sizeof(HierarchyNode), 32u);
}

TEST(Hierarchy, EveryFamilyOfBoxesKeepsWhatTheHeaderPromises) {
  for (const HierarchyKind kind : kKinds) {
    for (const Family family : kFamilies) {
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Random random(seed);
        const std::vector<Box> boxes = boxesOf(family, 1 + random.below(700), random);
        std::vector<std::uint32_t> cost;
        for (std::size_t i = 0; i < boxes.size() && seed % 2 == 0; ++i) {
          cost.push_back(static_cast<std::uint32_t>(random.below(900)));
        }
        const HierarchySettings settings{.kind = kind,
                                         .max_leaf_objects = static_cast<std::uint32_t>(1 + random.below(5))};
        const Hierarchy hierarchy = buildHierarchy(boxes, cost, settings);
        EXPECT_EQ(whatIsWrong(hierarchy, boxes, cost), "")
            << nameOf(kind) << " family " << static_cast<int>(family) << " seed " << seed;
      }
    }
  }
}

TEST(Hierarchy, EachPointOfAnObjectsBoxLiesInALeafThatNamesTheObject) {
  for (const HierarchyKind kind : kKinds) {
    for (const Family family : kFamilies) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Random random(seed);
        const std::vector<Box> boxes = boxesOf(family, 300, random);
        const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind, .max_leaf_objects = 1});
        EXPECT_EQ(uncoveredPoints(hierarchy, boxes, 40, random), 0u)
            << nameOf(kind) << " family " << static_cast<int>(family) << " seed " << seed;
      }
    }
  }
}

TEST(Hierarchy, TheRootEnclosesAllBoxesTightly) {
  for (const HierarchyKind kind : kKinds) {
    Random random(3);
    const std::vector<Box> boxes = boxesOf(Family::kLarge, 200, random);
    Box all;
    for (const Box& box : boxes) {
      all.extend(box);
    }
    EXPECT_EQ(buildHierarchy(boxes, {}, {.kind = kind}).nodes[0].bounds, all);
  }
}

TEST(Hierarchy, OfNothingIsEmptyAndOfOneObjectIsALeaf) {
  for (const HierarchyKind kind : kKinds) {
    EXPECT_TRUE(buildHierarchy({}, {}, {.kind = kind}).nodes.empty());
    const std::vector<Box> one{{{0, 0, 0}, {1, 2, 3}}};
    const Hierarchy hierarchy = buildHierarchy(one, {}, {.kind = kind});
    ASSERT_EQ(hierarchy.nodes.size(), 1u);
    EXPECT_TRUE(hierarchy.nodes[0].leaf());
    EXPECT_EQ(hierarchy.nodes[0].bounds, one[0]);
    EXPECT_EQ(hierarchy.depth, 1u);
  }
}

TEST(Hierarchy, OfAHundredThousandObjectsHasSmallLeavesAndLittleDepth) {
  Random random(11);
  const std::vector<Box> boxes = boxesOf(Family::kScattered, test::rounds(100000u), random);
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind});
    EXPECT_EQ(whatIsWrong(hierarchy, boxes), "") << nameOf(kind);
    EXPECT_LE(hierarchy.depth, 50u) << nameOf(kind);
    EXPECT_LT(hierarchy.nodes.size(), 3 * boxes.size()) << nameOf(kind);
    EXPECT_LT(hierarchy.objects.size(), 3 * boxes.size()) << nameOf(kind);
    if (kind == HierarchyKind::kBvh) {
      for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
        EXPECT_LE(hierarchy.nodes[n].leaf() ? hierarchy.objectsBelow(NodeIndex(n)).size() : 0u, 2u);
      }
    }
  }
}

TEST(Hierarchy, ManyIdenticalBoxesFit) {
  const std::vector<Box> boxes(20000, Box{{1, 1, 1}, {2, 2, 2}});
  for (const HierarchyKind kind : kKinds) {
    EXPECT_EQ(whatIsWrong(buildHierarchy(boxes, {}, {.kind = kind}), boxes), "") << nameOf(kind);
    const Hierarchy one_level = buildHierarchy(boxes, {}, {.kind = kind, .max_leaf_objects = 20000});
    EXPECT_EQ(whatIsWrong(one_level, boxes), "") << nameOf(kind);
    EXPECT_EQ(one_level.nodes.size(), 1u) << nameOf(kind);
  }
}

TEST(Hierarchy, KeepsItsDepthLimit) {
  for (const HierarchyKind kind : kKinds) {
    for (const Family family : kFamilies) {
      Random random(17);
      const std::vector<Box> boxes = boxesOf(family, 400, random);
      for (const std::uint32_t max_depth : {1u, 2u, 3u, 7u, 40u}) {
        const Hierarchy hierarchy =
            buildHierarchy(boxes, {}, {.kind = kind, .max_leaf_objects = 1, .max_depth = max_depth});
        EXPECT_LE(hierarchy.depth, max_depth) << nameOf(kind) << " family " << static_cast<int>(family);
        EXPECT_EQ(whatIsWrong(hierarchy, boxes), "")
            << nameOf(kind) << " family " << static_cast<int>(family);
      }
    }
  }
}

TEST(Hierarchy, ObjectsWithEmptyOrNonFiniteBoxesLieInInfiniteLeaves) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Box bad[] = {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{0, 0, 0}, {1, inf, 1}},
                     Box{{2, 0, 0}, {1, 1, 1}}, Box{{nan, nan, nan}, {nan, nan, nan}}};
  for (const HierarchyKind kind : kKinds) {
    for (const std::size_t good : {0, 1, 50}) {
      Random random(5 + good);
      std::vector<Box> boxes = boxesOf(Family::kScattered, good, random);
      for (const Box& box : bad) {
        const std::uint32_t at = random.below(static_cast<std::uint32_t>(boxes.size()) + 1);
        boxes.insert(boxes.begin() + static_cast<std::ptrdiff_t>(at), box);
      }
      const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind});
      EXPECT_EQ(whatIsWrong(hierarchy, boxes), "") << nameOf(kind) << " with " << good << " good boxes";
      std::size_t infinite_leaves = 0;
      for (const HierarchyNode& node : hierarchy.nodes) {
        infinite_leaves += node.leaf() && std::isinf(node.bounds.max.x) ? 1 : 0;
      }
      EXPECT_EQ(infinite_leaves, 1u) << "the good ones keep leaves of their own";
    }
  }
}

TEST(Hierarchy, IsTheSameBitForBitWhenBuiltTwice) {
  for (const HierarchyKind kind : kKinds) {
    for (const Family family : kFamilies) {
      Random random(23);
      const std::vector<Box> boxes = boxesOf(family, 500, random);
      EXPECT_TRUE(
          sameBits(buildHierarchy(boxes, {}, {.kind = kind}), buildHierarchy(boxes, {}, {.kind = kind})));
    }
  }
}

TEST(Hierarchy, CountsAllTrianglesBelowANode) {
  const std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}, {{5, 0, 0}, {6, 1, 1}}, {{9, 0, 0}, {10, 1, 1}}};
  for (const HierarchyKind kind : kKinds) {
    const auto rootCost = [&](std::vector<std::uint32_t> triangles) {
      const Hierarchy hierarchy = buildHierarchy(boxes, triangles, {.kind = kind, .max_leaf_objects = 1});
      EXPECT_EQ(whatIsWrong(hierarchy, boxes, triangles), "") << nameOf(kind);
      return std::uint32_t{hierarchy.nodes[0].cost};
    };
    EXPECT_EQ(rootCost({65'535, 1, 0}), 65'536u);
    EXPECT_EQ(rootCost({1'000'000'000, 70'000, 5}), 1'000'070'005u);
    EXPECT_EQ(rootCost({0xffffffff, 0xffffffff, 1}), HierarchyNode::kMaxCost);
  }
}

TEST(Hierarchy, HoldsACity) {
  const Scene scene = makeCity({.copies = 3});
  const test::ObjectArrays objects(scene);
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(objects.boxes, objects.triangles, {.kind = kind});
    EXPECT_EQ(whatIsWrong(hierarchy, objects.boxes, objects.triangles), "") << nameOf(kind);
  }
}

// A box that reaches from low to high along x, in a slab that is thin along y and z.
Box along(float low, float high) {
  return {{low, 0, 0}, {high, 1, 1}};
}

std::vector<std::uint32_t> namedBelow(const Hierarchy& hierarchy, NodeIndex node) {
  std::vector<std::uint32_t> ids;
  for (const ObjectId object : hierarchy.objectsBelow(node)) {
    ids.push_back(object.value);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

using Ids = std::vector<std::uint32_t>;

TEST(KdTree, SplitsAtTheBoundaryNearTheMedianThatCutsTheFewestBoxes) {
  // Extent 0 to 16, median 8, boundaries looked at: 4 to 12. At 5: cuts box 1; at 7: cuts box 2; at 9.5 and
  // 10: cuts none, and 9.5 is nearer to the median.
  const std::vector<Box> boxes{along(0, 3), along(2, 7), along(5, 9.5f), along(10, 16), along(13, 14)};
  const Hierarchy hierarchy =
      buildHierarchy(boxes, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1, .max_depth = 2});
  ASSERT_EQ(hierarchy.nodes.size(), 3u);
  EXPECT_EQ(namedBelow(hierarchy, NodeIndex(1u)), (Ids{0, 1, 2}));
  EXPECT_EQ(namedBelow(hierarchy, NodeIndex(2u)), (Ids{3, 4}));
  EXPECT_EQ(hierarchy.duplicates(), 0u);
}

TEST(KdTree, LooksForBoundariesWithinTheWindowOnly) {
  // The gap between 13 and 14 cuts nothing but lies outside the window; within, 7 and 8 cut one, 8.5
  // two, and 8 is the median itself.
  const std::vector<Box> boxes{along(0, 7), along(6.5f, 8.75f), along(8.5f, 13), along(8, 13), along(14, 16)};
  const Hierarchy narrow =
      buildHierarchy(boxes, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1, .max_depth = 2});
  ASSERT_EQ(narrow.nodes.size(), 3u);
  EXPECT_EQ(namedBelow(narrow, NodeIndex(1u)), (Ids{0, 1}));
  EXPECT_EQ(namedBelow(narrow, NodeIndex(2u)), (Ids{1, 2, 3, 4}));
  EXPECT_EQ(narrow.duplicates(), 1u);
  // The object on both sides is cut: the leaves' boxes end at the plane.
  EXPECT_EQ(narrow.nodes[1].bounds.max.x, 8.0f);
  EXPECT_EQ(narrow.nodes[2].bounds.min.x, 8.0f);

  const Hierarchy wide = buildHierarchy(
      boxes, {},
      {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1, .max_depth = 2, .median_window = 0.5});
  EXPECT_EQ(namedBelow(wide, NodeIndex(1u)), (Ids{0, 1, 2, 3}));
  EXPECT_EQ(namedBelow(wide, NodeIndex(2u)), (Ids{4}));
  EXPECT_EQ(wide.duplicates(), 0u);
}

TEST(KdTree, SplitsTheLargestAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Box> boxes;
    for (int i = 0; i < 4; ++i) {
      Box box{{0, 0, 0}, {1, 1, 1}};
      box.min[axis] = static_cast<float>(2 * i);
      box.max[axis] = static_cast<float>(2 * i + 1);
      boxes.push_back(box);
    }
    const Hierarchy hierarchy =
        buildHierarchy(boxes, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 2});
    EXPECT_EQ(namedBelow(hierarchy, NodeIndex(1u)), (Ids{0, 1})) << "axis " << axis;
  }
}

struct Expected {
  bool split = false;
  Ids left, right;
};

// The paper's rule, counted box by box.
Expected splitByCounting(std::span<const Box> boxes, double window) {
  const auto n = static_cast<std::uint32_t>(boxes.size());
  double low = boxes[0].min.x, high = boxes[0].max.x;
  for (const Box& box : boxes) {
    low = std::min<double>(low, box.min.x);
    high = std::max<double>(high, box.max.x);
  }
  const double median = 0.5 * (low + high);
  Expected best;
  std::size_t best_cut = 0;
  double best_offset = 0.0;
  for (std::uint32_t c = 0; c < 2 * n; ++c) {
    const float s = c % 2 == 0 ? boxes[c / 2].min.x : boxes[c / 2].max.x;
    const double offset = std::abs(s - median);
    if (offset > window * (high - low) || s <= low || s >= high) {
      continue;
    }
    Expected split;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (boxes[i].min.x < s) {
        split.left.push_back(i);
      }
      if (boxes[i].max.x > s) {
        split.right.push_back(i);
      }
    }
    const std::size_t cut = split.left.size() + split.right.size() - n;
    if (split.left.size() == n || split.right.size() == n) {
      continue;
    }
    if (!best.split || cut < best_cut || (cut == best_cut && offset < best_offset)) {
      best = split;
      best.split = true;
      best_cut = cut;
      best_offset = offset;
    }
  }
  best.split = best.split && 2 * best_cut <= n;
  return best;
}

TEST(KdTree, SplitsAsCountingBoxByBoxSays) {
  int splits = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    std::vector<Box> boxes;
    for (std::uint64_t i = 0; i < 3 + seed % 12; ++i) {
      const double at = random.in(0.0, 100.0);
      boxes.push_back(along(static_cast<float>(at), static_cast<float>(at + random.in(0.5, 40.0))));
    }
    const double window = seed % 3 == 0 ? 0.5 : 0.25;
    const Expected expected = splitByCounting(boxes, window);
    if (!expected.split) {
      continue;
    }
    ++splits;
    const Hierarchy hierarchy = buildHierarchy(
        boxes, {},
        {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1, .max_depth = 2, .median_window = window});
    ASSERT_EQ(hierarchy.nodes.size(), 3u) << "seed " << seed;
    EXPECT_EQ(namedBelow(hierarchy, NodeIndex(1u)), expected.left) << "seed " << seed;
    EXPECT_EQ(namedBelow(hierarchy, NodeIndex(2u)), expected.right) << "seed " << seed;
  }
  EXPECT_GT(splits, 800);
}

TEST(KdTree, DoesNotSplitWhereThatWouldOnlyCopyObjects) {
  const std::vector<Box> nested{along(0, 10), along(1, 9), along(2, 8), along(3, 7), along(4, 6)};
  const Hierarchy hierarchy =
      buildHierarchy(nested, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1});
  EXPECT_EQ(hierarchy.duplicates(), 0u);
  EXPECT_EQ(hierarchy.nodes.size(), 1u);
}

TEST(Bvh, SeparatesTwoClusters) {
  std::vector<Box> boxes;
  for (int i = 0; i < 8; ++i) {
    const float at = static_cast<float>(i) + (i >= 3 ? 100.0f : 0.0f);
    boxes.push_back({{0, at, 0}, {1, at + 1, 1}});
  }
  const Hierarchy hierarchy =
      buildHierarchy(boxes, {}, {.kind = HierarchyKind::kBvh, .max_leaf_objects = 5, .max_depth = 2});
  ASSERT_EQ(hierarchy.nodes.size(), 3u);
  EXPECT_EQ(namedBelow(hierarchy, NodeIndex(1u)), (Ids{0, 1, 2}));
  EXPECT_EQ(namedBelow(hierarchy, NodeIndex(2u)), (Ids{3, 4, 5, 6, 7}));
}

}  // namespace
}  // namespace sightline
