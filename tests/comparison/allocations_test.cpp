#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "src/comparison/layers/extent_tree.h"
#include "src/comparison/layers/incremental_sort.h"
#include "tests/comparison/made_extents.h"
#include "tests/layers/graph_source.h"
#include "tests/support/count_allocations.h"

namespace sightline::comparison {
namespace {

TEST(IncrementalSort, DoesNotAllocateOnceItHasSortedAsMuch) {
  std::mt19937 random(3);
  const std::vector<std::uint32_t> previous = layers::shuffledOrder(60, random);
  layers::GraphSource graph = layers::randomGraph(60, 25, random);
  IncrementalSort incremental;
  GroupedOrder order;
  std::size_t before = 0;
  for (int round = 0; round < 3; ++round) {
    before = allocations.load();
    graph.reset();
    incremental.sort(previous, graph, order);
  }
  EXPECT_EQ(allocations.load() - before, 0u);
  EXPECT_GT(incremental.reinsertions(), 0u);
}

using namespace made;

TEST(ExtentTree, AllocatesNothingAfterWarmUp) {
  Random random(16);
  ExtentTable table = makeTable(400, kindsOf(3, 3));
  scatter(table, random, 0.03f);
  const ExtentTable start = table;
  ExtentTreeSettings settings;
  settings.rebuild_after = 10;
  settings.rebuild_steps = 50;
  ExtentTree tree(settings);
  std::vector<std::uint32_t> parts;
  const auto frame = [&](std::size_t number) {
    const float by = 0.05f * std::sin(static_cast<float>(number) * 0.2f);
    for (std::size_t part = 0; part < table.parts; ++part) {
      const float own = part % 2 == 0 ? by : -by;
      set(table, 2, part, {start.lows[2][part] + own, start.highs[2][part] + own});
    }
    tree.update(table);
    for (std::uint32_t part = 0; part < table.parts; ++part) {
      tree.setActive(part, false);
      parts.clear();
      tree.query({table.at(0, part), table.at(1, part), table.at(2, part)}, parts);
    }
  };
  std::size_t number = 0;
  while (number < 120) {
    frame(number++);
  }
  const std::size_t before = allocations;
  const std::uint64_t takeovers = tree.work().takeovers;
  while (number < 180) {
    frame(number++);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(tree.work().takeovers, takeovers);
}

}  // namespace
}  // namespace sightline::comparison
