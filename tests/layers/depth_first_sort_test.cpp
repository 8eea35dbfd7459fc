#include "src/layers/sort/depth_first_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/layers/graph_source.h"

namespace sightline::layers {
namespace {

void expectSorts(DepthFirstSort& sorter, GraphSource& graph, std::span<const std::uint32_t> previous) {
  GroupedOrder order;
  graph.reset();
  sorter.sort(previous, graph, order);
  EXPECT_EQ(faultOf(order, graph, componentsOf(graph)), "");
  EXPECT_EQ(faultOfMemberOrder(order, previous), "");
  EXPECT_EQ(graph.queries, graph.parts());
  EXPECT_EQ(graph.pair_questions, 0u);
  for (std::uint32_t part = 0; part < graph.parts(); ++part) {
    EXPECT_FALSE(graph.active(part));
  }
}

TEST(DepthFirstSort, GroupsAreTheComponentsOfEveryGraphOfUpToFourPartsFromEveryOrder) {
  DepthFirstSort sorter;
  EXPECT_EQ(faultOfSmallGraphs(sorter), "");
}

TEST(DepthFirstSort, GroupsAreTheComponentsOfRandomGraphsAndEachPartIsAskedAboutOnce) {
  DepthFirstSort sorter;
  for (std::uint32_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(60, random);
    GraphSource graph = variedGraph(seed, parts, random);
    expectSorts(sorter, graph, shuffledOrder(parts, random));
  }
}

TEST(DepthFirstSort, AValidOrderOfAGraphWithoutCyclesStays) {
  DepthFirstSort sorter;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(60, random);
    GraphSource graph = randomAcyclicGraph(parts, below(300, random), random);
    GroupedOrder first, second;
    sorter.sort(shuffledOrder(parts, random), graph, first);
    ASSERT_EQ(faultOf(first, graph, componentsOf(graph)), "");
    graph.reset();
    sorter.sort(first.parts, graph, second);
    EXPECT_EQ(first.parts, second.parts);
  }
}

TEST(DepthFirstSort, AMoveOfOnePartLeavesTheOthersInTheirOrder) {
  // The only arc is from 4 to 1, and the previous order is 0, 1, 2, 3, 4, 5.
  GraphSource graph(6);
  graph.add(4, 1);
  GroupedOrder order;
  DepthFirstSort().sort(identityOrder(6), graph, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{0, 4, 1, 2, 3, 5}));
}

TEST(DepthFirstSort, OccludersComeInThePreviousOrder) {
  GraphSource graph(5);
  for (std::uint32_t front = 1; front < 5; ++front) {
    graph.add(front, 0);
  }
  GroupedOrder order;
  DepthFirstSort().sort(std::vector<std::uint32_t>{0, 3, 1, 4, 2}, graph, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{3, 1, 4, 2, 0}));
}

TEST(DepthFirstSort, AChainOfAHundredThousandPartsInReverseIsSorted) {
  const std::size_t parts = 100'000;
  GraphSource graph(parts);
  for (std::uint32_t i = 0; i + 1 < parts; ++i) {
    graph.add(i, i + 1);
  }
  std::vector<std::uint32_t> previous = identityOrder(parts);
  std::reverse(previous.begin(), previous.end());
  GroupedOrder order;
  DepthFirstSort().sort(previous, graph, order);
  EXPECT_EQ(order.parts, identityOrder(parts));
  EXPECT_EQ(order.groups(), parts);
  graph.reset();
  graph.add(static_cast<std::uint32_t>(parts - 1), 0);
  DepthFirstSort().sort(previous, graph, order);
  EXPECT_EQ(order.parts, previous);
  EXPECT_EQ(order.groups(), 1u);
}

// All in one place, in the previous order and in any other.
TEST(DepthFirstSort, PartsThatAllOccludeEachOtherTakeTwoTestsEach) {
  constexpr std::uint32_t kParts = 400;
  GraphSource graph(kParts);
  for (std::uint32_t front = 0; front < kParts; ++front) {
    for (std::uint32_t back = 0; back < kParts; ++back) {
      graph.add(front, back);
    }
  }
  std::mt19937 random(1);
  for (const std::vector<std::uint32_t>& previous : {identityOrder(kParts), shuffledOrder(kParts, random)}) {
    GroupedOrder order;
    graph.reset();
    DepthFirstSort().sort(previous, graph, order);
    EXPECT_EQ(order.groups(), 1u);
    EXPECT_LE(graph.tests, 2 * kParts);
  }
}

TEST(DepthFirstSort, PartsThatAreLeftOutOfTheOrderDoNotMatter) {
  GraphSource graph(8);
  graph.add(6, 2);
  graph.add(2, 6);
  graph.add(4, 6);
  for (const std::uint32_t disabled : {0u, 1u, 3u, 5u, 7u}) {
    graph.setActive(disabled, false);
    graph.add(disabled, 2);
  }
  GroupedOrder order;
  DepthFirstSort().sort(std::vector<std::uint32_t>{6, 2, 4}, graph, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{4, 6, 2}));
  EXPECT_EQ(order.first_of, (std::vector<std::uint32_t>{0, 1, 3}));
}

}  // namespace
}  // namespace sightline::layers
