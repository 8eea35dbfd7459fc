// What doors hide while they are closed, against rays in the scene with exactly those doors closed.

#include <gtest/gtest.h>

#include <set>

#include "src/pvs/bake/cell_tree.h"
#include "tests/pvs/door_scenes.h"
#include "tests/pvs/edited_scene.h"
#include "tests/pvs/sight_checks.h"

namespace sightline {
namespace {

using test::alone;
using test::BakeJudge;
using test::closedSetsOf;
using test::combinationsOf;
using test::DoorScene;
using test::leftWith;
using test::membersWith;
using test::RoomBuilder;
using test::withDoors;

constexpr double kNear = 0.05;

BakeSettings settingsFor(BakeOcclusion occlusion, std::vector<std::vector<ObjectId>> doors) {
  return {.occlusion = occlusion,
          .max_depth = 3,
          .near_distance = kNear,
          .doors = std::move(doors),
          .merge_tolerance = 0.2};
}

// Judges by rays what is hidden while all doors are open, and while each group is closed. Returns how many
// objects were hidden in all views: the first number is that of open doors, the last that of closed ones.
std::vector<std::size_t> judgeAll(const DoorScene& rooms, const BakedVisibility& baked, std::uint32_t step,
                                  std::uint32_t seed) {
  std::vector<std::size_t> hidden;
  for (const std::vector<ObjectId>& closed : closedSetsOf(baked)) {
    SCOPED_TRACE(std::to_string(closed.size()) + " doors are closed");
    const Scene scene = withDoors(rooms, closed);
    const BakedVisibility left = leftWith(baked, closed);
    BakeJudge judge(scene, left);
    judge.judge(2, step, kNear, seed);
    hidden.push_back(judge.hidden);
  }
  return hidden;
}

// Whether the set for viewers at a place holds the object while these doors are closed.
bool seesAt(const BakedVisibility& baked, const Vec3d& eye, ObjectId object,
            const std::vector<ObjectId>& closed) {
  const sight_test::Bytes bytes = sight_test::bytesOf(baked);
  SetQuery query(*sight_test::opened(bytes));
  query.setClosedDoors(closed);
  return sight_test::seenBy(query, eye, kNear)[object.value];
}

constexpr Vec3d kInFirstRoom{1.3, 1.6, 2.4};

// From the first room the object is seen while all of these doors are open, and not while they are closed.
void expectSeenOnlyWhileOpen(const BakedVisibility& baked, ObjectId object,
                             const std::vector<ObjectId>& doors) {
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, object, {}));
  EXPECT_FALSE(seesAt(baked, kInFirstRoom, object, doors));
}

TEST(Doors, OfTwoRoomsHideTheOtherRoomWhileTheyAreClosed) {
  RoomBuilder builder(2);
  builder.addWall(0, {2.5f});
  const ObjectId crate = builder.addCrate(1, 3, 2.5f);
  const DoorScene rooms = builder.build();
  const BakedVisibility baked =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kFused, alone(rooms.doors)));
  expectSeenOnlyWhileOpen(baked, crate, rooms.doors);
  const std::vector<std::size_t> hidden = judgeAll(rooms, baked, 3, 1);
  EXPECT_GT(hidden[1], hidden[0]);
}

TEST(Doors, InSeriesEachHideWhatIsBehindThem) {
  RoomBuilder builder(3);
  builder.addWall(0, {2.5f});
  builder.addWall(1, {2.5f});
  const ObjectId middle = builder.addCrate(1, 3, 2.5f), last = builder.addCrate(2, 3, 2.5f);
  const DoorScene rooms = builder.build();
  const std::vector<ObjectId> first{rooms.doors[0]}, second{rooms.doors[1]};
  const BakedVisibility baked =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kFused, alone(rooms.doors)));
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, middle, {}));
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, last, {}));
  EXPECT_FALSE(seesAt(baked, kInFirstRoom, middle, first));
  EXPECT_FALSE(seesAt(baked, kInFirstRoom, last, first));
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, middle, second));
  EXPECT_FALSE(seesAt(baked, kInFirstRoom, last, second));
  judgeAll(rooms, baked, 5, 2);
}

