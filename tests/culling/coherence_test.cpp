// Temporal coherence of the traversal: Bittner, Havran, Slavik, CGI 1998, section 5.4.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "sightline/scene/camera.h"
#include "src/culling/hierarchical_traversal.h"

namespace sightline {
namespace {

using culling::AskAll;
using culling::HierarchicalTraversal;
using culling::TraversalBox;

using Nodes = std::vector<std::uint32_t>;

// Four boxes in a row along x. The root has two inner nodes, and each of these has two leaves with one box
// each. Nodes are numbered depth first.
constexpr std::uint32_t kRoot = 0, kLeft = 1, kLeftLeaf0 = 2, kLeftLeaf1 = 3, kRight = 4, kRightLeaf0 = 5,
                        kRightLeaf1 = 6;

class RowOfBoxes : public ::testing::Test {
 protected:
  RowOfBoxes() : hierarchy_(buildHierarchy(bounds_, {}, {.max_leaf_objects = 1})) {
    startAnew();
    view_.eye = {0, 0, 10};
    setOrientation(view_, {0, 0, -1}, {0, 1, 0});
    view_.orthographic = true;
    view_.ortho_height = 100.0;
  }
  void SetUp() override {
    ASSERT_EQ(hierarchy_.nodes.size(), 7u);
    for (const std::uint32_t leaf : {kLeftLeaf0, kLeftLeaf1, kRightLeaf0, kRightLeaf1}) {
      ASSERT_TRUE(hierarchy_.nodes[leaf].leaf());
    }
  }

  // Traverses one frame and returns the nodes that were tested for occlusion, in ascending order. A node is
  // partly visible unless states_ says otherwise.
  Nodes frame() {
    Nodes asked;
    CullStats stats;
    std::vector<ObjectId> visible;
    walk_->run(frustumOf(view_), {}, AskAll{[&](const TraversalBox& box) {
                 asked.push_back(box.item);
                 const auto found = states_.find(box.item);
                 return found == states_.end() ? Visibility::kPartial : found->second;
               }},
               stats, visible);
    std::sort(asked.begin(), asked.end());
    return asked;
  }
  // Makes the next frame a first one, without coherence.
  void startAnew() { walk_.emplace(hierarchy_, bounds_); }
  // Boxes with x below this are outside the frustum.
  void leaveOutBelow(double x) { view_.eye.x = x + 0.5 * view_.ortho_height * view_.aspect; }

  const std::vector<Box> bounds_{Box{{0, 0, 0}, {1, 1, 1}}, Box{{2, 0, 0}, {3, 1, 1}},
                                 Box{{8, 0, 0}, {9, 1, 1}}, Box{{10, 0, 0}, {11, 1, 1}}};
  Hierarchy hierarchy_;
  std::optional<HierarchicalTraversal> walk_;
  View view_;
  std::map<std::uint32_t, Visibility> states_;
};

const Nodes kAllNodes{kRoot, kLeft, kLeftLeaf0, kLeftLeaf1, kRight, kRightLeaf0, kRightLeaf1};
const Nodes kLeavesAlone{kLeftLeaf0, kLeftLeaf1, kRightLeaf0, kRightLeaf1};

using TemporalCoherence = RowOfBoxes;

TEST_F(TemporalCoherence, InnerNodesFoundPartialAreNotAskedAgainAndLeavesAlwaysAre) {
  EXPECT_EQ(frame(), kAllNodes);
  EXPECT_EQ(frame(), kLeavesAlone);
  EXPECT_EQ(frame(), kLeavesAlone);
  startAnew();
  EXPECT_EQ(frame(), kAllNodes);
}

TEST_F(TemporalCoherence, ALeafThatBecomesHiddenOrVisibleHasItsParentAskedInTheNextFrame) {
  for (const Visibility certain : {Visibility::kHidden, Visibility::kVisible}) {
    states_.clear();
    startAnew();
    frame();
    EXPECT_EQ(frame(), kLeavesAlone);
    states_[kLeftLeaf0] = certain;
    EXPECT_EQ(frame(), kLeavesAlone);
    // The parent is found partly visible and marked again, and then the leaf clears the mark.
    const Nodes and_its_parent{kLeft, kLeftLeaf0, kLeftLeaf1, kRightLeaf0, kRightLeaf1};
    EXPECT_EQ(frame(), and_its_parent);
    EXPECT_EQ(frame(), and_its_parent);
    states_.clear();
    EXPECT_EQ(frame(), and_its_parent);
    EXPECT_EQ(frame(), kLeavesAlone);
  }
}

TEST_F(TemporalCoherence, CertaintyClimbsOneLevelAFrame) {
  frame();
  frame();
  for (const std::uint32_t node : {kLeft, kLeftLeaf0, kLeftLeaf1}) {
    states_[node] = Visibility::kHidden;
  }
  EXPECT_EQ(frame(), kLeavesAlone);
  EXPECT_EQ(frame(), (Nodes{kLeft, kRightLeaf0, kRightLeaf1}));
  EXPECT_EQ(frame(), (Nodes{kRoot, kLeft, kRightLeaf0, kRightLeaf1}));
}

TEST_F(TemporalCoherence, WhatLeavesTheFrustumIsCertainToo) {
  frame();
  EXPECT_EQ(frame(), kLeavesAlone);
  leaveOutBelow(1.5);
  EXPECT_EQ(frame(), (Nodes{kLeftLeaf1, kRightLeaf0, kRightLeaf1}));
  EXPECT_EQ(frame(), (Nodes{kLeft, kLeftLeaf1, kRightLeaf0, kRightLeaf1}));
}

TEST_F(TemporalCoherence, AnInnerNodeThatWasOutsideTheFrustumIsAskedWhenItIsBack) {
  frame();
  EXPECT_EQ(frame(), kLeavesAlone);
  const View all = view_;
  leaveOutBelow(5.0);
  EXPECT_EQ(frame(), (Nodes{kRightLeaf0, kRightLeaf1}));
  view_ = all;
  EXPECT_EQ(frame(), (Nodes{kRoot, kLeft, kLeftLeaf0, kLeftLeaf1, kRightLeaf0, kRightLeaf1}));
  EXPECT_EQ(frame(), kLeavesAlone);
}

}  // namespace
}  // namespace sightline
