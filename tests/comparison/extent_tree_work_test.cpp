#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "src/comparison/layers/extent_tree.h"
#include "tests/comparison/made_extents.h"

namespace sightline::comparison {
namespace {

using namespace made;

TEST(ExtentTree, IsNotDividedAnewWhereNothingMoved) {
  Random random(7);
  ExtentTable table = makeTable(800, kindsOf(3, 0));
  scatter(table, random, 0.02f);
  ExtentTree tree({});
  tree.update(table);
  const ExtentTreeWork before = tree.work();
  tree.update(table);
  EXPECT_EQ(tree.work().nodes_divided, before.nodes_divided);
  EXPECT_EQ(tree.work().parts_moved, before.parts_moved);
  EXPECT_GT(tree.work().nodes_visited, before.nodes_visited);
}

TEST(ExtentTree, DividesAnewOnlyTheNodesAlongWhoseAxisAPartMoved) {
  Random random(8);
  ExtentTable table = makeTable(800, kindsOf(3, 0));
  scatter(table, random, 0.02f);
  ExtentTree tree({});
  tree.update(table);
  // The part moves so little that no list changes its order: no part is handed down, and only nodes of this
  // axis are divided anew.
  std::uint64_t expected = 0;
  const std::uint32_t part = 123;
  const auto nodes = tree.nodes().nodes();
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    if (nodes[node].axis == 1) {
      const auto lows = tree.nodes().lowsOf(node);
      expected += std::any_of(lows.begin(), lows.end(), [&](Bound bound) { return partOf(bound) == part; });
    }
  }
  ASSERT_GT(expected, 0u);
  table.lows[1][part] = std::nextafter(table.lows[1][part], -1.0f);
  const ExtentTreeWork before = tree.work();
  tree.update(table);
  EXPECT_EQ(tree.work().nodes_divided - before.nodes_divided, expected);
}

TEST(ExtentTree, HandsDownAlmostNothingWhenPartsMoveALittle) {
  Random random(9);
  ExtentTable table = makeTable(1000, kindsOf(3, 0));
  for (std::size_t part = 0; part < 1000; ++part) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = uniform(random, 0, 1);
      set(table, axis, part, {low, low + 0.03f});
    }
  }
  ExtentTree tree({});
  tree.update(table);
  const std::uint64_t before = tree.work().parts_moved;
  move(table, random, 0.0005f, 0.03f, 0);
  tree.update(table);
  EXPECT_LT(tree.work().parts_moved - before, 1000u);  // the nodes have some 7000 entries
}

TEST(ExtentTree, IsReplacedByOneMadeInTheBackground) {
  Case one{.seed = 11, .parts = 700, .kinds = kindsOf(3, 4), .settings = {}, .width = 0.05f, .step = 0.02f};
  one.settings.rebuild_after = 5;
  one.settings.rebuild_steps = 7;
  Random random(one.seed);
  ExtentTable table = makeTable(one.parts, one.kinds);
  scatter(table, random, one.width);
  ExtentTree tree(one.settings);
  unsigned frames_making = 0;
  for (unsigned frame = 0; frame < 80; ++frame) {
    tree.update(table);
    const std::uint64_t takeovers = tree.work().takeovers;
    expectAnswers(tree, table, one, random);
    ASSERT_FALSE(HasFailure()) << "frame " << frame;
    EXPECT_EQ(tree.work().takeovers, takeovers);
    frames_making += tree.rebuilding();
    move(table, random, one.step, one.width, 2);
  }
  EXPECT_GE(tree.work().takeovers, 2u);
  EXPECT_GT(frames_making, 10u);  // each new tree takes several frames, in which the old one answers
}

TEST(ExtentTree, IsRebuiltWhenQueriesMeetManyMoreParts) {
  ExtentTreeSettings settings;
  settings.rebuild_imbalance = 1.5;
  Random random(12);
  ExtentTable table = makeTable(600, kindsOf(2, 0));
  // A row of parts along the first axis, and later one along the second, which values along the first cannot
  // divide.
  const auto place = [&](std::size_t axis) {
    for (std::size_t part = 0; part < 600; ++part) {
      const float low = static_cast<float>(part);
      set(table, axis, part, {low, low + 0.5f});
      set(table, 1 - axis, part, {0.0f, 1.0f});
    }
  };
  const auto ask = [&](ExtentTree& tree) {
    std::vector<std::uint32_t> parts;
    for (std::uint32_t part = 0; part < 600; part += 10) {
      parts.clear();
      tree.query({table.at(0, part), table.at(1, part)}, parts);
      EXPECT_EQ(parts, std::vector<std::uint32_t>{part});
    }
  };
  ExtentTree tree(settings);
  place(0);
  for (int frame = 0; frame < 30; ++frame) {
    tree.update(table);
    ask(tree);
  }
  EXPECT_EQ(tree.work().takeovers, 0u);
  place(1);
  for (int frame = 0; frame < 40; ++frame) {
    tree.update(table);
    ask(tree);
  }
  EXPECT_EQ(tree.work().takeovers, 1u);
}

TEST(ExtentTree, SortsOutrightWhenAllPartsJump) {
  Random random(17);
  ExtentTable table = makeTable(3000, kindsOf(3, 0));
  scatter(table, random, 0.02f);
  ExtentTree tree({});
  tree.update(table);
  Case one{.seed = 17, .kinds = {}, .settings = {}, .width = 0.02f};
  EXPECT_EQ(tree.work().sorted_outright, 0u);
  for (int frame = 0; frame < 3; ++frame) {
    scatter(table, random, 0.02f);
    tree.update(table);
    expectAnswers(tree, table, one, random);
  }
  EXPECT_GT(tree.work().sorted_outright, 0u);
}

}  // namespace
}  // namespace sightline::comparison