TEST(Doors, SideBySideHideARoomOnlyTogether) {
  RoomBuilder builder(2);
  builder.addWall(0, {1.5f, 3.0f});
  const ObjectId crate = builder.addCrate(1, 3, 2.75f);
  const DoorScene rooms = builder.build();
  const BakedVisibility baked =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kFused, alone(rooms.doors)));
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, crate, {rooms.doors[0]}));
  EXPECT_TRUE(seesAt(baked, kInFirstRoom, crate, {rooms.doors[1]}));
  EXPECT_FALSE(seesAt(baked, kInFirstRoom, crate, rooms.doors));
  judgeAll(rooms, baked, 3, 3);
}

// Without the group, only all doors of the scene hide the room together.
TEST(Doors, OfAGroupHideTogetherWhateverOtherDoorsDo) {
  RoomBuilder builder(3);
  builder.addWall(0, {1.5f, 3.0f});
  builder.addWall(1, {2.5f});
  const ObjectId crate = builder.addCrate(1, 3, 2.75f);
  const DoorScene rooms = builder.build();
  const std::vector<ObjectId> pair{rooms.doors[0], rooms.doors[1]};
  const BakedVisibility apart =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kFused, alone(rooms.doors)));
  EXPECT_TRUE(seesAt(apart, kInFirstRoom, crate, pair));
  EXPECT_FALSE(seesAt(apart, kInFirstRoom, crate, rooms.doors));
  const BakedVisibility grouped =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kFused, {pair, {rooms.doors[2]}}));
  EXPECT_FALSE(seesAt(grouped, kInFirstRoom, crate, pair));
  EXPECT_FALSE(seesAt(grouped, kInFirstRoom, crate, rooms.doors));
  EXPECT_TRUE(seesAt(grouped, kInFirstRoom, crate, {rooms.doors[0], rooms.doors[2]}));
  judgeAll(rooms, grouped, 7, 4);
}

// Single convex occluders hide little through a doorway, so here a shutter is the whole wall.
TEST(Doors, OfConvexBodiesHideByThemselves) {
  RoomBuilder builder(2);
  builder.addShutter(0);
  const ObjectId crate = builder.addCrate(1, 3, 2.5f);
  const DoorScene rooms = builder.build();
  const BakedVisibility baked =
      test::baked(rooms.scene, settingsFor(BakeOcclusion::kConvex, alone(rooms.doors)));
  expectSeenOnlyWhileOpen(baked, crate, rooms.doors);
  judgeAll(rooms, baked, 1, 5);
}

TEST(Doors, AreInEverySetWhereverTheyMayBe) {
  RoomBuilder builder(3);
  builder.addWall(0, {1.0f});
  builder.addWall(1, {4.0f});
  const DoorScene rooms = builder.build();
  for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
    const BakedVisibility baked = test::baked(rooms.scene, settingsFor(occlusion, alone(rooms.doors)));
    const auto expectDoors = [&](std::uint32_t set) {
      for (const std::vector<ObjectId>& closed : combinationsOf(rooms.doors)) {
        for (const ObjectId door : rooms.doors) {
          EXPECT_TRUE(membersWith(baked, set, closed)[door.value]);
        }
      }
    };
    for (const OctreeLeaf& leaf : baked.octree.leaves) {
      expectDoors(leaf.set);
      // Where the plane leaves no viewers on a side, its set is empty.
      for (const std::uint32_t side : {leaf.front_set, leaf.back_set}) {
        if (leaf.plane != OctreeLeaf::kNoPlane && !baked.sets[side].empty()) {
          expectDoors(side);
        }
      }
    }
  }
}

TEST(Doors, HideNothingThatRaysSeeInRandomRooms) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const DoorScene rooms = test::randomRooms(seed);
    for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
      const BakedVisibility baked = test::baked(rooms.scene, settingsFor(occlusion, alone(rooms.doors)));
      const std::vector<std::size_t> hidden = judgeAll(rooms, baked, 9, seed);
      if (occlusion == BakeOcclusion::kFused) {
        EXPECT_GT(hidden.back(), hidden.front()) << "the test would prove little";
      }
    }
  }
}

