// What worlds and their cullers promise, one thing at a time; worlds that change in every way at once are in
// world_fuzz_test.cpp.

#include "sightline/world/world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>
#include <tuple>
#include <utility>

#include "sightline/world/world_culler.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// A wall, and a crate behind it.
struct WallAndCrate {
  Story story{allShapes()};
  InstanceId wall = story.add(0, boxAt({-8, 0, -11}, {16, 8, 1}));
  InstanceId crate = story.add(0, boxAt({0, 0, -21}, {1, 1, 1}));
  View view = viewFrom({0, 1.5, 0}, {0, 0, -1});
  WorldCuller culler;

  bool showsCrate() {
    culler.cull(story.world, view);
    culler.cull(story.world, view);
    EXPECT_EQ(keeps(culler, wall), story.told.contains(wall.value) && story.told.at(wall.value).shown);
    return keeps(culler, crate);
  }
};

TEST(World, AWallHidesAsLongAsItIsThere) {
  WallAndCrate scene;
  EXPECT_FALSE(scene.showsCrate());
  scene.story.show(scene.wall, false);
  EXPECT_TRUE(scene.showsCrate());
  scene.story.show(scene.wall, true);
  EXPECT_FALSE(scene.showsCrate());
  scene.story.move(scene.wall, boxAt({20, 0, -11}, {16, 8, 1}));
  scene.culler.cull(scene.story.world, scene.view);
  EXPECT_TRUE(keeps(scene.culler, scene.crate));
  scene.story.move(scene.wall, boxAt({-8, 0, -11}, {16, 8, 1}));
  EXPECT_FALSE(scene.showsCrate());
  scene.story.remove(scene.wall);
  scene.culler.cull(scene.story.world, scene.view);
  EXPECT_TRUE(keeps(scene.culler, scene.crate));
}

// A post hides from each eye another crate.
TEST(World, WhatEitherEyeSeesIsKept) {
  Story story(allShapes());
  story.add(0, boxAt({-0.5, -4, -4}, {1, 8, 0.5}));
  const InstanceId left = story.add(0, boxAt({-0.75, 0, -12}, {0.25, 0.25, 0.25})),
                   right = story.add(0, boxAt({0.5, 0, -12}, {0.25, 0.25, 0.25})),
                   middle = story.add(0, boxAt({-0.125, 0, -12}, {0.25, 0.25, 0.25}));
  const std::array eyes{viewFrom({-0.5, 0, 0}, {0, 0, -1}), viewFrom({0.5, 0, 0}, {0, 0, -1})};
  WorldCuller one, both;
  for (int frame = 0; frame < 3; ++frame) {
    both.cull(story.world, eyes);
    EXPECT_TRUE(keeps(both, left));
    EXPECT_TRUE(keeps(both, right));
    EXPECT_FALSE(keeps(both, middle));
    EXPECT_NE(both.classify(story.world.boundsOf(left)), Visibility::kHidden);
    EXPECT_EQ(both.classify(story.world.boundsOf(middle)), Visibility::kHidden);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    one.cull(story.world, eyes[eye]);
    one.cull(story.world, eyes[eye]);
    EXPECT_EQ(keeps(one, left), eye == 0);
    EXPECT_EQ(keeps(one, right), eye == 1);
  }
  // No view at all shows nothing.
  both.cull(story.world, std::span<const View>());
  EXPECT_TRUE(both.visible().empty());
}

// Nothing that is removed hides in the very next frame, nor what is added in its place.
TEST(World, AnIdThatIsUsedAgainIsAnotherInstance) {
  WallAndCrate scene;
  EXPECT_FALSE(scene.showsCrate());
  const InstanceId old = scene.wall;
  scene.story.remove(scene.wall);
  scene.wall = scene.story.add(4, boxAt({-8, 0, -11}, {16, 8, 1}));
  EXPECT_EQ(scene.wall, old);
  scene.culler.cull(scene.story.world, scene.view);
  EXPECT_TRUE(keeps(scene.culler, scene.crate));
  EXPECT_EQ(std::vector(scene.culler.appeared().begin(), scene.culler.appeared().end()),
            (std::vector{scene.wall, scene.crate}));
  EXPECT_EQ(std::vector(scene.culler.disappeared().begin(), scene.culler.disappeared().end()),
            std::vector{old});
}

