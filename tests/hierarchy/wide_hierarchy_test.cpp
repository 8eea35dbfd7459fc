#include "src/hierarchy/wide_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "tests/hierarchy/box_families.h"

namespace sightline::hierarchy {
namespace {

using namespace box_families;

constexpr HierarchyKind kKinds[] = {HierarchyKind::kKdTree, HierarchyKind::kBvh};

// Ids of the objects below a wide node, through its children, sorted.
std::vector<ObjectId> reached(const WideHierarchy& wide, std::uint32_t node) {
  const WideNode& n = wide.nodes[node];
  std::vector<ObjectId> ids;
  for (std::uint32_t i = n.first_child; i < n.child_end; ++i) {
    const std::uint32_t place = i - n.first_child;
    if (place < n.node_count) {
      const std::vector<ObjectId> below = reached(wide, n.first_node + place);
      ids.insert(ids.end(), below.begin(), below.end());
    } else {
      ids.push_back(wide.object[i]);
    }
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

// Empty when the wide hierarchy is what its header says of this binary one.
std::string whatIsWrong(const WideHierarchy& wide, const Hierarchy& hierarchy, std::span<const Box> bounds) {
  std::vector<int> named(wide.nodes.size(), 0);
  for (std::uint32_t node = 0; node < wide.nodes.size(); ++node) {
    const WideNode& n = wide.nodes[node];
    const std::string where = " at node " + std::to_string(node);
    if (n.first_child >= n.child_end || n.child_end > wide.boxes.size()) {
      return "children" + where;
    }
    const std::uint32_t count = n.child_end - n.first_child;
    if (count > kWideChildren && n.node_count > 0) {
      return "too many children" + where;
    }
    std::vector<ObjectId> range(hierarchy.objects.begin() + n.first_object,
                                hierarchy.objects.begin() + n.object_end);
    std::sort(range.begin(), range.end());
    if (range != reached(wide, node)) {
      return "the range of objects" + where;
    }
    std::uint32_t cost = HierarchyNode::kMaxCost;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Box& box = wide.boxes[n.first_child + i];
      if (i >= n.node_count) {
        const Box& own = bounds[wide.object[n.first_child + i].value];
        if (!(box == own) && own.wellFormed()) {
          return "an object's box" + where;
        }
        continue;
      }
      const WideNode& child = wide.nodes[n.first_node + i];
      ++named[n.first_node + i];
      if (child.cost > cost) {
        return "the order of costs" + where;
      }
      cost = child.cost;
      if (hierarchy.kind != HierarchyKind::kBvh) {
        continue;  // a kd-tree's boxes hold what is in their region only
      }
      for (std::uint32_t below = child.first_child; below < child.child_end; ++below) {
        if (wide.boxes[below].wellFormed() && !contains(box, wide.boxes[below])) {
          return "a child sticks out" + where;
        }
      }
    }
  }
  for (std::size_t node = 0; node < named.size(); ++node) {
    if (named[node] != (node == 0 ? 0 : 1)) {
      return "node " + std::to_string(node) + " has " + std::to_string(named[node]) + " parents";
    }
  }
  return "";
}

TEST(WideHierarchy, HoldsWhatTheBinaryOneHolds) {
  for (const HierarchyKind kind : kKinds) {
    for (const Family family : kFamilies) {
      for (const std::size_t count : {1, 2, 3, 15, 16, 17, 18, 33, 400, 1500}) {
        Random random(count);
        const std::vector<Box> boxes = boxesOf(family, count, random);
        const Hierarchy hierarchy = buildHierarchy(
            boxes, {}, {.kind = kind, .max_leaf_objects = static_cast<std::uint32_t>(1 + count % 4)});
        EXPECT_EQ(whatIsWrong(collapse(hierarchy, boxes), hierarchy, boxes), "")
            << (kind == HierarchyKind::kBvh ? "bvh" : "kd-tree") << " family " << static_cast<int>(family)
            << ", " << count << " boxes";
      }
    }
  }
}

TEST(WideHierarchy, OfNothingHasNoNodes) {
  const Hierarchy hierarchy = buildHierarchy({}, {});
  EXPECT_TRUE(collapse(hierarchy, {}).nodes.empty());
}

TEST(WideHierarchy, ReachesObjectsWhoseBoxesAreNotWellFormed) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const HierarchyKind kind : kKinds) {
    for (const std::size_t good : {0, 3, 100}) {
      Random random(good);
      std::vector<Box> boxes = boxesOf(Family::kScattered, good, random);
      for (const Box& box : {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{0, 0, 0}, {1, inf, 1}}}) {
        const std::uint32_t at = random.below(static_cast<std::uint32_t>(boxes.size()) + 1);
        boxes.insert(boxes.begin() + static_cast<std::ptrdiff_t>(at), box);
      }
      const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind});
      const WideHierarchy wide = collapse(hierarchy, boxes);
      EXPECT_EQ(whatIsWrong(wide, hierarchy, boxes), "");
      std::vector<ObjectId> ids = reached(wide, 0);
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      EXPECT_EQ(ids.size(), boxes.size());
    }
  }
}

TEST(WideHierarchy, LeavesOfManyObjectsKeepThemTogether) {
  const std::vector<Box> boxes(1000, Box{{1, 1, 1}, {2, 2, 2}});
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = kind, .max_leaf_objects = 1000});
    const WideHierarchy wide = collapse(hierarchy, boxes);
    EXPECT_EQ(whatIsWrong(wide, hierarchy, boxes), "");
    ASSERT_EQ(wide.nodes.size(), 1u);
    EXPECT_EQ(wide.nodes[0].child_end, 1000u);
  }
}

TEST(WideHierarchy, OpensTheLargestChildFirst) {
  // Two clusters far from each other; one is twenty times as large as the other, in every direction.
  Random random(3);
  std::vector<Box> boxes;
  for (int i = 0; i < 2000; ++i) {
    const bool large = i % 2 == 0;
    boxes.push_back(around(Vec3d(large ? 1000.0 : 0.0, 0, 0) + random.point(large ? 200.0 : 10.0),
                           Vec3d(1, 1, 1) * (large ? 1.0 : 0.05)));
  }
  const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = HierarchyKind::kBvh});
  const WideHierarchy wide = collapse(hierarchy, boxes);
  const WideNode& root = wide.nodes[0];
  int in_small = 0;
  for (std::uint32_t i = 0; i < root.node_count; ++i) {
    in_small += wide.boxes[root.first_child + i].max.x < 100.0f ? 1 : 0;
  }
  EXPECT_GT(root.node_count, 8);
  EXPECT_EQ(in_small, 1) << "the small cluster is one child, the large one many";
}

TEST(WideHierarchy, TakesFewerThanFortyEightBytesForAnObject) {
  Random random(7);
  for (const Family family :
       {Family::kScattered, Family::kTouching, Family::kSeaOfSmall, Family::kIdentical}) {
    const std::vector<Box> boxes = boxesOf(family, 20000, random);
    const Hierarchy hierarchy = buildHierarchy(boxes, {}, {.kind = HierarchyKind::kBvh});
    EXPECT_LT(collapse(hierarchy, boxes).bytes(), 48 * boxes.size()) << static_cast<int>(family);
  }
}

}  // namespace
}  // namespace sightline::hierarchy
