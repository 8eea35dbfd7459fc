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

void expectSameAsComparingAll(const Case& one) {
  SCOPED_TRACE(::testing::Message() << "seed " << one.seed);
  Random random(one.seed);
  ExtentTable table = makeTable(one.parts, one.kinds);
  scatter(table, random, one.width);
  ExtentTree tree(one.settings);
  for (unsigned frame = 0; frame < one.frames; ++frame) {
    tree.update(table);
    expectAnswers(tree, table, one, random);
    if (::testing::Test::HasFailure()) {
      return;
    }
    move(table, random, one.step, one.width, one.jumps);
  }
}

Case anyCase(unsigned seed) {
  Random random(seed + 1000);
  Case one;
  one.seed = seed;
  one.parts = pick(random, 3) == 0 ? pick(random, 12) : 20 + pick(random, 400);
  one.kinds = kindsOf(1 + seed % 6, static_cast<unsigned>(random()));
  one.settings.min_gain = pick(random, 2) == 0 ? 10 : pick(random, 5);
  one.settings.tree_axes = pick(random, 2) == 0 ? 0xffffffffu : pick(random, 64);
  one.settings.rebuild_after = pick(random, 2) == 0 ? 0 : 1 + pick(random, 6);
  one.settings.rebuild_steps = 1 + pick(random, 20);
  one.width = std::array{0.0f, 0.02f, 0.1f, 0.6f, 3.0f}[pick(random, 5)];
  one.step = std::array{0.0f, 0.001f, 0.02f, 0.3f}[pick(random, 4)];
  one.jumps = std::array{0u, 1u, 20u, 100u}[pick(random, 4)];
  return one;
}

TEST(ExtentTree, FindsWhatComparingAllFindsWhateverMoves) {
  for (unsigned seed = 0; seed < 240 && !HasFailure(); ++seed) {
    expectSameAsComparingAll(anyCase(seed));
  }
}

TEST(ExtentTree, FindsWhatComparingAllFindsInLargeScenes) {
  for (unsigned seed = 0; seed < 4 && !HasFailure(); ++seed) {
    expectSameAsComparingAll({.seed = seed,
                              .parts = 1600,
                              .kinds = kindsOf(3, seed % 2 == 0 ? 3 : 0),
                              .settings = {},
                              .width = 0.05f,
                              .step = 0.003f,
                              .jumps = seed,
                              .frames = 20});
  }
}

TEST(ExtentTree, AnswersForNoPartAndForOne) {
  for (const std::size_t parts : {std::size_t{0}, std::size_t{1}}) {
    expectSameAsComparingAll({.seed = 5, .parts = parts, .kinds = kindsOf(2, 0), .settings = {}});
  }
}

TEST(ExtentTree, DividesAlongTheAxesOfTheMaskAlone) {
  Random random(3);
  ExtentTable table = makeTable(500, kindsOf(4, 0));
  scatter(table, random, 0.02f);
  ExtentTreeSettings settings;
  settings.tree_axes = 0b1010;
  ExtentTree tree(settings);
  tree.update(table);
  std::size_t inner = 0;
  for (const ExtentNodes::Node& node : tree.nodes().nodes()) {
    if (node.axis != ExtentNodes::kNone) {
      ++inner;
      EXPECT_TRUE(node.axis == 1 || node.axis == 3);
    }
  }
  EXPECT_GT(inner, 10u);
}

TEST(ExtentTree, StopsWhereTheLongerChildGainsTooLittle) {
  // Divided in two, twenty disjoint intervals in a row leave a longer child with ten fewer; nineteen leave
  // one with nine fewer.
  for (const std::size_t parts : {std::size_t{19}, std::size_t{20}}) {
    ExtentTable table = makeTable(parts, kindsOf(1, 0));
    for (std::size_t part = 0; part < parts; ++part) {
      const auto low = static_cast<float>(part);
      set(table, 0, part, {low, low + 0.5f});
    }
    ExtentTree tree({});
    tree.update(table);
    EXPECT_EQ(tree.nodes().nodes().size(), parts == 20 ? 3u : 1u);
  }
}

