#include "src/base/hash_slots.h"

#include <gtest/gtest.h>

#include <vector>

namespace sightline::base {
namespace {

constexpr int kFree = -1;

std::size_t slotOf(const std::vector<int>& slots, std::uint64_t hash, int key) {
  return probeSlots(slots, hash, [&](int slot) { return slot == kFree || slot == key; });
}

TEST(HashSlots, ProbesFromTheHashOn) {
  const std::vector<int> slots{kFree, 10, 11, kFree};
  EXPECT_EQ(slotOf(slots, 1, 10), 1u);
  EXPECT_EQ(slotOf(slots, 1, 11), 2u);
  EXPECT_EQ(slotOf(slots, 1, 12), 3u);
}

TEST(HashSlots, GoOnAtTheBeginning) {
  const std::vector<int> slots{10, kFree, 11, 12};
  EXPECT_EQ(slotOf(slots, 3, 10), 0u);
  EXPECT_EQ(slotOf(slots, 3, 13), 1u);
  EXPECT_EQ(slotOf(slots, ~std::uint64_t{0}, 12), 3u);
}

// The first numbers of Vigna's splitmix64.c with the seed 0: its state grows by the constant below.
TEST(HashSlots, MixBitsLikeSplitMix64) {
  EXPECT_EQ(mixBits(0x9e3779b97f4a7c15ull), 0xe220a8397b1dcdafull);
  EXPECT_EQ(mixBits(2 * 0x9e3779b97f4a7c15ull), 0x6e789e6aa1b965f4ull);
  EXPECT_EQ(mixBits(3 * 0x9e3779b97f4a7c15ull), 0x06c45d188009454full);
}

}  // namespace
}  // namespace sightline::base
