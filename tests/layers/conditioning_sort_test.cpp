#include "src/layers/sort/conditioning_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "src/layers/sort/depth_first_sort.h"
#include "tests/layers/graph_source.h"

namespace sightline::layers {
namespace {

GroupedOrder singles(std::span<const std::uint32_t> parts) {
  GroupedOrder order;
  order.parts.assign(parts.begin(), parts.end());
  order.first_of = identityOrder(parts.size() + 1);
  return order;
}

std::vector<double> minKeys(const GroupedOrder& order, std::span<const double> part_keys) {
  std::vector<double> keys(order.groups(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < order.groups(); ++i) {
    for (const std::uint32_t part : order.group(i)) {
      keys[i] = std::min(keys[i], part_keys[part]);
    }
  }
  return keys;
}

std::size_t inversions(std::span<const double> keys) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < keys.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      count += keys[a] > keys[b] ? 1 : 0;
    }
  }
  return count;
}

TEST(ConditioningSort, GroupsThatDoNotOccludeEachOtherAreSortedByTheirKeysAndTiesStay) {
  GraphSource graph(6);
  GroupedOrder order = singles(std::vector<std::uint32_t>{5, 3, 0, 1, 4, 2});
  const std::vector<double> keys{2, 1, 2, 3, 1, 3};  // one per part
  const std::uint64_t moved =
      ConditioningSort().sort(std::vector<double>{3, 3, 2, 1, 1, 2}, keys, {askGraph, &graph}, {}, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{1, 4, 0, 2, 5, 3}));
  EXPECT_EQ(order.first_of, identityOrder(7));
  EXPECT_EQ(moved, 4u);
}

// 0 occludes 2, and 2 is the nearest. It stops behind 0, although 1 between them does not occlude it.
TEST(ConditioningSort, AGroupStopsBehindOneThatOccludesIt) {
  GraphSource graph(3);
  graph.add(0, 2);
  GroupedOrder order = singles(std::vector<std::uint32_t>{0, 1, 2});
  const std::vector<double> keys{3, 2, 1};
  ConditioningSort().sort(keys, keys, {askGraph, &graph}, {}, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{1, 0, 2}));
}

// A group may pass groups that it occludes, since it is then in front of them.
TEST(ConditioningSort, AGroupMovesPastOneThatItOccludes) {
  GraphSource graph(2);
  graph.add(1, 0);
  GroupedOrder order = singles(std::vector<std::uint32_t>{0, 1});
  const std::vector<double> keys{2, 1};
  EXPECT_EQ(ConditioningSort().sort(keys, keys, {askGraph, &graph}, {}, order), 1u);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{1, 0}));
}

TEST(ConditioningSort, PartsOfAGroupAreSortedByTheirKeysWhateverOccludesThem) {
  GraphSource graph(4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    graph.add(i, (i + 1) % 4);
  }
  GroupedOrder order;
  order.parts = {0, 1, 2, 3};
  order.first_of = {0, 4};
  const std::vector<double> keys{2, std::numeric_limits<double>::quiet_NaN(), 2, 1};
  EXPECT_EQ(ConditioningSort().sort(std::vector<double>{1}, keys, {askGraph, &graph}, {}, order), 0u);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{3, 0, 2, 1}));
}

TEST(ConditioningSort, TheOrderStaysValidAndNoAdjacentPairThatMayBeSwappedIsLeftInversed) {
  ConditioningSort conditioning;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t parts = 1 + below(50, random);
    GraphSource graph = randomGraph(parts, below(1500, random) / static_cast<std::uint32_t>(parts), random);
    std::vector<double> part_keys(parts);
    for (double& key : part_keys) {
      key = below(100, random);
    }
    GroupedOrder order;
    DepthFirstSort().sort(shuffledOrder(parts, random), graph, order);
    const std::vector<double> before = minKeys(order, part_keys);
    const std::uint64_t moved = conditioning.sort(before, part_keys, {askGraph, &graph}, {}, order);
    ASSERT_EQ(faultOf(order, graph, componentsOf(graph)), "");
    const std::vector<double> after = minKeys(order, part_keys);
    EXPECT_LE(inversions(after), inversions(before));
    EXPECT_EQ(moved == 0, inversions(after) == inversions(before));
    for (std::size_t i = 1; i < after.size(); ++i) {
      bool occluded = false;
      for (const std::uint32_t front : order.group(i - 1)) {
        for (const std::uint32_t back : order.group(i)) {
          occluded = occluded || graph.has(front, back);
        }
      }
      EXPECT_TRUE(after[i - 1] <= after[i] || occluded);
    }
  }
}

TEST(ConditioningSort, NoMorePairsAreAskedAboutThanTheLimit) {
  GraphSource graph(30);
  std::vector<std::uint32_t> parts = identityOrder(30);
  std::vector<double> keys(30);
  for (std::size_t i = 0; i < 30; ++i) {
    keys[i] = -static_cast<double>(i);
  }
  for (const std::uint64_t most : {0u, 1u, 2u, 10u, 100u, 434u, 435u, 1000u}) {
    GroupedOrder order = singles(parts);
    graph.reset();
    ConditioningSort().sort(keys, keys, {askGraph, &graph}, {.max_tests = most}, order);
    EXPECT_EQ(graph.pair_questions, std::min<std::uint64_t>(most, 30 * 29 / 2));
    std::vector<std::uint32_t> sorted = order.parts;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, parts);
  }
}

TEST(ConditioningSort, KeysThatAreNotNumbersGoBehindAllOthers) {
  GraphSource graph(3);
  GroupedOrder order = singles(std::vector<std::uint32_t>{0, 1, 2});
  const std::vector<double> keys{std::numeric_limits<double>::quiet_NaN(), 5, 1};
  ConditioningSort().sort(keys, keys, {askGraph, &graph}, {}, order);
  EXPECT_EQ(order.parts, (std::vector<std::uint32_t>{2, 1, 0}));
}

}  // namespace
}  // namespace sightline::layers
