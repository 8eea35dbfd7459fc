// Baked sets of a world that changes: sets as tight as exact visibility allows, and objects that go.

#include <gtest/gtest.h>

#include "tests/culling/fake_sets.h"
#include "tests/support/rounds.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// A story, and the set of what exact visibility sees from one view as if it had been baked for its eye.
struct Baked {
  Story story{allShapes()};
  std::vector<InstanceId> ids;  // by ObjectId
  std::vector<bool> members;
  View view = viewFrom({0, 1.5, 12}, {0, 0, -1});
  std::vector<Box> boxes;

  Baked(Chance& chance, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      story.add(chance.below(5), chance.placement(12.0, 5.0));
    }
    const Scene scene = story.scene(ids);
    const ExactVisibility exact(scene.view());
    std::vector<ObjectId> all;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      all.emplace_back(i);
      boxes.push_back(scene.objects[i].bounds);
    }
    for (const Decision& decision : exact.decide(view, all, 50'000)) {
      members.push_back(decision.verdict != Verdict::kHidden);
    }
  }
};

std::size_t countOf(const std::vector<bool>& members) {
  return static_cast<std::size_t>(std::count(members.begin(), members.end(), true));
}

TEST(WorldSets, HoldUntilSomethingInThemGoes) {
  std::size_t holding = 0, void_ones = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(30u); ++seed) {
    Chance chance(seed);
    Baked baked(chance, 40);
    fake_sets::FakeSets sets(baked.boxes);
    sets.use(7, baked.members);
    World& world = baked.story.world;
    const SetsId id = world.addSets(baked.ids, sets.boxes());
    EXPECT_EQ(world.tombstones(id), 0u);
    // Sets alone hide here, so that whatever they do wrong shows.
    WorldCuller culler({.occlusion = false}), plain({.occlusion = false});
    culler.useSets(id, &sets);
    bool holds = true;
    for (int change = 0; change < 12; ++change) {
      culler.cull(world, baked.view);
      EXPECT_EQ(judge(baked.story, baked.view, culler).wrong, "") << seed << " " << change;
      if (change == 0) {
        EXPECT_EQ(culler.visible().size(), countOf(baked.members));
      }
      plain.cull(world, baked.view);
      (holds ? holding : void_ones) += 1;
      for (std::size_t o = 0; o < baked.ids.size() && holds; ++o) {
        EXPECT_FALSE(!baked.members[o] && baked.ids[o].valid() && keeps(culler, baked.ids[o]));
      }
      EXPECT_TRUE(holds || std::ranges::equal(culler.visible(), plain.visible()));
      // In every other world only what is in no set goes for a while.
      std::uint32_t object = chance.below(static_cast<std::uint32_t>(baked.ids.size()));
      while (seed % 2 == 0 && change < 6 && baked.members[object]) {
        object = (object + 1) % static_cast<std::uint32_t>(baked.ids.size());
      }
      const InstanceId gone = baked.ids[object];
      const bool there = gone.valid();
      holds = holds && !(there && baked.members[object]);
      if (there && change % 3 == 0) {
        baked.story.remove(gone);
      } else if (there && change % 3 == 1) {
        baked.story.move(gone, chance.placement(12.0, 5.0));
      } else if (there) {
        baked.story.show(gone, false);
      }
      // What came is in no set, whatever id it has.
      const InstanceId came = baked.story.add(0, chance.placement(12.0, 5.0));
      EXPECT_EQ(came == gone, there && change % 3 == 0);
      baked.ids[object] = InstanceId();
    }
  }
  EXPECT_GT(holding, test::rounds(100u));
  EXPECT_GT(void_ones, test::rounds(100u));
}

