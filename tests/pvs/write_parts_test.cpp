// A file that is written part by part has the bytes of the one that is assembled in memory, and no part is
// read twice.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "scenes/procedural.h"
#include "sightline/pvs/bake/bake.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/door_scenes.h"
#include "tests/pvs/sight_checks.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

class WrittenParts : public ::testing::Test {
 protected:
  sight_test::Bytes content() const {
    const std::string text = test::contents(file_);
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
  std::size_t filesThere() const { return folder_.entries(); }

  // Bakes the scene and writes it part by part. Returns how many leaves of the file became one by merging.
  std::size_t expectTheSameBytes(const Scene& scene, const BakeSettings& settings) {
    const Result<Bake> bake = Bake::plan(scene.view(), test::allOccluders(scene), settings);
    EXPECT_TRUE(bake) << (bake ? "" : bake.error().message);
    const BakedParts parts = bake->bakeAll();
    const SightExtras extras{"{\"any\":\"text\"}", {{"first-hit", 7, std::vector<std::byte>(3000)}}};
    Result<BakedVisibility> whole = bake->assemble(parts);
    if (!whole) {
      ADD_FAILURE() << whole.error().message;
      return 0;
    }
    whole->record.settings = extras.settings;
    whole->databases = extras.databases;
    std::map<std::uint64_t, int> reads;
    const ReadPart read = [&](std::uint64_t id) {
      reads[id] += 1;
      return std::optional(parts.at(id));
    };
    EXPECT_EQ(sight_test::errorOf(bake->writeSight(file_, read, extras)), "");
    EXPECT_TRUE(content() == sight_test::bytesOf(*whole));
    EXPECT_EQ(filesThere(), 1u);
    if (settings.byte_budget == 0) {
      EXPECT_EQ(reads.size(), parts.size());
      for (const auto& [id, count] : reads) {
        EXPECT_EQ(count, 1) << id;
      }
    }
    const std::vector<std::uint8_t>& reasons = whole->octree.reasons;
    return static_cast<std::size_t>(
        std::count(reasons.begin(), reasons.end(), static_cast<std::uint8_t>(StopReason::kMerged)));
  }

  const test::TemporaryFolder folder_;
  const std::string file_ = folder_.file("a.sight");
};

// A tolerance of 0 merges hardly anything, one of 1 much, one of 1,000 all that have like planes. A part is
// at most two levels of cells, so that cells of several parts become one.
TEST_F(WrittenParts, HaveTheBytesOfTheWholeHoweverManyCellsBecomeOne) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 0});
  std::vector<std::size_t> merged;
  for (const double tolerance : {0.0, 0.05, 1.0, 1000.0}) {
    merged.push_back(expectTheSameBytes(
        scene,
        {.triangle_budget = 300, .max_depth = 4, .near_distance = 0.05, .merge_tolerance = tolerance}));
  }
  EXPECT_LT(merged[0], merged[1]);
  EXPECT_GT(merged[2], 0u);
}

TEST_F(WrittenParts, HaveTheBytesOfTheWholeWhereViewersAreInAPart) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 0});
  const Box bounds = sceneBounds(scene.view());
  const Vec3f size = bounds.max - bounds.min;
  const std::vector<Box> viewers{{bounds.min + size * 0.13f, bounds.min + size * 0.47f},
                                 {bounds.min + size * 0.61f, bounds.min + size * 0.87f}};
  for (const std::uint32_t depth : {0u, 1u, 3u, 4u}) {
    expectTheSameBytes(
        scene, {.triangle_budget = 300, .max_depth = depth, .near_distance = 0.05, .viewers = viewers});
  }
}

TEST_F(WrittenParts, HaveTheBytesOfTheWholeWithDoors) {
  const test::DoorScene rooms = test::randomRooms(2);
  expectTheSameBytes(rooms.scene, {.max_depth = 4, .near_distance = 0.05, .doors = test::alone(rooms.doors)});
}

TEST_F(WrittenParts, HaveTheBytesOfTheWholeWithAByteBudget) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 0});
  BakeSettings settings{.triangle_budget = 300, .max_depth = 0, .near_distance = 0.05};
  const std::size_t fewest = sight_test::bytesOf(test::baked(scene, settings)).size();
  settings.max_depth = 3;
  const BakedVisibility whole = test::baked(scene, settings);
  settings.byte_budget = (fewest + sight_test::bytesOf(whole).size()) / 2;
  expectTheSameBytes(scene, settings);
  EXPECT_LT(SightFile::open(file_)->octree().leaves.size(), whole.octree.leaves.size());
}