// The doors are exactly as if the scene's author had said that they never occlude, but that they are in every
// set.
TEST(Doors, ThatAreOpenAreNoOccluders) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const DoorScene rooms = test::randomRooms(seed);
    for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
      const BakedVisibility with = test::baked(rooms.scene, settingsFor(occlusion, alone(rooms.doors)));
      const BakedVisibility without = test::baked(withDoors(rooms, {}), settingsFor(occlusion, {}));
      ASSERT_EQ(with.octree.nodes, without.octree.nodes) << seed;
      ASSERT_EQ(with.octree.planes, without.octree.planes) << seed;
      for (std::size_t leaf = 0; leaf < with.octree.leaves.size(); ++leaf) {
        const auto check = [&](std::uint32_t set, std::uint32_t plain) {
          std::vector<bool> expected = test::membersOf(without, plain);
          // An empty set is that of no viewers.
          const bool viewers = std::count(expected.begin(), expected.end(), true) > 0;
          for (const ObjectId door : rooms.doors) {
            expected[door.value] = viewers;
          }
          EXPECT_EQ(test::membersOf(with, set), expected) << seed;
        };
        const OctreeLeaf &a = with.octree.leaves[leaf], &b = without.octree.leaves[leaf];
        check(a.set, b.set);
        if (a.plane != OctreeLeaf::kNoPlane) {
          check(a.front_set, b.front_set);
          check(a.back_set, b.back_set);
        }
      }
      EXPECT_TRUE(without.doors.doors.empty());
      EXPECT_TRUE(without.doors.hidden_ends.empty());
    }
  }
}

// Which cells see what is decided while all doors are open, so the marks of doors alone may not tell bakes
// apart.
TEST(Doors, AreOfThePlan) {
  const DoorScene rooms = test::randomRooms(1);
  const OccluderSet occluders = test::allOccluders(rooms.scene);
  std::set<std::uint64_t> plans;
  for (const std::vector<std::vector<ObjectId>>& doors :
       {std::vector<std::vector<ObjectId>>{}, alone({rooms.doors[0]}), alone({rooms.doors[1]}),
        alone(rooms.doors)}) {
    plans.insert(
        Bake::plan(rooms.scene.view(), occluders, settingsFor(BakeOcclusion::kConvex, doors))->hash());
  }
  EXPECT_EQ(plans.size(), 4u);
}

TEST(Doors, AreTheSameWhoeverBakesTheParts) {
  const DoorScene rooms = test::randomRooms(2);
  const BakeSettings settings = settingsFor(BakeOcclusion::kFused, alone(rooms.doors));
  const Result<Bake> bake = Bake::plan(rooms.scene.view(), test::allOccluders(rooms.scene), settings);
  ASSERT_TRUE(bake);
  const BakedParts parts =
      test::partsOf(*bake, [&](const PartTask& part) { return Bake::Worker(*bake).bake(part); });
  EXPECT_EQ(parts, bake->bakeAll());
}

TEST(Doors, AreRefusedThatAreNotThereOrHideNothing) {
  DoorScene rooms = test::randomRooms(1);
  const auto problem = [&](std::vector<std::vector<ObjectId>> doors) {
    const Result<Bake> bake = Bake::plan(rooms.scene.view(), test::allOccluders(rooms.scene),
                                         settingsFor(BakeOcclusion::kConvex, std::move(doors)));
    return bake ? std::string() : bake.error().message;
  };
  EXPECT_EQ(problem(alone(rooms.doors)), "");
  EXPECT_NE(problem({{ObjectId(100000u)}}).find("door 100000"), std::string::npos);
  EXPECT_NE(problem({{ObjectId()}}), "");
  EXPECT_NE(problem({{}}), "");
  rooms.scene.objects[rooms.doors[0].value].mark = OccluderMark::kNever;
  EXPECT_NE(problem({{rooms.doors[0]}}).find("never"), std::string::npos);
}