TEST(WorldSets, NameOnlyWhatStandsWhereItWasBaked) {
  Chance chance(3);
  Baked baked(chance, 40);
  World& world = baked.story.world;
  fake_sets::FakeSets sets(baked.boxes);
  sets.use(1, std::vector<bool>(baked.ids.size(), false));
  // Nothing may be seen, says the set; but three are not what was baked.
  baked.story.show(baked.ids[3], false);
  Mat4 other = baked.story.told.at(baked.ids[4].value).world_from_mesh;
  other(0, 3) += 0.5;
  baked.story.move(baked.ids[4], other);
  std::vector<InstanceId> given = baked.ids;
  given[5] = InstanceId(4711u);
  const SetsId id = world.addSets(given, sets.boxes());
  EXPECT_EQ(world.tombstones(id), 3u);
  WorldCuller culler({.occlusion = false}), plain({.occlusion = false});
  culler.useSets(id, &sets);
  View all = baked.view;
  all.tan_half_fovy = 8.0;
  all.eye = {0, 1.5, 60};
  culler.cull(world, all);
  EXPECT_EQ(std::vector(culler.visible().begin(), culler.visible().end()),
            (std::vector{baked.ids[4], baked.ids[5]}));
  // The moved one is a tombstone only of sets that name it.
  std::vector<bool> members(baked.ids.size(), false);
  members[4] = true;
  sets.use(2, members);
  plain.cull(world, all);
  culler.cull(world, all);
  EXPECT_TRUE(std::ranges::equal(culler.visible(), plain.visible()));
  // Views in which not all is drawn, views that are orthographic, and sets that are dropped.
  sets.use(1, std::vector<bool>(baked.ids.size(), false));
  const auto keepsAll = [&] {
    culler.cull(world, all);
    plain.cull(world, all);
    return std::ranges::equal(culler.visible(), plain.visible());
  };
  EXPECT_FALSE(keepsAll());
  culler.setClipPlane({{0, 0, -1}, 60.0});
  EXPECT_TRUE(keepsAll());
  culler.setClipPlane(Plane());
  EXPECT_FALSE(keepsAll());
  culler.reset();
  EXPECT_FALSE(keepsAll());
  all.orthographic = true;
  EXPECT_TRUE(keepsAll());
  all.orthographic = false;
  sets.useEverything();
  EXPECT_TRUE(keepsAll());
  sets.use(1, std::vector<bool>(baked.ids.size(), false));
  EXPECT_FALSE(keepsAll());
  world.setGroups(baked.ids[0], 2);
  EXPECT_FALSE(keepsAll());
  world.removeSets(id);
  EXPECT_TRUE(keepsAll());
  world.removeSets(id);
  world.removeSets(SetsId());
  // The number is not used again: the culler was not told that its sets were removed.
  const fake_sets::FakeSets fewer(std::span(baked.boxes).first(3));
  EXPECT_NE(world.addSets(given, fewer.boxes()), id);
  EXPECT_TRUE(keepsAll());
  culler.useSets(id, nullptr);
  EXPECT_TRUE(keepsAll());
}

// Sets hold while doors are open, whatever these do.
TEST(WorldSets, DoorsAreNoTombstones) {
  Chance chance(5);
  Baked baked(chance, 40);
  World& world = baked.story.world;
  fake_sets::FakeSets sets(baked.boxes);
  std::vector<bool> members(baked.ids.size(), false);
  members[7] = members[8] = members[9] = true;  // the doors, which each set names
  sets.use(1, members);
  View all = baked.view;
  all.tan_half_fovy = 8.0;
  all.eye = {0, 1.5, 60};
  const std::vector<ObjectId> doors{ObjectId(7u), ObjectId(8u), ObjectId(9u), ObjectId(4711u)};
  baked.story.show(baked.ids[9], false);
  const SetsId id = world.addSets(baked.ids, sets.boxes(), {}, doors);
  WorldCuller culler({.occlusion = false});
  culler.useSets(id, &sets);
  const auto kept = [&] {
    culler.cull(world, all);
    return std::vector(culler.visible().begin(), culler.visible().end());
  };
  EXPECT_EQ(world.tombstones(id), 0u);
  EXPECT_EQ(kept(), (std::vector{baked.ids[7], baked.ids[8]}));
  Mat4 open = baked.story.told.at(baked.ids[7].value).world_from_mesh;
  open(0, 3) += 0.5;
  baked.story.move(baked.ids[7], open);
  baked.story.remove(baked.ids[8]);
  baked.story.show(baked.ids[9], true);
  EXPECT_EQ(world.tombstones(id), 0u);
  EXPECT_EQ(kept(), (std::vector{baked.ids[7], baked.ids[9]}));
  // Without their names, they are tombstones of all sets.
  WorldCuller plain({.occlusion = false});
  plain.cull(world, all);
  const SetsId unnamed = world.addSets(baked.ids, sets.boxes());
  EXPECT_EQ(world.tombstones(unnamed), 2u);
  culler.useSets(id, nullptr);
  culler.useSets(unnamed, &sets);
  EXPECT_TRUE(std::ranges::equal(kept(), plain.visible()));
}

