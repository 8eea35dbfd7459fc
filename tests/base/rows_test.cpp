#include "src/base/rows.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace sightline::base {
namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers rowOf(const Rows<std::uint32_t>& rows, std::size_t row) {
  return {rows[row].begin(), rows[row].end()};
}

TEST(Rows, HasNoRowsAtFirst) {
  const Rows<std::uint32_t> rows;
  EXPECT_EQ(rows.count(), 0u);
  EXPECT_TRUE(rows.items().empty());
}

TEST(Rows, HoldsWhatWasAddedRowByRow) {
  Rows<std::uint32_t> rows;
  rows.add(3);
  rows.add(1);
  rows.endRow();
  rows.endRow();
  rows.add(7);
  rows.endRow();
  ASSERT_EQ(rows.count(), 3u);
  EXPECT_EQ(rowOf(rows, 0), (Numbers{3, 1}));
  EXPECT_EQ(rowOf(rows, 1), Numbers());
  EXPECT_EQ(rowOf(rows, 2), (Numbers{7}));
  EXPECT_EQ(rows.items().size(), 3u);
  rows.clear();
  EXPECT_EQ(rows.count(), 0u);
}

TEST(Rows, GroupsPairsAndKeepsTheirOrderWithinARow) {
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{{2, 9}, {0, 5}, {2, 1}, {0, 4}, {3, 8}};
  Rows<std::uint32_t> rows;
  rows.add(77);  // grouping replaces it
  rows.group(5, [&](auto&& body) {
    for (const auto& [row, item] : pairs) {
      body(row, item);
    }
  });
  ASSERT_EQ(rows.count(), 5u);
  EXPECT_EQ(rowOf(rows, 0), (Numbers{5, 4}));
  EXPECT_EQ(rowOf(rows, 1), Numbers());
  EXPECT_EQ(rowOf(rows, 2), (Numbers{9, 1}));
  EXPECT_EQ(rowOf(rows, 3), (Numbers{8}));
  EXPECT_EQ(rowOf(rows, 4), Numbers());
}

TEST(Rows, GroupsNothingIntoNoRows) {
  Numbers first, items{1, 2};
  groupIntoRows(0, first, items, [](auto&&) {});
  EXPECT_EQ(first, Numbers{0});
  EXPECT_TRUE(items.empty());
}

}  // namespace
}  // namespace sightline::base
