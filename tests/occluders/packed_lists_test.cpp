#include "src/occluders/database/packed_lists.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sightline::occluders {
namespace {

using Ids = std::vector<OccluderId>;

Ids idsOf(std::initializer_list<std::uint32_t> values) {
  Ids ids;
  for (const std::uint32_t value : values) {
    ids.push_back(OccluderId(value));
  }
  return ids;
}

TEST(PackedLists, AreWhatWasAddedInItsOrder) {
  const std::vector<Ids> lists{idsOf({3, 1, 2}), {}, idsOf({1, 2, 3}), idsOf({3, 1, 2}), idsOf({7}),
                               idsOf({1, 2}),    {}, idsOf({7})};
  ListPacker packer(lists.size(), 32);
  for (const Ids& list : lists) {
    packer.add(list);
  }
  const PackedLists packed = packer.finish();
  ASSERT_EQ(packed.size(), lists.size());
  for (std::size_t i = 0; i < lists.size(); ++i) {
    EXPECT_TRUE(std::ranges::equal(packed[i], lists[i])) << "list " << i;
  }
}

TEST(PackedLists, EqualOnesAreStoredOnce) {
  const Ids one = idsOf({5, 6, 7, 8}), other = idsOf({8, 7, 6, 5});
  ListPacker packer(100, 400);
  for (int i = 0; i < 50; ++i) {
    packer.add(one);
    packer.add(other);
  }
  const PackedLists packed = packer.finish();
  EXPECT_EQ(packed[0].data(), packed[98].data());
  EXPECT_NE(packed[0].data(), packed[1].data());
  EXPECT_LE(packed.bytes(), 100 * PackedLists::bytesPerList() + 8 * sizeof(OccluderId));
}

}  // namespace
}  // namespace sightline::occluders