// What is a door may change from bake to bake, although the scene stays the same: its occluders come or go.
TEST(Doors, AreAskedAnewByAnUpdateWhateverWasADoorBefore) {
  const DoorScene rooms = test::randomRooms(3);
  ASSERT_GT(rooms.doors.size(), 1u);
  for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
    test::EditedScene edited = test::EditedScene::of(rooms.scene);
    sight_test::Bytes answers;
    for (const std::vector<std::vector<ObjectId>>& doors :
         {alone(rooms.doors), std::vector<std::vector<ObjectId>>{}, alone({rooms.doors[0]}),
          alone({rooms.doors[1]}), alone(rooms.doors)}) {
      const Scene scene = edited.scene();
      test::AnsweredBake bake(scene, settingsFor(occlusion, doors));
      const test::Answered full = bake.inFull();
      const test::Answered updated = answers.empty() ? full : bake.after(answers);
      EXPECT_EQ(updated.file, full.file);
      answers = updated.answers;
      edited.pieces.back().move({0, 0.25f, 0});  // a crate
    }
  }
}

// Random sets of objects for cells, some of which have a plane.
class RandomCells {
 public:
  RandomCells(std::uint32_t objects, std::uint32_t seed) : objects_(objects), random_(seed) {}

  pvs::BakedCell leaf() {
    pvs::BakedCell cell;
    addSet(cell.sets.whole, cell.sets.whole_doors);
    if (random_() % 2 == 0) {
      cell.sets.plane = CellPlane{.normal = {1, 0, 0}, .front = 1.0, .back = 0.0};
      addSet(cell.sets.front, cell.sets.front_doors);
      addSet(cell.sets.back, cell.sets.back_doors);
    }
    return cell;
  }

 private:
  // Some of the objects that are in `of`.
  pvs::Runs some(const pvs::Runs& of) {
    pvs::Runs all;
    for (const pvs::ObjectRun& run : of) {
      for (std::uint32_t i = run.begin; i < run.end; ++i) {
        const pvs::ObjectRun one{i, i + 1};
        pvs::Runs more;
        pvs::unite(all, std::span(&one, random_() % 4 != 0 ? 1 : 0), more);
        all.swap(more);
      }
    }
    return all;
  }
  // Object 0 is always seen: a set of nothing is like no other one.
  void addSet(pvs::Runs& seen, pvs::DoorRuns& doors) {
    const pvs::Runs others = some({{1, objects_}});
    for (std::uint32_t group = 0; group < 2; ++group) {
      if (pvs::Runs hidden = some(others); !hidden.empty() && random_() % 4 != 0) {
        doors.push_back({group, std::move(hidden)});
      }
    }
    const pvs::ObjectRun first{0, 1};
    pvs::unite(others, std::span(&first, 1), seen);
  }

  std::uint32_t objects_;
  std::mt19937 random_;
};

bool holds(const pvs::Runs& runs, std::uint32_t object) {
  return std::any_of(runs.begin(), runs.end(),
                     [object](const pvs::ObjectRun& run) { return run.begin <= object && object < run.end; });
}

bool isHidden(const pvs::DoorRuns& doors, std::uint32_t group, std::uint32_t object) {
  return std::any_of(doors.begin(), doors.end(), [&](const pvs::HiddenByDoors& hidden) {
    return hidden.group == group && holds(hidden.hidden, object);
  });
}