TEST(World, WhatIsDisplacedHidesNothingAndIsLarger) {
  WallAndCrate scene;
  const InstanceId wall = scene.wall;
  scene.story.remove(wall);
  World& world = scene.story.world;
  scene.wall = world.add({.mesh = scene.story.meshes[0],
                          .world_from_mesh = boxAt({-8, 0, -11}, {16, 8, 1}),
                          .displacement = 0.5});
  scene.culler.cull(world, scene.view);
  scene.culler.cull(world, scene.view);
  EXPECT_TRUE(keeps(scene.culler, scene.crate));
  const Box box = world.boundsOf(scene.wall);
  EXPECT_LE(box.min.x, -8.5f);
  EXPECT_GE(box.max.z, -9.5f);
  EXPECT_GT(box.min.x, -8.51f);
}

// Panels side by side, each too small to hide the crate alone.
struct PanelsAndCrate {
  Story story{allShapes()};
  std::vector<InstanceId> panels;
  InstanceId crate, small;
  View view = viewFrom({0, 0, 0}, {0, 0, -1});
  WorldCuller culler{{.raster = {.width = 64, .height = 36}}};

  PanelsAndCrate() {
    for (int i = 0; i < 8; ++i) {
      panels.push_back(story.add(1, boxAt({-2.0 + 0.5 * i, -2, -4}, {0.5, 4, 1})));
    }
    crate = story.add(0, boxAt({-1.25, -1, -9}, {2.5, 2, 1}));
    // Behind one triangle of the fifth panel.
    small = story.add(0, boxAt({0.75, -2.75, -9}, {0.125, 0.125, 0.125}));
  }
  bool shows(InstanceId id) {
    culler.cull(story.world, view);
    culler.cull(story.world, view);
    EXPECT_EQ(judge(story, view, culler).wrong, "");
    return keeps(culler, id);
  }
  bool showsCrate() { return shows(crate); }
};

TEST(World, WhatIsJoinedHidesTogetherUntilAMemberLeaves) {
  PanelsAndCrate scene;
  Story& story = scene.story;
  const std::vector<InstanceId>& panels = scene.panels;
  const auto shows = [&] { return scene.showsCrate(); };
  EXPECT_TRUE(shows());
  WorldJoin prepared = makeJoin(story.world.joinInput(panels));
  const JoinId join = story.world.addJoin(prepared);
  EXPECT_FALSE(shows());
  story.world.removeJoin(join);
  EXPECT_TRUE(shows());
  const JoinId again = story.world.addJoin(prepared);
  EXPECT_FALSE(shows());
  // A change before addJoin() counts too.
  story.move(panels[4], boxAt({0.0, -2, -3.5}, {0.5, 4, 1}));
  EXPECT_TRUE(shows());
  story.world.removeJoin(again);
  story.world.addJoin(prepared);
  EXPECT_TRUE(shows());
  story.remove(panels[3]);
  EXPECT_TRUE(shows());
  // What is not there any more, or never was, is left out.
  prepared.instances[0] = InstanceId(4711u);
  story.world.addJoin(prepared);
  EXPECT_TRUE(shows());
}

// A panel goes to another place in a batch or by itself: after the join, or between joinInput() and
// addJoin(), and then not for the first time.
TEST(World, AMemberThatIsAlwaysOnTheMoveHidesNothingWhereItWas) {
  for (const bool prepared_before : {false, true}) {
    for (const bool in_batch : {false, true}) {
      PanelsAndCrate scene;
      World& world = scene.story.world;
      const MeshId mesh = world.meshOf(scene.panels[0]);
      for (InstanceId& panel : scene.panels) {
        const Mat4 place = scene.story.told.at(panel.value).world_from_mesh;
        scene.story.remove(panel);
        panel = world.add({.mesh = mesh, .world_from_mesh = place, .moves = true});
      }
      const InstanceId moved = scene.panels[4];
      const auto moveTo = [&](const Vec3d& corner) {
        const Mat4 place = boxAt(corner, {0.5, 4, 1});
        if (in_batch) {
          world.setTransforms({&moved, 1}, {&place, 1});
        } else {
          world.setTransform(moved, place);
        }
      };
      const auto showsCrate = [&] {
        scene.culler.cull(world, scene.view);
        scene.culler.cull(world, scene.view);
        return keeps(scene.culler, scene.crate);
      };
      const Vec3d home(0, -2, -4);
      moveTo(home + Vec3d(9, 0, 0));
      moveTo(home);
      const WorldJoin prepared = makeJoin(world.joinInput(scene.panels));
      if (!prepared_before) {
        world.addJoin(prepared);
        EXPECT_FALSE(showsCrate()) << in_batch;
      }
      moveTo(home + Vec3d(9, 0, 0));
      if (prepared_before) {
        world.addJoin(prepared);
      }
      EXPECT_TRUE(showsCrate()) << prepared_before << ' ' << in_batch;
    }
  }
}