// A cell of the world that is streamed in elsewhere than it was baked, and goes again.
TEST(WorldSets, ACellIsUsedWhereverItIsPut) {
  for (const Vec3d& place : {Vec3d(0, 0, 0), Vec3d(4096, 0, -8192), Vec3d(1 << 20, 64, 1 << 20)}) {
    Chance chance(5);
    Baked baked(chance, 40);
    fake_sets::FakeSets sets(baked.boxes);
    sets.use(1, baked.members);
    World world;
    std::vector<MeshId> meshes;
    for (const Shape& shape : allShapes()) {
      meshes.push_back(addShape(world, shape));
    }
    world.setOrigin(place);
    std::vector<InstanceId> ids;
    std::vector<Instance> cell;
    for (const InstanceId id : baked.ids) {
      const Told& told = baked.story.told.at(id.value);
      cell.push_back({.mesh = meshes[told.shape], .world_from_mesh = movedBy(told.world_from_mesh, place)});
    }
    world.add(cell, ids);
    const SetsId id = world.addSets(ids, sets.boxes(), place);
    EXPECT_EQ(world.tombstones(id), 0u);
    WorldCuller culler({.occlusion = false});
    culler.useSets(id, &sets);
    View view = baked.view;
    view.eye = view.eye + place;
    culler.cull(world, view);
    EXPECT_EQ(sets.last_eye, baked.view.eye);
    EXPECT_EQ(sets.last_near_distance, nearDistance(view));
    EXPECT_EQ(culler.visible().size(), countOf(baked.members));
    for (const InstanceId gone : ids) {
      world.remove(gone);
    }
    world.removeSets(id);
    culler.useSets(id, nullptr);
    culler.cull(world, view);
    EXPECT_TRUE(culler.visible().empty());
  }
}

// What a wall 6 m wide hides, as if it had been baked so.
struct WallBeforeCrate {
  std::vector<Box> boxes{{{-3, -3, -11}, {3, 3, -10}}, {{-0.5f, -0.5f, -15}, {0.5f, 0.5f, -14}}};
  fake_sets::FakeSets sets{boxes};
  World world;
  std::vector<InstanceId> ids;  // by ObjectId: the wall, the crate

  explicit WallBeforeCrate(const Instance& wall, const Shape& shape = boxShape()) {
    sets.use(1, {true, false});
    Instance given = wall;
    given.mesh = addShape(world, shape);
    ids.push_back(world.add(given));
    ids.push_back(world.add(
        {.mesh = addShape(world, boxShape()), .world_from_mesh = boxAt({-0.5, -0.5, -15}, {1, 1, 1})}));
  }
  static Mat4 wallMovedBy(double aside) { return boxAt({-3.0 + aside, -3, -11}, {6, 6, 1}); }
  static bool showsCrate(WorldCuller& culler, const World& world, const std::vector<InstanceId>& ids) {
    culler.cull(world, viewFrom({0, 0, 0}, {0, 0, -1}));
    return culler.isVisible(ids[1]);
  }
};

// How far a cell of the world lies from where the world's boxes are relative to says nothing about it.
TEST(WorldSets, WhatWasMovedIsATombstoneHoweverFarFromTheOriginTheBakedSceneLies) {
  for (const double base : {0.0, 1e4, 1e7}) {
    for (const double aside : {0.0, 0x1p-10, 2.0}) {
      const Vec3d to(base, 0, 0);
      WallBeforeCrate scene({.world_from_mesh = movedBy(WallBeforeCrate::wallMovedBy(aside), to)});
      scene.world.setTransform(scene.ids[1], movedBy(boxAt({-0.5, -0.5, -15}, {1, 1, 1}), to));
      const SetsId id = scene.world.addSets(scene.ids, scene.sets.boxes(), to);
      EXPECT_EQ(scene.world.tombstones(id), aside == 0.0 ? 0u : 1u) << base << " " << aside;
      WorldCuller culler({.occlusion = false});
      culler.useSets(id, &scene.sets);
      culler.cull(scene.world, viewFrom(to, {0, 0, -1}));
      EXPECT_EQ(culler.isVisible(scene.ids[1]), aside != 0.0) << base << " " << aside;
    }
  }
}

