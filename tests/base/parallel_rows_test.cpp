#include "src/base/parallel_rows.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/cut_work.h"

namespace sightline::base {
namespace {

struct Grouped {
  LargeVector<std::uint32_t> first, items;
  friend bool operator==(const Grouped&, const Grouped&) = default;
};

// Source i gives i % 4 items, each to the row that it names.
struct Sources {
  std::vector<std::uint32_t> rows;
  std::size_t row_count;

  Sources(std::size_t count, std::size_t of_rows, std::uint32_t seed) : row_count(of_rows) {
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
      // Every other source is near its place, as in a scene; the others are anywhere.
      rows.push_back(static_cast<std::uint32_t>(i % 2 == 0 ? i * row_count / count : random() % row_count));
    }
  }
  template <typename Pair>
  void visit(std::size_t begin, std::size_t end, Pair&& pair) const {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < i % 4; ++k) {
        pair((rows[i] + k) % row_count, static_cast<std::uint32_t>(4 * i + k));
      }
    }
  }
};

Grouped groupedBy(const ParallelFor& parallel_for, const Sources& sources, std::size_t rows) {
  Grouped grouped;
  groupIntoRows(parallel_for, rows, sources.rows.size(), grouped.first, grouped.items,
                [&](std::size_t begin, std::size_t end, auto&& pair) { sources.visit(begin, end, pair); });
  return grouped;
}

TEST(ParallelRows, AreThoseOfOneThread) {
  for (const std::size_t count : {1u, 100u, 8192u, 8193u, 60000u}) {
    for (const std::size_t row_count : {1u, 2u, 255u, 256u, 257u, 100000u}) {
      const Sources sources(count, row_count, static_cast<std::uint32_t>(count + row_count));
      const std::size_t rows = row_count + 3;  // the last ones are empty
      Grouped expected;
      groupIntoRows(rows, expected.first, expected.items,
                    [&](auto&& pair) { sources.visit(0, sources.rows.size(), pair); });
      EXPECT_TRUE(groupedBy(serialFor, sources, rows) == expected) << count << ", " << row_count;
      EXPECT_TRUE(groupedBy(backwardsBy(1), sources, rows) == expected) << count << ", " << row_count;
      EXPECT_TRUE(groupedBy(onThreads(3), sources, rows) == expected) << count << ", " << row_count;
    }
  }
}

TEST(ParallelRows, HaveNoItemsWithoutSources) {
  const Grouped grouped = [] {
    Grouped none;
    groupIntoRows(serialFor, 5, 0, none.first, none.items, [](std::size_t, std::size_t, auto&&) {});
    return none;
  }();
  EXPECT_EQ(grouped.first, LargeVector<std::uint32_t>(6, 0));
  EXPECT_TRUE(grouped.items.empty());
}

}  // namespace
}  // namespace sightline::base
