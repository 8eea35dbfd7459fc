// Look-ups in files with doors, some of which are closed.

#include <gtest/gtest.h>

#include <map>

#include "sightline/pvs/query/set_query.h"
#include "tests/pvs/door_scenes.h"
#include "tests/pvs/sight_checks.h"

namespace sightline {
namespace {

// Sets of closed doors may take the place of the last set in the cache, and the viewer's own may be damaged.
TEST(SetQuery, HandsOutNoSetThatLeftItsCacheForThoseOfDoors) {
  made::Visibility settings;
  settings.objects = 3000;
  settings.leaves = 600;
  settings.sets = 400;
  settings.set_nodes = 300;
  settings.plane_every = 0;
  BakedVisibility baked = made::visibility(settings);
  const ObjectId door(0u);
  made::Random random(1);
  made::addDoors(baked, {{door}}, random);
  std::vector<std::vector<bool>> members;
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    members.push_back(test::membersOf(baked, set));
  }
  sight_test::Bytes bytes = sight_test::bytesOf(baked);
  for (const std::size_t from_end : {700u, 20'000u, 29'000u, 38'000u}) {
    bytes[bytes.size() - from_end] ^= std::byte{0x55};
  }
  const Result<SightFile> file = sight_test::opened(bytes);
  ASSERT_TRUE(file) << sight_test::errorOf(file);
  SetQuery query(*file, {.cache_bytes = 0});
  const auto eye = [&] { return made::point(random, baked.octree.min, baked.octree.max); };
  std::size_t looked_at = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d here = eye();
    query.setClosedDoors({});
    query.find(here, 0.0);
    query.setClosedDoors({&door, 1});
    query.find(eye(), 0.0);
    query.setClosedDoors({});
    if (const VisibleSet found = query.find(here, 0.0); found.id != VisibleSet::kEverything) {
      ASSERT_EQ(sight_test::membersOf(query.boxes(), found), members[found.id]) << i;
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 100u);
  EXPECT_GT(query.stats().broken, 0u) << "no set was damaged";
}

TEST(SetQuery, HandsOutWhatClosedDoorsLeave) {
  const ObjectId a(3u), b(5u), c(9u);
  const std::vector<std::vector<ObjectId>> states = test::combinationsOf({a, b, c});
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    BakedVisibility baked = made::visibility({.seed = seed, .objects = 80, .set_nodes = 12});
    made::Random random(seed);
    made::addDoors(baked, {{a}, {b}, {c}, {a, c}, {a, b, c}}, random);
    const sight_test::Bytes bytes = sight_test::bytesOf(baked);
    const Result<SightFile> file = sight_test::opened(bytes);
    ASSERT_TRUE(file) << sight_test::errorOf(file);
    ASSERT_TRUE(file->verifyAll());
    // A small cache drops sets while they are put together.
    SetQuery query(*file, {.cache_bytes = seed == 1 ? std::size_t{0} : std::size_t{1} << 20});
    std::map<std::uint32_t, std::vector<bool>> by_id;
    std::mt19937 order(seed);
    for (int i = 0; i < 4000; ++i) {
      std::vector<ObjectId> closed = states[random() % states.size()];
      const Vec3d eye = made::point(random, baked.octree.min, baked.octree.max);
      const std::vector<bool> expected =
          test::membersWith(baked, test::setAt(baked.octree.view(), query.locate(eye).leaf, eye), closed);
      std::shuffle(closed.begin(), closed.end(), order);
      closed.push_back(ObjectId(0u));  // no door
      query.setClosedDoors(closed);
      for (int again = 0; again < 2; ++again) {
        const VisibleSet found = query.find(eye, baked.record.near_distance);
        std::uint32_t after = 0;
        for (const std::uint32_t node : found.nodes) {
          EXPECT_GE(node, after);
          after = file->boxes().nodes[node].end;
        }
        const std::vector<bool> members = sight_test::membersOf(file->boxes(), found);
        ASSERT_EQ(members, expected) << "seed " << seed << ", look-up " << i;
        const auto [place, is_new] = by_id.try_emplace(found.id, members);
        ASSERT_EQ(place->second, members) << "equal numbers, other sets";
      }
    }
  }
}

}  // namespace
}  // namespace sightline