// The panels hide the crate together, but one of them is not drawn.
TEST(World, AJoinHidesNothingInViewsThatLeaveOutAGroupOfItsMembers) {
  for (const std::uint32_t part_triangles : {1u, 1024u}) {
    PanelsAndCrate scene;
    World& world = scene.story.world;
    world.setGroups(scene.panels[4], 2);
    world.addJoin(makeJoin(world.joinInput(scene.panels), {.part_triangles = part_triangles}));
    for (const std::uint32_t groups : {1u, 2u, 3u}) {
      WorldCuller culler({.raster = {.width = 64, .height = 36}, .groups = groups});
      world.setGroups(scene.crate, 3);
      culler.cull(world, scene.view);
      culler.cull(world, scene.view);
      EXPECT_TRUE(keeps(culler, scene.crate)) << groups;
    }
  }
}

// Another thread finds the surfaces of a join while a member moves away, or only what the join is to hide.
TEST(World, AJoinIsMadeWhileTheWorldChanges) {
  for (const bool member_moves : {false, true}) {
    PanelsAndCrate scene;
    Story& story = scene.story;
    JoinInput input = story.world.joinInput(scene.panels);
    WorldJoin join;
    std::thread other([&] { join = makeJoin(std::move(input)); });
    const InstanceId passing = story.add(0, boxAt({20, 0, 0}, {1, 1, 1}));
    for (int frame = 0; frame < 20; ++frame) {
      story.move(passing, boxAt({20, 0, 0.125 * frame}, {1, 1, 1}));
      story.world.tidy();
    }
    if (member_moves) {
      story.move(scene.panels[4], boxAt({0.0, -2, -3.5}, {0.5, 4, 1}));
    } else {
      story.move(scene.crate, boxAt({-1.25, -1, -10}, {2.5, 2, 1}));
    }
    other.join();
    story.world.addJoin(std::move(join));
    story.world.addJoin(makeJoin(story.world.joinInput({})));
    EXPECT_EQ(scene.showsCrate(), member_moves);
  }
}

// A wall is seen from its back, which is drawn at first. The later join is as large as the first one and lies
// in the same place.
TEST(World, AJoinMadeAnewHidesNothingByBacksThatAreNotDrawn) {
  Story story({panelShape(true), panelShape(false), boxShape()});
  const Mat4 turned = boxAt({8, -8, -10}, {-16, 16, -1});
  const InstanceId wall = story.add(0, turned), crate = story.add(2, boxAt({0, 0, -20}, {1, 1, 1}));
  const View view = viewFrom({0, 0, 0}, {0, 0, -1});
  WorldCuller culler;
  const JoinId join = story.world.addJoin(makeJoin(story.world.joinInput(std::array{wall})));
  for (int frame = 0; frame < 3; ++frame) {
    culler.cull(story.world, view);
  }
  EXPECT_FALSE(keeps(culler, crate));
  story.world.removeJoin(join);
  story.world.replace(wall, {.mesh = story.meshes[1], .world_from_mesh = turned});
  story.world.addJoin(makeJoin(story.world.joinInput(std::array{wall})));
  for (int frame = 0; frame < 3; ++frame) {
    culler.cull(story.world, view);
    EXPECT_TRUE(keeps(culler, crate));
  }
}

// This holds also where each triangle is a part of its own, drawn together with those that adjoin it.
TEST(World, AMemberThatIsHiddenOrRemovedHidesNothing) {
  for (const bool hidden : {true, false}) {
    for (const std::uint32_t part_triangles : {1u, 1024u}) {
      PanelsAndCrate scene;
      World& world = scene.story.world;
      world.addJoin(makeJoin(world.joinInput(scene.panels), {.part_triangles = part_triangles}));
      EXPECT_FALSE(scene.showsCrate());
      EXPECT_FALSE(scene.shows(scene.small));
      if (hidden) {
        scene.story.show(scene.panels[4], false);
      } else {
        scene.story.remove(scene.panels[4]);
      }
      EXPECT_TRUE(scene.showsCrate());
      EXPECT_TRUE(scene.shows(scene.small));
    }
  }
}

