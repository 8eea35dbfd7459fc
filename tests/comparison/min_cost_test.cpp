#include "src/comparison/layers/min_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace sightline::comparison {
namespace {

using Numbers =
    std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // the low and the high bound of each part

std::uint32_t pick(std::mt19937& random, std::uint32_t count) {
  return static_cast<std::uint32_t>(random()) % count;
}

struct Lists {
  std::vector<Bound> lows, highs;
};

Lists listsOf(const Numbers& intervals) {
  Lists lists;
  for (std::uint32_t part = 0; part < intervals.size(); ++part) {
    lists.lows.push_back(makeBound(intervals[part].first, part));
    lists.highs.push_back(makeBound(intervals[part].second, part));
  }
  std::sort(lists.lows.begin(), lists.lows.end());
  std::sort(lists.highs.begin(), lists.highs.end());
  return lists;
}

Division divisionAt(const Numbers& intervals, std::uint32_t value) {
  Division division;
  division.value = value;
  for (const auto& [low, high] : intervals) {
    const bool is_left = low <= value, is_right = high > value;
    division.left += is_left;
    division.right += is_right;
    division.shared += is_left && is_right;
  }
  division.cost = std::max(division.left, division.right) + division.shared;
  return division;
}

auto rankOf(const Division& division) {
  const std::uint32_t difference =
      std::max(division.left, division.right) - std::min(division.left, division.right);
  return std::tuple(division.cost, division.shared, difference);
}

// Computes the cost at each upper bound by the rule, without skipping any.
Division bestByCounting(const Numbers& intervals) {
  std::vector<std::uint32_t> values;
  for (const auto& interval : intervals) {
    values.push_back(interval.second);
  }
  std::sort(values.begin(), values.end());
  Division best = divisionAt(intervals, values.front());
  for (const std::uint32_t value : values) {
    const Division division = divisionAt(intervals, value);
    if (rankOf(division) < rankOf(best)) {
      best = division;
    }
  }
  return best;
}

// A0, B0, A1, B1, C0, D0, D1, E0, E1, C1, F0, F1.
TEST(MinCost, OfThePapersListIsFourAtTheUpperBoundOfB) {
  const Lists lists = listsOf({{1, 3}, {2, 4}, {5, 10}, {6, 7}, {8, 9}, {11, 12}});
  const Division division = minCost(lists.lows, lists.highs);
  EXPECT_EQ(division.cost, 4u);
  EXPECT_EQ(division.place, 4u);  // after A0, B0, A1 and B1
  EXPECT_EQ(division.value, 4u);
  EXPECT_EQ(division.left, 2u);
  EXPECT_EQ(division.right, 4u);
  EXPECT_EQ(division.shared, 0u);
}

TEST(MinCost, OfNothingIsNothing) {
  const Division division = minCost({}, {});
  EXPECT_EQ(division.cost, 0u);
  EXPECT_EQ(division.left, 0u);
  EXPECT_EQ(division.right, 0u);
}

TEST(MinCost, OfEqualIntervalsLeavesThemTogether) {
  const Lists lists = listsOf(Numbers(7, {3, 5}));
  const Division division = minCost(lists.lows, lists.highs);
  EXPECT_EQ(division.cost, 7u);
  EXPECT_EQ(division.shared, 0u);
  EXPECT_EQ(division.left, 7u);
  EXPECT_EQ(division.right, 0u);
}

TEST(MinCost, PutsLowerBoundsBeforeEqualUpperOnes) {
  // A ends and B begins at 2, so B is in both lists.
  const Lists lists = listsOf({{0, 2}, {2, 4}, {3, 5}, {1, 1}});
  const Division division = minCost(lists.lows, lists.highs);
  const Division expected = bestByCounting({{0, 2}, {2, 4}, {3, 5}, {1, 1}});
  EXPECT_EQ(division.cost, expected.cost);
  EXPECT_EQ(division.left, expected.left);
  EXPECT_EQ(division.right, expected.right);
}

TEST(MinCost, PutsIntervalsWithoutWidthOnOneSide) {
  const Lists lists = listsOf({{1, 1}, {2, 2}, {3, 3}, {4, 4}});
  const Division division = minCost(lists.lows, lists.highs);
  EXPECT_EQ(division.cost, 2u);
  EXPECT_EQ(division.value, 2u);
  EXPECT_EQ(division.shared, 0u);
}

TEST(MinCost, OfEqualCostsTakesFewestSharedThenMostBalanced) {
  // After 1: left 1, right 3, none shared, cost 3. After 4: left 3, right 1, none shared, cost 3; as lopsided
  // as the first, which is therefore taken. After 3: left 3, right 2, one shared, cost 4.
  const Lists lists = listsOf({{0, 1}, {2, 3}, {2, 4}, {5, 6}});
  const Division division = minCost(lists.lows, lists.highs);
  EXPECT_EQ(division.cost, 3u);
  EXPECT_EQ(division.shared, 0u);
  EXPECT_EQ(division.value, 1u);
}

TEST(MinCost, IsTheMinimumOverAllUpperBoundsOfRandomIntervals) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t count = 1 + pick(random, 40), range = 1 + pick(random, 60),
                        width = 1 + pick(random, 30);
    Numbers intervals;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t low = pick(random, range);
      intervals.push_back({low, low + pick(random, width)});
    }
    const Lists lists = listsOf(intervals);
    const Division division = minCost(lists.lows, lists.highs);
    const Division expected = bestByCounting(intervals);
    EXPECT_EQ(division.cost, expected.cost) << "seed " << seed;
    EXPECT_EQ(division.shared, expected.shared) << "seed " << seed;
    EXPECT_EQ(division.value, expected.value) << "seed " << seed;
    EXPECT_EQ(division.left, expected.left) << "seed " << seed;
    EXPECT_EQ(division.right, expected.right) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline::comparison