TEST_F(WrittenParts, LeaveNothingWhereOneIsMissingOrOfAnotherPlan) {
  const Scene scene = makeShip({.decks = 2, .rooms = 2, .machinery = 0});
  const Result<Bake> bake =
      Bake::plan(scene.view(), test::allOccluders(scene), {.max_depth = 4, .near_distance = 0.05});
  ASSERT_TRUE(bake);
  const BakedParts parts = bake->bakeAll();
  ASSERT_GT(parts.size(), 8u);
  for (const std::uint64_t lost : {std::uint64_t{1}, std::uint64_t{9}, parts.rbegin()->first}) {
    for (const bool torn : {false, true}) {
      const Status written = bake->writeSight(file_, [&](std::uint64_t id) -> std::optional<BakedPart> {
        BakedPart part = parts.at(id);
        part.pop_back();
        return id != lost ? std::optional(parts.at(id)) : torn ? std::optional(part) : std::nullopt;
      });
      EXPECT_NE(sight_test::errorOf(written).find("part " + std::to_string(lost)), std::string::npos)
          << sight_test::errorOf(written);
      EXPECT_EQ(filesThere(), 0u);
    }
  }
}

TEST_F(WrittenParts, GiveTheWitnessesAndAnswersOfThoseInMemory) {
  const Scene scene = makeShip({.decks = 2, .rooms = 2, .machinery = 0});
  for (const bool witnesses : {false, true}) {
    const Result<Bake> bake =
        Bake::plan(scene.view(), test::allOccluders(scene),
                   {.max_depth = 4, .near_distance = 0.05, .witnesses = witnesses, .answers = !witnesses});
    ASSERT_TRUE(bake);
    const BakedParts parts = bake->bakeAll();
    const ReadPart read = [&](std::uint64_t id) { return std::optional(parts.at(id)); };
    const Result<Witnesses> found = bake->witnesses(read);
    ASSERT_TRUE(found);
    EXPECT_EQ(witnessBytes(*found), witnessBytes(bake->witnesses(parts)));
    EXPECT_EQ(witnesses, !found->all.empty());
    const Result<std::vector<std::byte>> answers = bake->answers(read);
    ASSERT_TRUE(answers);
    EXPECT_EQ(*answers, bake->answers(parts));
    // Where one part is missing there are none at all.
    for (const std::uint64_t lost : {parts.begin()->first, parts.rbegin()->first}) {
      const ReadPart others = [&](std::uint64_t id) {
        return id == lost ? std::nullopt : std::optional(parts.at(id));
      };
      EXPECT_FALSE(bake->witnesses(others)) << lost;
      EXPECT_FALSE(bake->answers(others)) << lost;
    }
  }
}

// The disk is full at the first set, somewhere in the payload, and while the payload is moved behind the
// structure.
TEST_F(WrittenParts, LeaveTheOldFileWhereTheDiskIsFullAndAreReadNoFurther) {
  const Scene scene = makeShip({.decks = 3, .rooms = 4, .machinery = 0});
  const Result<Bake> bake = Bake::plan(scene.view(), test::allOccluders(scene),
                                       {.triangle_budget = 300, .max_depth = 4, .near_distance = 0.05});
  ASSERT_TRUE(bake);
  const BakedParts parts = bake->bakeAll();
  std::size_t reads = 0;
  const ReadPart read = [&](std::uint64_t id) {
    reads += 1;
    return std::optional(parts.at(id));
  };
  ASSERT_EQ(sight_test::errorOf(bake->writeSight(file_, read)), "");
  const auto before = content();
  ASSERT_EQ(reads, parts.size());
  for (const std::size_t room : {std::size_t{0}, std::size_t{1000}, before.size() - 1}) {
    std::string error;
    reads = 0;
    {
      const test::FullDisk full(room);
      error = sight_test::errorOf(bake->writeSight(file_, read));
    }
    EXPECT_NE(error.find("File too large"), std::string::npos) << error;
    EXPECT_EQ(reads == parts.size(), room == before.size() - 1) << room;
    EXPECT_TRUE(content() == before);
    EXPECT_EQ(filesThere(), 1u);
  }
}

}  // namespace
}  // namespace sightline