TEST(World, WhatComesIntoViewHidesInTheSameFrame) {
  WallAndCrate scene;
  scene.story.show(scene.wall, false);
  EXPECT_TRUE(scene.showsCrate());
  scene.story.show(scene.wall, true);
  scene.culler.cull(scene.story.world, scene.view);
  EXPECT_FALSE(keeps(scene.culler, scene.crate));
  EXPECT_EQ(std::vector(scene.culler.appeared().begin(), scene.culler.appeared().end()),
            std::vector{scene.wall});
  EXPECT_EQ(std::vector(scene.culler.disappeared().begin(), scene.culler.disappeared().end()),
            std::vector{scene.crate});
}

// Many boxes all around, none before another: what is kept is what is in the view, up to the width of a box.
TEST(World, WhatIsOutsideTheViewIsLeftOut) {
  Story story(allShapes());
  std::vector<Instance> ring;
  for (int i = 0; i < 720; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 720.0;
    ring.push_back(
        {.mesh = story.meshes[0],
         .world_from_mesh = boxAt({100.0 * std::sin(angle), 0, 100.0 * std::cos(angle)}, {0.1, 0.1, 0.1}),
         .moves = i % 5 == 0});
  }
  std::vector<InstanceId> ids;
  story.world.add(ring, ids);
  ASSERT_EQ(ids.size(), 720u);
  WorldCuller culler, frustum({.occlusion = false});
  for (int frame = 0; frame < 180; ++frame) {
    const double angle = 2.0 * 3.14159265358979 * frame / 90.0;
    View view = viewFrom({0, 0.05, 0}, {std::sin(angle), 0, std::cos(angle)});
    view.aspect = 1.0;
    view.tan_half_fovy = 1.0;
    culler.cull(story.world, view);
    frustum.cull(story.world, view);
    // A quarter of the ring, and boxes at its ends.
    EXPECT_GE(culler.visible().size(), 179u);
    EXPECT_LE(culler.visible().size(), 184u);
    EXPECT_TRUE(std::ranges::equal(culler.visible(), frustum.visible()));
    if (frame % 10 == 9 && frame < 90) {  // half of them move, and settle again
      for (std::size_t i = 0; i < ids.size(); i += 2) {
        Mat4 m = ring[i].world_from_mesh;
        m(1, 3) += frame % 20 == 9 ? 0.5 : 0.0;
        story.world.setTransform(ids[i], m);
      }
    }
    story.world.tidy();
  }
}

TEST(World, AWorldThatIsRebuiltIsAsOneThatWasAddedAsAList) {
  Story story(allShapes());
  World listed;
  addShape(listed, boxShape());
  World empty;
  empty.rebuild();
  Chance chance(9);
  std::vector<Instance> instances;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    instances.push_back({.mesh = story.meshes[0], .world_from_mesh = chance.placement(200.0, 6.0)});
    story.world.add(instances.back());
  }
  std::vector<InstanceId> ids;
  listed.add(instances, ids);
  const View view = viewFrom({0, 1.5, 0}, {0, 0, -1});
  const auto testedIn = [&](const World& world) {
    // The first view of a culler depends on nothing that an earlier one hid.
    WorldCuller culler;
    culler.cull(world, view);
    return std::tuple(culler.stats().nodes_tested, culler.stats().boxes_tested, culler.visible().size());
  };
  EXPECT_NE(testedIn(story.world), testedIn(listed));
  story.world.rebuild();
  EXPECT_EQ(testedIn(story.world), testedIn(listed));
}

