#include "src/base/union_find.h"

#include <gtest/gtest.h>

#include <random>

namespace sightline::base {
namespace {

TEST(UnionFind, EveryNumberIsASetAtFirst) {
  UnionFind sets(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sets.root(i), i);
  }
}

TEST(UnionFind, NamesASetByItsSmallestNumber) {
  UnionFind sets(6);
  sets.unite(5, 3);
  EXPECT_EQ(sets.root(5), 3u);
  sets.unite(4, 5);
  sets.unite(1, 4);
  for (const std::uint32_t i : {1u, 3u, 4u, 5u}) {
    EXPECT_EQ(sets.root(i), 1u);
  }
  EXPECT_EQ(sets.root(0), 0u);
  EXPECT_EQ(sets.root(2), 2u);
  sets.reset(6);
  EXPECT_EQ(sets.root(5), 5u);
}

TEST(UnionFind, AgreesWithLabelsThatAreReplacedOneByOne) {
  constexpr std::uint32_t kCount = 40;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    UnionFind sets(kCount);
    std::vector<std::uint32_t> label(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      label[i] = i;
    }
    for (int step = 0; step < 30; ++step) {
      const auto a = static_cast<std::uint32_t>(random() % kCount),
                 b = static_cast<std::uint32_t>(random() % kCount);
      sets.unite(a, b);
      const std::uint32_t from = std::max(label[a], label[b]), to = std::min(label[a], label[b]);
      std::replace(label.begin(), label.end(), from, to);
      for (std::uint32_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(sets.root(i), label[i]) << "seed " << seed << ", step " << step;
      }
    }
  }
}

}  // namespace
}  // namespace sightline::base
