#include "sightline/base/ids.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <unordered_set>

namespace sightline {
namespace {

TEST(Id, TakesAnyWholeNumberThatFits) {
  EXPECT_EQ(ObjectId(0).value, 0u);
  EXPECT_EQ(ObjectId(std::size_t{7}), ObjectId(std::uint8_t{7}));
  EXPECT_EQ(ObjectId(0xfffffffeu).value, 0xfffffffeu);
  EXPECT_TRUE(ObjectId(0xfffffffell).valid());
}

static_assert(!std::is_constructible_v<ObjectId, double>);

TEST(Id, IsInvalidWhereTheNumberDoesNotFit) {
  EXPECT_FALSE(ObjectId().valid());
  EXPECT_FALSE(ObjectId(-1).valid());
  EXPECT_FALSE(ObjectId(std::int8_t{-2}).valid());
  EXPECT_FALSE(ObjectId(0xffffffffu).valid());
  EXPECT_FALSE(ObjectId(std::uint64_t{1} << 32).valid());
  EXPECT_FALSE(ObjectId(INT64_MIN).valid());
}

TEST(Id, IsAKeyOfHashedContainers) {
  const std::unordered_set<NodeIndex> nodes{NodeIndex(1), NodeIndex(2), NodeIndex(1)};
  EXPECT_EQ(nodes.size(), 2u);
  EXPECT_TRUE(nodes.contains(NodeIndex(2)));
}

}  // namespace
}  // namespace sightline