TEST(World, WhatCannotBePlacedIsAlwaysKept) {
  Story story(allShapes());
  World& world = story.world;
  Mat4 not_finite = boxAt({0, 0, 50}, {1, 1, 1});
  not_finite(1, 3) = std::numeric_limits<double>::quiet_NaN();
  Mat4 projective = boxAt({0, 0, 50}, {1, 1, 1});
  projective(3, 3) = 2.0;
  const std::array<float, 9> bad{0, 0, 0, 1, 0, std::numeric_limits<float>::infinity(), 0, 1, 0};
  const MeshId endless = world.addMesh(*makeMesh({.positions = bad.data(), .vertex_count = 3}));
  const std::vector<InstanceId> odd{
      world.add({.mesh = story.meshes[0], .world_from_mesh = not_finite}),
      world.add({.mesh = story.meshes[0], .world_from_mesh = projective}),
      world.add({.mesh = endless}),
      world.add({.mesh = world.addMesh(*makeMesh({}))}),
      world.add({.mesh = MeshId(1000u)}),
      world.add({.mesh = story.meshes[0], .displacement = std::numeric_limits<double>::quiet_NaN()}),
  };
  const InstanceId behind =
      world.add({.mesh = story.meshes[0], .world_from_mesh = boxAt({0, 0, 50}, {1, 1, 1})});
  WorldCuller culler;
  culler.cull(world, viewFrom({0, 0, 0}, {0, 0, -1}));
  EXPECT_EQ(std::vector(culler.visible().begin(), culler.visible().end()), odd);
  EXPECT_EQ(culler.stats().unplaced, odd.size());
  for (const InstanceId id : odd) {
    world.setShown(id, false);
  }
  culler.cull(world, viewFrom({0, 0, 0}, {0, 0, -1}));
  EXPECT_TRUE(culler.visible().empty());
  EXPECT_EQ(culler.stats().unplaced, 0u);
  EXPECT_EQ(culler.disappeared().size(), odd.size());
  View broken = viewFrom({0, 0, 0}, {0, 0, -1});
  broken.aspect = -1.0;
  culler.cull(world, broken);
  EXPECT_NE(culler.stats().view_fault, nullptr);
  EXPECT_EQ(std::vector(culler.visible().begin(), culler.visible().end()), std::vector{behind});
  world.setTransform(odd[0], boxAt({0, 0, -10}, {1, 1, 1}));
  world.setShown(odd[0], true);
  culler.cull(world, viewFrom({0, 0, 0}, {0, 0, -1}));
  EXPECT_EQ(std::vector(culler.visible().begin(), culler.visible().end()), std::vector{odd[0]});
}

// Matrices that flatten, that leave nothing, and of the largest and smallest numbers: whatever becomes of
// them, exact visibility finds nothing that was left out wrongly.
TEST(World, MatricesWithoutAnInverseHideNothingThatIsSeen) {
  for (const double depth : {0.0, 1e-30, 1e-300}) {
    WallAndCrate scene;
    scene.story.move(scene.wall, boxAt({-8, 0, -11}, {16, 8, depth}));
    scene.showsCrate();
    EXPECT_EQ(judge(scene.story, scene.view, scene.culler).wrong, "") << depth;
    EXPECT_TRUE(keeps(scene.culler, scene.wall));
  }
  for (const Vec3d& size : {Vec3d(0, 0, 0), Vec3d(1e38, 1e38, 1), Vec3d(1e300, 1, 1), Vec3d(16, 8e-7, 1),
                            Vec3d(1e-320, 1e-320, 1e-320)}) {
    WallAndCrate scene;
    scene.story.world.setTransform(scene.wall, boxAt({-8, 0, -11}, size));
    for (int frame = 0; frame < 3; ++frame) {
      scene.culler.cull(scene.story.world, scene.view);
      scene.story.world.tidy();
    }
    // None of these covers the crate.
    EXPECT_TRUE(size.x > 1e30 || keeps(scene.culler, scene.crate));
    // What hid nothing is drawn again after some frames.
    scene.story.world.setTransform(scene.wall, boxAt({-8, 0, -11}, {16, 8, 1}));
    for (int frame = 0; frame < 40; ++frame) {
      scene.culler.cull(scene.story.world, scene.view);
    }
    EXPECT_FALSE(keeps(scene.culler, scene.crate));
  }
}

