#include "src/base/sort_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/cut_work.h"

namespace sightline::base {
namespace {

// Keys of which the first numbers have so many bits, shifted up by some.
LargeVector<SortKey> someKeys(std::size_t count, int bits, int shift, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  LargeVector<SortKey> keys;
  for (std::size_t i = 0; i < count; ++i) {
    keys.push_back({(bits == 0 ? 0 : random() >> (64 - bits)) << shift, random() % 1000});
  }
  return keys;
}

TEST(SortKeys, SortsByTheFirstNumberAndThenByTheSecond) {
  KeySorter sorter;
  for (const std::size_t count : {0u, 1u, 2u, 24u, 25u, 64u, 65u, 1000u, 100000u}) {
    for (const int bits : {0, 1, 5, 20, 40}) {
      for (const int shift : {0, 13, 24}) {
        LargeVector<SortKey> keys = someKeys(count, bits, shift, count + static_cast<std::size_t>(bits));
        LargeVector<SortKey> expected = keys;
        std::stable_sort(expected.begin(), expected.end());
        sorter.sort(keys);
        EXPECT_EQ(keys, expected) << count << " keys of " << bits << " bits, shifted by " << shift;
      }
    }
  }
}

TEST(SortKeys, SortsKeysThatFillTheWholeRange) {
  LargeVector<SortKey> keys = someKeys(5000, 63, 1, 1);
  keys.push_back({0, 0});
  keys.push_back({~std::uint64_t{0}, 1});
  LargeVector<SortKey> expected = keys;
  std::sort(expected.begin(), expected.end());
  KeySorter().sort(keys);
  EXPECT_EQ(keys, expected);
}

TEST(SortKeys, SortsKeysOfWhichAllButOneAreClose) {
  LargeVector<SortKey> keys = someKeys(5000, 10, 0, 2);
  keys.push_back({std::uint64_t{1} << 60, 0});
  LargeVector<SortKey> expected = keys;
  std::sort(expected.begin(), expected.end());
  KeySorter().sort(keys);
  EXPECT_EQ(keys, expected);
}

// Half of each range is empty but for one key, so that buckets are divided again and again.
TEST(SortKeys, SortsKeysThatCrowdTowardsZero) {
  std::mt19937_64 random(4);
  LargeVector<SortKey> keys;
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    keys.push_back({bits >> (random() % 64), random() % 4});
    keys.push_back({std::uint64_t{1} << (i % 64), random() % 4});
  }
  LargeVector<SortKey> expected = keys;
  std::sort(expected.begin(), expected.end());
  KeySorter().sort(keys);
  EXPECT_EQ(keys, expected);
}

TEST(SortKeys, DoNotDependOnHowTheWorkIsCut) {
  const LargeVector<SortKey> given = someKeys(20000, 33, 3, 3);
  LargeVector<SortKey> serial = given, cut = given, parallel = given;
  KeySorter().sort(serial);
  KeySorter().sort(cut, backwardsBy(3));
  KeySorter().sort(parallel, onThreads(4));
  EXPECT_EQ(serial, cut);
  EXPECT_EQ(serial, parallel);
}

TEST(SortKeys, OrdersValuesFromTheLargestDown) {
  const std::vector<double> values{1e300, 2.0, 1.0 + 0x1p-52, 1.0, 1e-310, 0.0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(valueOf(descending(values[i])), values[i]);
    if (i > 0) {
      EXPECT_LT(descending(values[i - 1]), descending(values[i]));
    }
  }
}

}  // namespace
}  // namespace sightline::base
