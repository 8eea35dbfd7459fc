#include "src/base/part_store.h"

#include <gtest/gtest.h>

#include <cstdint>
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
  std::vector<std::span<const std::uint64_t>> kept;
  std::vector<std::vector<std::uint64_t>> given;
  for (std::size_t i = 0; i < 300; ++i) {
    given.push_back(numbers(i * i % 10007 * (i % 50 == 0 ? 30 : 1), seed + 1000000 * i));
    kept.push_back(store.keep(given.back()));
    store.keep(std::vector<char>(i % 7));  // what follows begins where a number may all the same
  }
  bool all = true;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    all = all && std::vector(kept[i].begin(), kept[i].end()) == given[i] &&
          reinterpret_cast<std::uintptr_t>(kept[i].data()) % alignof(std::uint64_t) == 0;
  }
  return all;
}

TEST(PartStore, KeepsWhatItIsGiven) {
  PartStore store;
  EXPECT_TRUE(keepsAll(store, 0));
  EXPECT_TRUE(store.keep(std::vector<int>()).empty());
}

TEST(PartStore, KeepsWhatSeveralThreadsGive) {
  PartStore store;
  bool other_kept = false;
  std::thread other([&] { other_kept = keepsAll(store, 500000000); });
  EXPECT_TRUE(keepsAll(store, 0));
  other.join();
  EXPECT_TRUE(other_kept);
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
