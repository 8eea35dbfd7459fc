#include "sightline/comparison/traversal_record.h"

#include <gtest/gtest.h>

#include <vector>

#include "sightline/occlusion/occlusion_tree.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

// Walls, and many boxes before and behind them.
struct Walk {
  std::vector<OraclePolygon> walls{wall(-6, -1, -4, 4, -8), wall(1, 5, -4, 4, -10), wall(-2, 3, -1, 2, -14)};
  OccluderSet occluders = setOf(walls);
  std::vector<Box> boxes;
  Hierarchy hierarchy;

  Walk() {
    Random random(3);
    for (int i = 0; i < 300; ++i) {
      const Vec3d corner(random.in(-20, 20), random.in(-6, 6), random.in(-40, 2));
      boxes.push_back({Vec3f(corner), Vec3f(corner + Vec3d(0.5, 0.5, 0.5))});
    }
    hierarchy = buildHierarchy(boxes, {}, {.kind = HierarchyKind::kKdTree});
  }
  View view(int frame) const { return viewFrom({0.15 * frame - 2.0, 0.1, 0.0}, {0.02 * frame - 0.2, 0, -1}); }
};

bool certain(NodeVisit visit) {
  return visit == NodeVisit::kHidden || visit == NodeVisit::kVisible || visit == NodeVisit::kNone;
}

enum class Mark { kNo, kYes, kUnknown };

// The marks after a frame. Section 5.4: a node is marked where it is partial, unless a child's state is
// certain; leaves never are. What lies outside the frustum is certain, too. Below visible nodes the traversal
// looks at the frustum alone, and may do so or not.
void updateMarks(const Hierarchy& hierarchy, std::span<const NodeVisit> visits, std::vector<Mark>& marks) {
  for (std::uint32_t n = 0; n < visits.size(); ++n) {
    const NodeIndex node(n);
    if (visits[n] == NodeVisit::kVisible) {
      for (std::uint32_t below = n + 1; below < hierarchy.end(node); ++below) {
        marks[below] = Mark::kUnknown;
      }
    }
    if (visits[n] == NodeVisit::kNone) {
      continue;
    }
    marks[n] = Mark::kNo;
    if (!certain(visits[n]) && !hierarchy.nodes[n].leaf()) {
      const std::uint32_t left = hierarchy.left(node).value, right = hierarchy.right(node).value;
      marks[n] = certain(visits[left]) || certain(visits[right]) ? Mark::kNo : Mark::kYes;
      for (const std::uint32_t child : {left, right}) {
        marks[child] = visits[child] == NodeVisit::kNone ? Mark::kNo : marks[child];
      }
    }
  }
}

TEST(TraversalRecord, SkipsExactlyTheNodesThatThePaperMarks) {
  const Walk walk;
  RecordedTraversal traversal(walk.hierarchy, walk.boxes);
  std::vector<Mark> marks(walk.hierarchy.nodes.size(), Mark::kNo);
  int skipped = 0, tested = 0;
  for (int frame = 0; frame < 30; ++frame) {
    const auto visits = traversal.traverse(walk.view(frame), walk.occluders, all(walk.occluders));
    for (std::size_t n = 0; n < visits.size(); ++n) {
      if (visits[n] == NodeVisit::kNone || marks[n] == Mark::kUnknown) {
        continue;
      }
      EXPECT_EQ(visits[n] == NodeVisit::kSkipped, marks[n] == Mark::kYes)
          << "frame " << frame << ", node " << n;
      (visits[n] == NodeVisit::kSkipped ? skipped : tested) += 1;
    }
    updateMarks(walk.hierarchy, visits, marks);
  }
  EXPECT_GT(skipped, 100);
  EXPECT_GT(tested, 100);
}

TEST(TraversalRecord, StatesAreThoseOfTheTree) {
  const Walk walk;
  RecordedTraversal traversal(walk.hierarchy, walk.boxes, {.temporal_coherence = false});
  int hidden = 0;
  for (int frame = 0; frame < 10; ++frame) {
    OcclusionTree tree;
    tree.build(walk.view(frame), walk.occluders, all(walk.occluders));
    const auto visits = traversal.traverse(walk.view(frame), walk.occluders, all(walk.occluders));
    for (std::size_t n = 0; n < visits.size(); ++n) {
      EXPECT_NE(visits[n], NodeVisit::kSkipped);
      if (visits[n] == NodeVisit::kNone) {
        continue;
      }
      const Visibility state = tree.classify(walk.hierarchy.nodes[n].bounds);
      EXPECT_EQ(visits[n] == NodeVisit::kHidden, state == Visibility::kHidden);
      EXPECT_EQ(visits[n] == NodeVisit::kPartial, state == Visibility::kPartial);
      hidden += visits[n] == NodeVisit::kHidden ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 20);
}

TEST(TraversalRecord, NothingBelowAHiddenNodeIsReached) {
  const Walk walk;
  RecordedTraversal traversal(walk.hierarchy, walk.boxes);
  for (int frame = 0; frame < 10; ++frame) {
    const auto visits = traversal.traverse(walk.view(frame), walk.occluders, all(walk.occluders));
    for (std::uint32_t n = 0; n < visits.size(); ++n) {
      if (visits[n] == NodeVisit::kHidden) {
        for (std::uint32_t below = n + 1; below < walk.hierarchy.end(NodeIndex(n)); ++below) {
          EXPECT_EQ(visits[below], NodeVisit::kNone) << "frame " << frame << ", node " << below;
        }
      }
    }
  }
}

TEST(TraversalRecord, CheapNodesAreNotTested) {
  const Walk walk;
  const std::vector<std::uint32_t> triangles(walk.boxes.size(), 10);
  const Hierarchy hierarchy = buildHierarchy(walk.boxes, triangles, {.kind = HierarchyKind::kKdTree});
  RecordedTraversal traversal(hierarchy, walk.boxes, {.min_node_cost = 50});
  const auto visits = traversal.traverse(walk.view(0), walk.occluders, all(walk.occluders));
  int tested = 0;
  for (std::size_t n = 0; n < visits.size(); ++n) {
    if (visits[n] != NodeVisit::kNone) {
      EXPECT_GE(hierarchy.nodes[n].cost, 50u);
      ++tested;
    }
  }
  EXPECT_GT(tested, 3);
}

}  // namespace
}  // namespace sightline
