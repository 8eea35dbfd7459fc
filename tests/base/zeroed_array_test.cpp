#include "src/base/zeroed_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <new>

namespace sightline::base {
namespace {

struct Item {
  double value = 0.0;
  std::uint32_t number = 0;
  bool set = false;
};

bool isZero(const Item& item) {
  return item.value == 0.0 && item.number == 0 && !item.set;
}

TEST(ZeroedArray, IsZeroUntilItIsWrittenAndWhenItGrows) {
  ZeroedArray<Item> array;
  EXPECT_EQ(array.size(), 0u);
  array.require(0);
  EXPECT_EQ(array.size(), 0u);
  for (const std::size_t size : {3u, 1000u, 3'000'000u}) {
    array.require(size);
    ASSERT_EQ(array.size(), size);
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_TRUE(isZero(array[i])) << i << " of " << size;
      array[i] = {1.0, 2, true};
    }
  }
}

TEST(ZeroedArray, KeepsWhatWasWrittenWhereThereIsRoomAlready) {
  ZeroedArray<Item> array;
  array.require(1000);
  array[999] = {1.0, 2, true};
  array.require(1000);
  array.require(10);
  EXPECT_EQ(array.size(), 1000u);
  EXPECT_EQ(array[999].number, 2u);
  array.clear();
  EXPECT_EQ(array.size(), 1000u);
  EXPECT_TRUE(isZero(array[999]));
}

TEST(ZeroedArray, IsEmptyWhereThereIsNoMemoryForMore) {
  ZeroedArray<Item> array;
  array.require(10);
  EXPECT_THROW(array.require(std::numeric_limits<std::size_t>::max() / 32), std::bad_alloc);
  EXPECT_EQ(array.size(), 0u);
  array.require(10);
  EXPECT_EQ(array.size(), 10u);
}

}  // namespace
}  // namespace sightline::base