TEST(ExtentTree, TakesZeroAndMinusZeroForTheSame) {
  ExtentTable table = makeTable(20, kindsOf(1, 0));
  for (std::size_t part = 0; part < 20; ++part) {
    set(table, 0, part, part < 10 ? Interval{-1.0f, -0.0f} : Interval{1.0f, 2.0f});
  }
  ExtentTree tree({});
  tree.update(table);
  ASSERT_EQ(tree.nodes().nodes().size(), 3u);  // the root is divided at -0
  for (const float zero : {0.0f, -0.0f}) {
    Extent query;
    query[0] = {zero, 0.5f};
    std::vector<std::uint32_t> parts;
    tree.query(query, parts);
    EXPECT_EQ(parts, byComparingAll(table, query, std::vector<bool>(20, true)));
    EXPECT_EQ(parts.size(), 10u);
  }
}

TEST(ExtentTree, KeepsPartsAcrossTheCutWithThoseOnBothSides) {
  ExtentTable table = makeTable(60, kindsOf(1, 1));
  for (std::size_t part = 0; part < 60; ++part) {
    const float low = -2.0f + 4.0f * static_cast<float>(part) / 60.0f;
    set(table, 0, part, {low, low + 0.01f});
  }
  set(table, 0, 30, {1.95f, 2.05f});
  set(table, 0, 31, {2.0f, 2.0f});
  set(table, 0, 32, {-2.0f, -2.0f});
  set(table, 0, 33, {1.9f, std::nextafter(2.0f, 0.0f)});
  set(table, 0, 34, {1.9f, 2.0f});
  ExtentTree tree({.min_gain = 2});
  tree.update(table);
  const std::vector<bool> active(60, true);
  Random random(1);
  std::vector<float> ends{-2.0f,    2.0f,      0.0f, std::nextafter(2.0f, 0.0f), std::nextafter(-2.0f, 0.0f),
                          1.99999f, -1.99999f, 1.9f};
  for (const float low : ends) {
    for (const float width : {0.0f, 1e-7f, 1e-6f, 1e-5f, 0.05f, 1.0f, 3.9f, 4.0f}) {
      Extent query;
      query[0] = {low, low + width};
      std::vector<std::uint32_t> parts;
      tree.query(query, parts);
      EXPECT_EQ(parts, byComparingAll(table, query, active)) << low << " " << width;
    }
  }
}

TEST(ExtentTree, BuildsAnewWhenPartsOrAxesChange) {
  ExtentTree tree({});
  Case one{.seed = 13, .kinds = {}, .settings = {}, .width = 0.05f};
  Random random(13);
  for (const std::size_t parts : {300, 301, 40, 0, 1, 500}) {
    for (const std::size_t axes : {3, 1, 5}) {
      ExtentTable table = makeTable(parts, kindsOf(axes, 1));
      scatter(table, random, 0.05f);
      tree.update(table);
      expectAnswers(tree, table, one, random);
    }
  }
}

TEST(ExtentTree, HoldsIntervalsThatAreNotIntervals) {
  Random random(14);
  ExtentTable table = makeTable(300, kindsOf(3, 2));
  scatter(table, random, 0.05f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  set(table, 0, 10, {kInfinite, -kInfinite});
  set(table, 0, 11, {nan, 1.0f});
  set(table, 2, 12, {0.5f, nan});
  set(table, 2, 13, {0.7f, 0.2f});
  ExtentTree tree({});
  tree.update(table);
  Case one{.seed = 14, .kinds = {}, .settings = {}, .width = 0.5f};
  one.queries = 200;
  expectAnswers(tree, table, one, random);
}

TEST(ExtentTree, DoesNotCopyPartsWithoutEnd) {
  // Nested and staggered intervals, most of which overlap in the middle.
  ExtentTable table = makeTable(2000, kindsOf(3, 0));
  Random random(15);
  for (std::size_t part = 0; part < 2000; ++part) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = uniform(random, 0, 1);
      set(table, axis, part, {low, low + uniform(random, 0.2f, 1.0f)});
    }
  }
  ExtentTree tree({.min_gain = 1});
  tree.update(table);
  std::size_t in_leaves = 0;
  for (std::uint32_t node = 0; node < tree.nodes().nodes().size(); ++node) {
    if (tree.nodes().nodes()[node].axis == ExtentNodes::kNone) {
      in_leaves += tree.nodes().partsOfLeaf(node).size();
    }
  }
  EXPECT_LE(in_leaves, ExtentNodes::kMaxCopies * 2000u);
  expectSound(tree, std::vector<bool>(2000, true));
}

}  // namespace
}  // namespace sightline::comparison