TEST(World, CallsWithIdsThatAreNotThereHaveNoEffect) {
  Story story(allShapes());
  World& world = story.world;
  const InstanceId id = story.add(0, Mat4());
  for (const InstanceId nothing : {InstanceId(), InstanceId(7u)}) {
    world.remove(nothing);
    world.setTransform(nothing, Mat4());
    world.setShown(nothing, false);
    world.setGroups(nothing, 0);
    EXPECT_FALSE(world.has(nothing));
    EXPECT_FALSE(world.boundsOf(nothing).wellFormed());
    EXPECT_FALSE(world.meshOf(nothing).valid());
  }
  world.removeJoin(JoinId());
  world.removeJoin(JoinId(3u));
  EXPECT_EQ(world.tombstones(SetsId(3u)), 0u);
  world.removeMesh(MeshId());
  EXPECT_TRUE(world.has(id));
  world.removeMesh(story.meshes[0]);
  EXPECT_FALSE(world.has(id));
  EXPECT_EQ(world.instances(), 0u);
  world.removeMesh(story.meshes[0]);
}

TEST(World, MeshesAreReadAsTheyLieInMemory) {
  struct Vertex {
    char color[3];
    float at[3];
    float normal[3];
  };
  const Shape box = boxShape();
  std::vector<Vertex> vertices;
  std::vector<std::uint16_t> indices;
  for (std::size_t i = 0; i < box.corners.size(); ++i) {
    const Vec3f& p = box.corners[i];
    vertices.push_back({{}, {p.x, p.y, p.z}, {}});
    // Clockwise.
    indices.push_back(static_cast<std::uint16_t>(i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1));
  }
  const MeshView view{.positions = vertices[0].at,
                      .position_stride = sizeof(Vertex),
                      .vertex_count = static_cast<std::uint32_t>(vertices.size()),
                      .indices = indices.data(),
                      .index_bytes = 2,
                      .index_count = indices.size(),
                      .clockwise = true};
  const WorldMesh strided = *makeMesh(view);
  const WorldMesh plain = *makeMesh(
      {.positions = box.corners.data(), .vertex_count = static_cast<std::uint32_t>(box.corners.size())});
  EXPECT_EQ(strided.bounds, plain.bounds);
  EXPECT_EQ(strided.triangles, 12u);
  EXPECT_EQ(strided.surfaces.vertices.size(), 8u);
  ASSERT_EQ(strided.surfaces.triangles.size(), plain.surfaces.triangles.size());
  EXPECT_TRUE(std::ranges::equal(strided.surfaces.triangles, plain.surfaces.triangles));
  const auto errorOf = [&](auto change) {
    MeshView wrong = view;
    change(wrong);
    const Result<WorldMesh> made = makeMesh(wrong);
    return made ? std::string() : made.error().message;
  };
  EXPECT_NE(errorOf([](MeshView& m) { m.vertex_count = 5; }), "");
  EXPECT_NE(errorOf([](MeshView& m) { m.index_count = 35; }), "");
  EXPECT_NE(errorOf([](MeshView& m) { m.index_bytes = 3; }), "");
  EXPECT_NE(errorOf([](MeshView& m) { m.position_stride = 8; }), "");
  EXPECT_NE(errorOf([](MeshView& m) { m.positions = nullptr; }), "");
  EXPECT_NE(errorOf([](MeshView& m) { m.indices = nullptr; }), "");
  EXPECT_EQ(errorOf([](MeshView& m) { m.index_count = 0; }), "");
}

TEST(World, BoxesOfWhatIsNoInstanceAreClassified) {
  WallAndCrate scene;
  EXPECT_FALSE(scene.showsCrate());
  Box behind, before;
  behind.extend(Vec3f{2, 0, -30});
  behind.extend(Vec3f{3, 1, -29});
  before.extend(Vec3f{2, 0, -6});
  before.extend(Vec3f{3, 1, -5});
  EXPECT_EQ(scene.culler.classify(behind), Visibility::kHidden);
  EXPECT_EQ(scene.culler.classify(before), Visibility::kVisible);
}

// A culler that has culled nothing yet knows no answer.
TEST(World, BoxesMayBeSeenUntilSomethingWasCulled) {
  WallAndCrate scene;
  const Box crate = scene.story.world.boundsOf(scene.crate);
  EXPECT_NE(scene.culler.classify(crate), Visibility::kHidden);
  EXPECT_FALSE(scene.showsCrate());
  EXPECT_EQ(scene.culler.classify(crate), Visibility::kHidden);
  scene.culler.reset();
  EXPECT_NE(scene.culler.classify(crate), Visibility::kHidden);
  // Nothing is seen in no view at all.
  scene.culler.cull(scene.story.world, std::span<const View>());
  EXPECT_EQ(scene.culler.classify(crate), Visibility::kHidden);
}

}  // namespace
}  // namespace sightline
