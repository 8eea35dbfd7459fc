#include "src/base/sparse_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace sightline::base {
namespace {

struct Item {
  double value = 0.5;
  std::uint32_t number = 3;
  bool set = false;
};

bool isDefault(const Item& item) {
  return item.value == 0.5 && item.number == 3 && !item.set;
}

TEST(SparseArray, HasDefaultElementsUntilTheyAreChangedAndWhenItGrows) {
  SparseArray<Item> array;
  EXPECT_EQ(array.size(), 0u);
  array.require(0);
  EXPECT_EQ(array.size(), 0u);
  for (const std::size_t size : {3u, 1000u, 3'000'000u}) {
    array.require(size);
    ASSERT_EQ(array.size(), size);
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_TRUE(isDefault(array[i])) << i << " of " << size;
      array[i] = {1.0, 2, true};
    }
  }
}

TEST(SparseArray, KeepsWhatWasWrittenWhereThereIsRoomAlready) {
  SparseArray<Item> array;
  array.require(1000);
  array[999] = {1.0, 2, true};
  array.require(1000);
  array.require(10);
  EXPECT_EQ(array.size(), 1000u);
  EXPECT_EQ(array[999].number, 2u);
  array.clear();
  EXPECT_EQ(array.size(), 1000u);
  EXPECT_TRUE(isDefault(array[999]));
}

}  // namespace
}  // namespace sightline::base