// From some child it may be seen although doors hide it from another one.
TEST(Doors, OfAMergedCellHideWhatTheyHideFromEachOfItsChildrenThatSeesIt) {
  const DoorScene rooms = test::randomRooms(1);
  BakeSettings settings = settingsFor(BakeOcclusion::kConvex, alone(rooms.doors));
  settings.triangle_budget = 1u << 30;
  settings.merge_tolerance = 1e6;
  settings.viewers = {sceneBounds(rooms.scene.view())};
  const pvs::BakeScene scene(rooms.scene.view(), test::allOccluders(rooms.scene), settings, serialFor);
  const auto objects = static_cast<std::uint32_t>(rooms.scene.objects.size());
  std::size_t hidden = 0, kept = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    RandomCells random(objects, seed);
    pvs::BakedCell cell;
    for (int i = 0; i < 8; ++i) {
      cell.children.push_back(random.leaf());
    }
    const std::vector<pvs::BakedCell> children = cell.children;
    pvs::mergeChildren(scene, cell);
    ASSERT_TRUE(cell.leaf());
    const auto check = [&](const pvs::Runs& seen, const pvs::DoorRuns& doors, const auto& setOf) {
      for (std::uint32_t object = 0; object < objects; ++object) {
        for (std::uint32_t group = 0; group < 2; ++group) {
          const bool left = std::any_of(children.begin(), children.end(), [&](const pvs::BakedCell& child) {
            const auto [of_child, hidden_of_child] = setOf(child.sets);
            return holds(*of_child, object) && !isHidden(*hidden_of_child, group, object);
          });
          ASSERT_EQ(holds(seen, object) && !isHidden(doors, group, object), left) << seed;
          hidden += isHidden(doors, group, object) ? 1 : 0;
          kept += left ? 1 : 0;
        }
      }
    };
    using Set = std::pair<const pvs::Runs*, const pvs::DoorRuns*>;
    check(cell.sets.whole, cell.sets.whole_doors,
          [](const pvs::CellSets& sets) { return Set(&sets.whole, &sets.whole_doors); });
    if (cell.sets.plane) {
      check(cell.sets.front, cell.sets.front_doors, [](const pvs::CellSets& sets) {
        return sets.plane ? Set(&sets.front, &sets.front_doors) : Set(&sets.whole, &sets.whole_doors);
      });
      check(cell.sets.back, cell.sets.back_doors, [](const pvs::CellSets& sets) {
        return sets.plane ? Set(&sets.back, &sets.back_doors) : Set(&sets.whole, &sets.whole_doors);
      });
    }
  }
  EXPECT_GT(hidden, 0u);
  EXPECT_GT(kept, hidden);
}

// Viewers behind a closed door would see what it hides from them, if their cell became one with those beside
// the door.
TEST(Doors, KeepCellsApartFromWhichTheyHideDifferentThings) {
  const DoorScene rooms = test::randomRooms(1);
  BakeSettings settings = settingsFor(BakeOcclusion::kConvex, alone(rooms.doors));
  settings.triangle_budget = 1;
  settings.merge_tolerance = 0.25;
  settings.viewers = {sceneBounds(rooms.scene.view())};
  const pvs::BakeScene scene(rooms.scene.view(), test::allOccluders(rooms.scene), settings, serialFor);
  const auto objects = static_cast<std::uint32_t>(rooms.scene.objects.size());
  const pvs::DoorRuns half{{1, {{0, objects / 2}}}};
  const auto becomeOne = [&](int with_doors, bool by_sides) {
    pvs::BakedCell cell;
    for (int i = 0; i < 8; ++i) {
      pvs::BakedCell& child = cell.children.emplace_back();
      child.sets.whole = {{0, objects}};
      pvs::DoorRuns* of_child = &child.sets.whole_doors;
      if (by_sides) {
        child.sets.plane = CellPlane{.normal = {1, 0, 0}, .front = 1.0, .back = 0.0};
        child.sets.front = child.sets.whole;
        child.sets.back = {{0, 1}};
        of_child = &child.sets.front_doors;
      }
      if (i < with_doors) {
        *of_child = half;
      }
    }
    pvs::mergeChildren(scene, cell);
    return cell.leaf();
  };
  for (const bool by_sides : {false, true}) {
    EXPECT_TRUE(becomeOne(0, by_sides));
    EXPECT_FALSE(becomeOne(1, by_sides));
    EXPECT_FALSE(becomeOne(7, by_sides));
    EXPECT_TRUE(becomeOne(8, by_sides));
  }
}

TEST(Doors, AreTheSameWithAndWithoutSamples) {
  RoomBuilder builder(3);
  builder.addShutter(0);
  builder.addShutter(1);
  builder.addCrate(1, 3, 2.5f);
  builder.addCrate(2, 3, 2.5f);
  const DoorScene rooms = builder.build();
  BakeSettings settings = settingsFor(BakeOcclusion::kConvex, alone(rooms.doors));
  const BakedVisibility with = test::baked(rooms.scene, settings);
  EXPECT_FALSE(with.doors.hidden.empty());
  settings.sample_bytes = 0;
  EXPECT_EQ(sight_test::bytesOf(test::baked(rooms.scene, settings)), sight_test::bytesOf(with));
}

