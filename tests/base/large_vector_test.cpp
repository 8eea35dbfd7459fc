#include "sightline/base/large_vector.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <utility>

namespace sightline {
namespace {

struct Given {
  std::shared_ptr<std::array<std::uint32_t, 4>> items =
      std::make_shared<std::array<std::uint32_t, 4>>(std::array<std::uint32_t, 4>{1, 2, 3, 4});

  LargeVector<std::uint32_t> vector() const {
    return vectorOver<std::uint32_t>({std::as_bytes(std::span(*items)), items});
  }
};

TEST(VectorOver, HasTheItemsWhereTheyLie) {
  const Given given;
  const LargeVector<std::uint32_t> vector = given.vector();
  EXPECT_EQ(vector.data(), given.items->data());
  EXPECT_EQ(vector, (LargeVector<std::uint32_t>{1, 2, 3, 4}));
  EXPECT_TRUE(vectorOver<std::uint32_t>({}).empty());
}

TEST(VectorOver, KeepsTheOwnerUntilItIsGone) {
  std::weak_ptr<const void> owner;
  LargeVector<std::uint32_t> moved;
  {
    const Given given;
    owner = given.items;
    LargeVector<std::uint32_t> vector = given.vector();
    const std::uint32_t* const items = vector.data();
    moved = std::move(vector);
    EXPECT_EQ(moved.data(), items);
  }
  ASSERT_FALSE(owner.expired());
  EXPECT_EQ(moved, (LargeVector<std::uint32_t>{1, 2, 3, 4}));
  moved = LargeVector<std::uint32_t>();
  EXPECT_TRUE(owner.expired());
}

TEST(VectorOver, ACopyHasItemsOfItsOwn) {
  const Given given;
  const LargeVector<std::uint32_t> vector = given.vector();
  LargeVector<std::uint32_t> copy = vector;
  copy[0] = 9;
  LargeVector<std::uint32_t> assigned;
  assigned = vector;
  assigned[1] = 9;
  EXPECT_EQ(*given.items, (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
}

TEST(VectorOver, LetsItsItemsGoWhenAnotherOneIsAssigned) {
  const Given given;
  LargeVector<std::uint32_t> vector = given.vector();
  const LargeVector<std::uint32_t> other{5, 6};
  vector = other;
  EXPECT_EQ(vector, other);
  LargeVector<std::uint32_t> again = given.vector();
  LargeVector<std::uint32_t> between;
  between = again;
  between[0] = 9;
  again = between;
  EXPECT_EQ(again, (LargeVector<std::uint32_t>{9, 2, 3, 4}));
  EXPECT_EQ(*given.items, (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
}

TEST(VectorOver, FreesNothingOfOthersWhereAnotherHasItsAllocator) {
  const Given given;
  LargeVector<std::uint32_t> vector = given.vector();
  LargeVector<std::uint32_t> other(vector.get_allocator());
  other.push_back(9);
  vector = other;
  EXPECT_EQ(vector, other);
  EXPECT_EQ(*given.items, (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
}

TEST(VectorOver, GrowsIntoMemoryOfItsOwn) {
  const Given given;
  LargeVector<std::uint32_t> vector = given.vector();
  vector.resize(6);
  vector[0] = 7;
  EXPECT_EQ(vector, (LargeVector<std::uint32_t>{7, 2, 3, 4, 0, 0}));
  EXPECT_EQ((*given.items)[0], 1u);
  vector.reserve(100);
  vector.push_back(5);
  EXPECT_EQ(vector.size(), 7u);
}

TEST(VectorOver, ItemsThatItAddsAreNotThoseThatWereThere) {
  const Given given;
  LargeVector<std::uint32_t> vector = given.vector();
  vector.resize(2);
  vector.resize(4);
  EXPECT_EQ(vector, (LargeVector<std::uint32_t>{1, 2, 0, 0}));
}

}  // namespace
}  // namespace sightline