// A kilometre from the baked scene's origin, along x alone: rounding is larger along x alone.
TEST(WorldSets, WhatWasMovedByMoreThanRoundingAlongAnyAxisIsATombstone) {
  const std::vector<Box> boxes{{{1000, 0, 0}, {1004, 3, 0.25f}}};
  const fake_sets::FakeSets sets(boxes);
  for (const auto& [by, moved] :
       {std::pair(Vec3d(0x1p-12, 0, 0), false), std::pair(Vec3d(0x1p-9, 0, 0), true),
        std::pair(Vec3d(0, 0x1p-12, 0), true), std::pair(Vec3d(0, 0, 0x1p-12), true),
        std::pair(Vec3d(0, 0x1p-23, 0), false)}) {
    World world;
    const InstanceId ids[] = {world.add({.mesh = addShape(world, boxShape()),
                                         .world_from_mesh = movedBy(boxAt({1000, 0, 0}, {4, 3, 0.25}), by)})};
    EXPECT_EQ(world.tombstones(world.addSets(ids, sets.boxes())), moved ? 1u : 0u) << by.x << " " << by.y;
  }
}

// Each of its borders counts, the upper ones as well as the lower ones.
TEST(WorldSets, WhatIsShorterThanItWasBakedIsATombstoneAtWhicheverEnd) {
  for (const auto& [corner, size] :
       {std::pair(Vec3d(-3, -3, -11), Vec3d(2, 6, 1)), std::pair(Vec3d(1, -3, -11), Vec3d(2, 6, 1)),
        std::pair(Vec3d(-3, -3, -11), Vec3d(6, 2, 1)), std::pair(Vec3d(-3, 1, -11), Vec3d(6, 2, 1))}) {
    WallBeforeCrate scene({.world_from_mesh = boxAt(corner, size)});
    const SetsId id = scene.world.addSets(scene.ids, scene.sets.boxes());
    EXPECT_EQ(scene.world.tombstones(id), 1u) << corner.x << " " << corner.y;
    WorldCuller culler({.occlusion = false});
    culler.useSets(id, &scene.sets);
    EXPECT_TRUE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids)) << corner.x << " " << corner.y;
  }
}

// An instance belongs to the sets that named it last. The earlier ones know of nothing that it does later.
TEST(WorldSets, WhatOtherSetsNameIsATombstoneOfTheEarlierOnes) {
  WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0)});
  const SetsId both = scene.world.addSets(scene.ids, scene.sets.boxes());
  WorldCuller culler({.occlusion = false});
  culler.useSets(both, &scene.sets);
  EXPECT_FALSE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
  const fake_sets::FakeSets of_wall(std::span(scene.boxes).first(1));
  const SetsId wall_alone = scene.world.addSets(std::span(scene.ids).first(1), of_wall.boxes());
  EXPECT_EQ(scene.world.tombstones(both), 1u);
  EXPECT_EQ(scene.world.tombstones(wall_alone), 0u);
  scene.world.setTransform(scene.ids[0], WallBeforeCrate::wallMovedBy(20.0));
  EXPECT_EQ(scene.world.tombstones(wall_alone), 1u);
  EXPECT_TRUE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
}

// A wall that is not drawn in a view hides nothing there.
TEST(WorldSets, HideNothingInViewsThatLeaveOutAGroupOfTheirObjects) {
  for (const std::uint32_t of_wall : {1u, 3u}) {
    WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0), .groups = of_wall});
    scene.world.setGroups(scene.ids[1], 3);
    const SetsId id = scene.world.addSets(scene.ids, scene.sets.boxes());
    for (const std::uint32_t drawn : {1u, 2u, 3u}) {
      WorldCuller culler({.occlusion = false, .groups = drawn});
      culler.useSets(id, &scene.sets);
      EXPECT_EQ(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids), (of_wall & drawn) == 0)
          << of_wall << " " << drawn;
    }
  }
}

