#include "src/base/part_store.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <thread>
#include <utility>
#include <vector>

namespace sightline::base {
namespace {

// As many numbers, from one on.
std::vector<std::uint64_t> numbers(std::size_t count, std::uint64_t first) {
  std::vector<std::uint64_t> result(count);
  std::iota(result.begin(), result.end(), first);
  return result;
}

// Keeps lists of all sizes, and says whether all of them are still there at the end.
bool keepsAll(PartStore& store, std::uint64_t seed) {
  std::vector<KeptItems<std::uint64_t>> kept;
  std::vector<std::vector<std::uint64_t>> given;
  for (std::size_t i = 0; i < 300; ++i) {
    given.push_back(numbers(i * i % 10007 * (i % 50 == 0 ? 30 : 1), seed + 1000000 * i));
    kept.push_back(store.keep(given.back()));
    store.keep(std::vector<char>(i % 7));  // what follows begins where a number may all the same
  }
  bool all = true;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::span<std::uint64_t> items = kept[i].items;
    all = all && std::vector(items.begin(), items.end()) == given[i] &&
          reinterpret_cast<std::uintptr_t>(items.data()) % alignof(std::uint64_t) == 0;
  }
  return all;
}

TEST(PartStore, KeepsWhatItIsGiven) {
  PartStore store;
  EXPECT_TRUE(keepsAll(store, 0));
  EXPECT_TRUE(store.keep(std::vector<int>()).items.empty());
}

TEST(PartStore, KeepsWhatSeveralThreadsGive) {
  PartStore store;
  bool other_kept = false;
  std::thread other([&] { other_kept = keepsAll(store, 500000000); });
  EXPECT_TRUE(keepsAll(store, 0));
  other.join();
  EXPECT_TRUE(other_kept);
}

TEST(PartStore, ItemsStayWithoutTheStoreAndAreFreedWithTheLastOnesBesideThem) {
  KeptItems<std::uint64_t> first, second;
  {
    PartStore store;
    first = store.keep(numbers(5, 100));
    second = store.keep(numbers(3, 200));
  }
  const std::weak_ptr<const void> memory = first.memory;
  EXPECT_EQ(std::vector(first.items.begin(), first.items.end()), numbers(5, 100));
  first = {};
  EXPECT_EQ(std::vector(second.items.begin(), second.items.end()), numbers(3, 200));
  EXPECT_FALSE(memory.expired());
  second = {};
  EXPECT_TRUE(memory.expired());
}

TEST(UnsetVector, IsAVectorLikeAnyOther) {
  EXPECT_TRUE(unsetVector<int>(0).empty());
  LargeVector<int> vector = unsetVector<int>(3);
  ASSERT_EQ(vector.size(), 3u);
  vector[0] = 1;
  vector[1] = 2;
  vector[2] = 3;
  vector.push_back(4);
  vector.resize(5);
  EXPECT_EQ(vector, (LargeVector<int>{1, 2, 3, 4, 0}));
  const LargeVector<int> moved = std::move(vector), copy = moved;
  EXPECT_EQ(copy, (LargeVector<int>{1, 2, 3, 4, 0}));
}

}  // namespace
}  // namespace sightline::base