// A door may be named more than once, in any order.
TEST(Doors, AreSetsOfDoors) {
  const DoorScene rooms = test::randomRooms(1);
  ASSERT_GT(rooms.doors.size(), 1u);
  const ObjectId a = rooms.doors[0], b = rooms.doors[1];
  const auto groups = [&](std::vector<std::vector<ObjectId>> doors) {
    const BakedVisibility baked =
        test::baked(rooms.scene, settingsFor(BakeOcclusion::kConvex, std::move(doors)));
    return std::pair(baked.doors.doors, baked.doors.group_ends);
  };
  EXPECT_EQ(groups({{b, a, a}, {a, b}}), groups({{a}, {b}}));
  EXPECT_EQ(groups({{a}, {b}}).second.size(), 3u);
  EXPECT_EQ(groups({{a}}).second.size(), 1u);
}

TEST(Doors, OfACellAreReadAsWritten) {
  const DoorScene rooms = test::randomRooms(1);
  const pvs::BakeScene scene(rooms.scene.view(), test::allOccluders(rooms.scene),
                             settingsFor(BakeOcclusion::kConvex, alone(rooms.doors)), serialFor);
  pvs::BakedCell cell;
  cell.viewers = {{1, 2, 3}, {4, 5, 6}};
  cell.sets.whole = cell.sets.front = cell.sets.back = {{0, 4}};
  cell.sets.plane = CellPlane{{1, 0, 0}, 1, 0};
  cell.sets.back_doors = {{0, {{1, 2}}}, {1, {{0, 1}, {3, 4}}}};
  const auto bytesOf = [](const pvs::BakedCell& written) {
    base::ByteWriter writer;
    pvs::write(written, writer);
    return writer.take();
  };
  const std::vector<std::byte> bytes = bytesOf(cell);
  base::ByteReader reader(bytes);
  const std::optional<pvs::BakedCell> read = pvs::readCell(reader, 0, scene);
  ASSERT_TRUE(read);
  EXPECT_TRUE(reader.atEnd());
  EXPECT_EQ(bytesOf(*read), bytes);
  ASSERT_EQ(read->sets.back_doors.size(), 2u);
  EXPECT_EQ(read->viewers, cell.viewers);
  cell.sets.back_doors[1].hidden.clear();
  const std::vector<std::byte> hiding_nothing = bytesOf(cell);
  base::ByteReader other(hiding_nothing);
  EXPECT_FALSE(pvs::readCell(other, 0, scene));
}

// Where viewers are in parts of cells, some of which a budget in bytes or merging made one of.
TEST(Doors, HideNothingThatIsSeenFromPartsOfCells) {
  std::size_t hidden = 0, partial = 0;
  for (const auto occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const DoorScene rooms = test::randomRooms(seed);
      std::mt19937 random(seed);
      const auto place = [&](float most) { return static_cast<float>(random() % 1024) / 1024.0f * most; };
      BakeSettings settings = settingsFor(occlusion, alone(rooms.doors));
      for (int i = 0; i < 5; ++i) {
        const Vec3f at(place(17), place(2), place(5));
        settings.viewers.push_back({at, at + Vec3f(place(4), place(1), place(3))});
      }
      settings.triangle_budget = 60;
      settings.max_depth = occlusion == BakeOcclusion::kFused ? 2 : 4;
      settings.merge_tolerance = seed % 2 == 0 ? 0.6 : 0.05;
      const test::BakedOnce bake(rooms.scene, settings);
      const std::uint64_t bytes = sight_test::bytesOf(*bake.fitted(0)).size();
      for (const std::uint64_t budget : {std::uint64_t{0}, bytes * 4 / 5}) {
        const Result<BakedVisibility> made = bake.fitted(budget);
        if (!made) {
          continue;  // the fewest cells take more bytes
        }
        partial += made->octree.viewers.size();
        for (const std::vector<ObjectId>& closed : closedSetsOf(*made)) {
          const Scene scene = withDoors(rooms, closed);
          const BakedVisibility left = leftWith(*made, closed);
          BakeJudge judge(scene, left);
          judge.judge(2, 1, 0.05, seed);
          hidden += judge.hidden;
        }
      }
    }
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_GT(partial, 100u);
}

}  // namespace
}  // namespace sightline
