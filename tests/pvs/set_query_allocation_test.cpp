// Counts allocations by operator new in this program: a look-up must not allocate once its sets are decoded.

#include <gtest/gtest.h>

#include <vector>

#include "sightline/pvs/query/set_query.h"
#include "tests/pvs/sight_checks.h"
#include "tests/support/count_allocations.h"

namespace sightline::sight_test {
namespace {

std::size_t allocationsIn(SetQuery& query, std::span<const Vec3d> eyes) {
  const std::size_t before = allocations;
  for (const Vec3d& eye : eyes) {
    query.find(eye, 0.25);
  }
  return allocations - before;
}

std::vector<Vec3d> eyesIn(const VisibilityOctree& octree) {
  made::Random random(1);
  const Vec3d margin = (octree.max - octree.min) * 0.05;
  std::vector<Vec3d> eyes(3000);
  for (Vec3d& eye : eyes) {
    eye = made::point(random, octree.min - margin, octree.max + margin);
  }
  return eyes;
}

TEST(SetQueryAllocations, AreCountedByThisTest) {
  const BakedVisibility baked = made::visibility();
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes));
  EXPECT_GT(allocationsIn(query, eyesIn(baked.octree)), 0u);
}

TEST(SetQueryAllocations, DoNotHappenOnceAllSetsAreDecoded) {
  const BakedVisibility baked =
      made::visibility({.objects = 2000, .leaves = 300, .sets = 100, .set_nodes = 50});
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes));
  const std::vector<Vec3d> eyes = eyesIn(baked.octree);
  allocationsIn(query, eyes);
  const std::uint64_t decoded = query.stats().decoded;
  EXPECT_GT(decoded, 50u);
  EXPECT_EQ(allocationsIn(query, eyes), 0u);
  EXPECT_EQ(query.stats().decoded, decoded);
}

TEST(SetQueryAllocations, DoNotHappenForDoorsThatWereClosedBefore) {
  BakedVisibility baked = made::visibility({.objects = 2000, .leaves = 300, .sets = 100, .set_nodes = 50});
  const std::vector<std::vector<ObjectId>> states{
      {}, {ObjectId(3u)}, {ObjectId(3u), ObjectId(5u)}, {ObjectId(5u)}};
  made::Random random(1);
  made::addDoors(baked, {{ObjectId(3u)}, {ObjectId(5u)}, {ObjectId(3u), ObjectId(5u)}}, random);
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes));
  const std::vector<Vec3d> eyes = eyesIn(baked.octree);
  const auto inAllStates = [&] {
    std::size_t count = 0;
    for (const std::vector<ObjectId>& closed : states) {
      const std::size_t before = allocations;
      query.setClosedDoors(closed);
      count += allocations - before + allocationsIn(query, eyes);
    }
    return count;
  };
  EXPECT_GT(inAllStates(), 0u);
  EXPECT_EQ(inAllStates(), 0u);
}

// If all sets have the same size, each reuses the storage of an evicted one.
TEST(SetQueryAllocations, DoNotHappenWhenSetsTakeEachOthersPlaces) {
  BakedVisibility baked = made::visibility({.objects = 2000, .leaves = 300, .sets = 100});
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = 0; node < baked.boxes.nodes.size(); ++node) {
    if (baked.boxes.view().leaf(node)) {
      leaves.push_back(node);
    }
  }
  baked.sets = {};
  for (std::uint32_t set = 0; set < 100; ++set) {
    for (std::uint32_t i = 0; i < 40; ++i) {
      baked.sets.nodes.push_back(leaves[set + i * 45]);
    }
    baked.sets.first.push_back(baked.sets.nodes.size());
  }
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes), {.cache_bytes = 20 * 160});
  const std::vector<Vec3d> eyes = eyesIn(baked.octree);
  allocationsIn(query, eyes);
  const std::uint64_t decoded = query.stats().decoded;
  EXPECT_EQ(allocationsIn(query, eyes), 0u);
  EXPECT_GT(query.stats().decoded, decoded + 500);
}

}  // namespace
}  // namespace sightline::sight_test