// Two cells that lie in the same place: what one set says, or no longer says, is about its own objects.
TEST(WorldSets, OfSeveralCellsSpeakForTheirOwnObjectsAlone) {
  WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0)});
  World& world = scene.world;
  std::vector<InstanceId> others;
  for (const InstanceId id : scene.ids) {
    others.push_back(
        world.add({.mesh = world.meshOf(id),
                   .world_from_mesh = id == scene.ids[0] ? WallBeforeCrate::wallMovedBy(0.0)
                                                         : boxAt({-0.5, -0.5, -15}, {1, 1, 1})}));
  }
  fake_sets::FakeSets sets[] = {fake_sets::FakeSets(scene.boxes), fake_sets::FakeSets(scene.boxes)};
  WorldCuller culler({.occlusion = false});
  culler.useSets(world.addSets(scene.ids, sets[0].boxes()), &sets[0]);
  culler.useSets(world.addSets(others, sets[1].boxes()), &sets[1]);
  for (const unsigned hides : {3u, 1u, 3u, 2u, 0u, 1u}) {  // a bit for each cell
    for (const unsigned cell : {0u, 1u}) {
      if ((hides >> cell & 1) != 0) {
        sets[cell].use(1, {true, false});
      } else {
        sets[cell].useEverything();
      }
    }
    EXPECT_EQ(WallBeforeCrate::showsCrate(culler, world, scene.ids), (hides & 1) == 0) << hides;
    EXPECT_EQ(WallBeforeCrate::showsCrate(culler, world, others), (hides & 2) == 0) << hides;
  }
}

TEST(WorldSets, WhatChangesItsGroupsIsATombstone) {
  WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0)});
  const SetsId id = scene.world.addSets(scene.ids, scene.sets.boxes());
  WorldCuller culler({.occlusion = false, .groups = 1});
  culler.useSets(id, &scene.sets);
  EXPECT_FALSE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
  scene.world.setGroups(scene.ids[0], 2);
  EXPECT_TRUE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
}

// The culler's sets are of as many objects as the world was told of.
TEST(WorldSets, OfOtherBoxesOrInAnotherOrderLeaveNothingOut) {
  WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(20.0)});
  const std::vector<Box> as_it_is{{{17, -3, -11}, {23, 3, -10}}, scene.boxes[1]};
  fake_sets::FakeSets right(as_it_is), exchanged(std::vector{as_it_is[1], as_it_is[0]});
  const SetsId id = scene.world.addSets(scene.ids, right.boxes());
  EXPECT_EQ(scene.world.tombstones(id), 0u);
  exchanged.use(1, {true, false});
  WorldCuller culler({.occlusion = false});
  for (fake_sets::FakeSets* const other : {&scene.sets, &exchanged}) {
    culler.useSets(id, other);
    EXPECT_TRUE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
    EXPECT_EQ(other->finds, 0u);
  }
  right.use(1, {true, false});
  culler.useSets(id, &right);
  EXPECT_FALSE(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids));
}

// Each world counts its sets from 0, and reset() keeps those that the culler was told to use.
TEST(WorldSets, OfOneWorldSayNothingAboutAnotherOne) {
  WallBeforeCrate hidden({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0)}),
      seen({.world_from_mesh = WallBeforeCrate::wallMovedBy(20.0)});
  const fake_sets::FakeSets of_seen(std::vector<Box>{{{17, -3, -11}, {23, 3, -10}}, seen.boxes[1]});
  const SetsId id = hidden.world.addSets(hidden.ids, hidden.sets.boxes());
  EXPECT_EQ(seen.world.addSets(seen.ids, of_seen.boxes()), id);
  WorldCuller culler({.occlusion = false});
  culler.useSets(id, &hidden.sets);
  EXPECT_FALSE(WallBeforeCrate::showsCrate(culler, hidden.world, hidden.ids));
  culler.reset();
  EXPECT_TRUE(WallBeforeCrate::showsCrate(culler, seen.world, seen.ids));
  culler.reset();
  EXPECT_FALSE(WallBeforeCrate::showsCrate(culler, hidden.world, hidden.ids));
}

TEST(WorldSets, WhatIsSaidToHideNothingIsATombstoneWhereverThatIsSaid) {
  for (int how = 0; how < 4; ++how) {
    Shape shape = boxShape();
    shape.settings.occludes = how != 1;
    WallBeforeCrate scene({.world_from_mesh = WallBeforeCrate::wallMovedBy(0.0),
                           .occludes = how != 2,
                           .displacement = how == 3 ? 0.5 : 0.0},
                          shape);
    const SetsId id = scene.world.addSets(scene.ids, scene.sets.boxes());
    EXPECT_EQ(scene.world.tombstones(id), how == 0 ? 0u : 1u) << how;
    WorldCuller culler({.occlusion = false});
    culler.useSets(id, &scene.sets);
    EXPECT_EQ(WallBeforeCrate::showsCrate(culler, scene.world, scene.ids), how != 0) << how;
  }
}

}  // namespace
}  // namespace sightline
