// Frames of a changing world: they allocate nothing once storage has grown, and several threads may cull.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <thread>
#include <vector>

#include "sightline/world/shadow_casters.h"
#include "sightline/world/views_ahead.h"
#include "sightline/world/visible_history.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "sightline/world/world_sight.h"
#include "tests/support/count_allocations.h"
#include "tests/world/world_story.h"

namespace sightline::test {
// How often the C library was asked for memory. Null where that is not counted: see count_malloc.cpp.
[[gnu::weak]] std::size_t callsOfMalloc();
}  // namespace sightline::test

namespace sightline {
namespace {

using namespace world_story;

View viewAt(int frame) {
  View view;
  view.eye = {0.25 * frame, 1.5, 0};
  setOrientation(view, {std::sin(0.1 * frame), 0.0, std::cos(0.1 * frame)}, {0, 1, 0});
  return view;
}

struct Crowd {
  Story story{{boxShape(), panelShape(false), groundShape()}};
  std::vector<InstanceId> ids;

  explicit Crowd(std::uint32_t count) {
    Chance chance(7);
    for (std::uint32_t i = 0; i < count; ++i) {
      ids.push_back(story.add(i % 3, chance.placement(60.0, 6.0)));
    }
    story.world.addJoin(makeJoin(story.world.joinInput(std::span(ids).first(count / 4))));
  }
  // The same changes in each round of 40 frames, but for the first one, which takes them out of the join.
  void change(int frame) {
    Chance chance(static_cast<std::uint32_t>(frame % 40));
    for (int i = 0; i < 30; ++i) {
      story.world.setTransform(ids[chance.below(static_cast<std::uint32_t>(ids.size()))],
                               chance.placement(60.0, 6.0));
    }
    std::array<Mat4, 20> places;
    for (Mat4& place : places) {
      place = chance.placement(60.0, 6.0);
    }
    const std::size_t first = chance.below(static_cast<std::uint32_t>(ids.size() - places.size()));
    story.world.setTransforms(std::span(ids).subspan(first, places.size()), places);
    for (int i = 0; i < 5; ++i) {
      const InstanceId id = ids[chance.below(static_cast<std::uint32_t>(ids.size()))];
      story.world.setShown(id, i % 2 == 0);
    }
    InstanceId& renewed = ids[static_cast<std::size_t>(frame % 40)];
    story.world.remove(renewed);
    renewed = story.world.add({.mesh = story.meshes[0], .world_from_mesh = chance.placement(60.0, 6.0)});
    story.world.tidy();
  }
};

View sunAt(int frame) {
  View light;
  light.orthographic = true;
  light.ortho_height = 80.0;
  light.aspect = 1.0;
  light.eye = {0.25 * frame, 80.0, 0.0};
  setOrientation(light, {0.3, -1.0, 0.2}, {0, 1, 0});
  return light;
}

TEST(WorldFrames, AllocateNothingAfterAFew) {
  Crowd crowd(4000);  // so many that their hierarchies are built anew in slices
  WorldCuller culler, ahead;
  ShadowCasters sun;
  WorldSight sight;
  VisibleHistory history;
  const auto round = [&] {
    const std::size_t before = allocations;
    for (int frame = 0; frame < 40; ++frame) {
      crowd.change(frame);
      culler.cull(crowd.story.world, viewAt(frame));
      sun.cull(crowd.story.world, sunAt(frame), culler);
      history.update(crowd.story.world, culler, 1.0 / 60.0);
      std::array<View, 3> views;
      viewsAhead(viewAt(frame), {.velocity = {15.0, 0.0, 0.0}}, 0.5, views);
      ahead.cull(crowd.story.world, views);
      for (std::size_t i = 0; i < 5; ++i) {
        const InstanceId target = crowd.ids[static_cast<std::size_t>(frame) * 5 + i];
        sight.look(crowd.story.world, viewAt(frame).eye, crowd.story.world.boundsOf(target), {&target, 1});
      }
    }
    return allocations - before;
  };
  EXPECT_GT(round(), 0u);
  for (int i = 0; i < 6; ++i) {  // until both trees that take turns have been built
    round();
  }
  EXPECT_EQ(round(), 0u);
}

TEST(WorldFrames, AReservedWorldGrowsWithoutCopyingWhatIsThere) {
  const auto allocationsFor = [](bool reserves) {
    World world;
    const MeshId box = world.addMesh(boxMesh({{0, 0, 0}, {1, 1, 1}}));
    Chance chance(3);
    if (reserves) {
      world.reserve(20000);
    }
    const std::size_t before = allocations;
    for (int i = 0; i < 20000; ++i) {
      world.add({.mesh = box, .world_from_mesh = chance.placement(60.0, 6.0)});
    }
    return allocations - before;
  };
  // What remains is lists of numbers: of the mesh's instances, and of nodes that have changed.
  EXPECT_LT(2 * allocationsFor(true), allocationsFor(false));
}

// An engine that replaces operator new sees all memory of a world. Where a sanitizer has taken the place of
// the C library's functions, they cannot be replaced once more and counted, so there is nothing to compare.
TEST(WorldFrames, TakeAllMemoryFromOperatorNew) {
  if (test::callsOfMalloc == nullptr) {  // with sanitizers, and where the C library is not glibc
    GTEST_SKIP() << "the C library's functions cannot be counted here";
  }
  const std::size_t c_before = test::callsOfMalloc(), new_before = allocations;
  {
    Crowd crowd(1500);
    WorldCuller culler;
    ShadowCasters sun;
    WorldSight sight;
    VisibleHistory history;
    std::vector<Instance> more(2000, {.mesh = crowd.story.meshes[0], .world_from_mesh = Mat4()});
    std::vector<InstanceId> added;
    crowd.story.world.add(more, added);
    for (int frame = 0; frame < 40; ++frame) {
      crowd.change(frame);
      culler.cull(crowd.story.world, viewAt(frame));
      sun.cull(crowd.story.world, sunAt(frame), culler);
      history.update(crowd.story.world, culler, 1.0 / 60.0);
      sight.look(crowd.story.world, viewAt(frame).eye, crowd.story.world.boundsOf(added[0]));
    }
    crowd.story.world.rebuild();
  }
  EXPECT_GT(allocations - new_before, 1000u);
  EXPECT_EQ(test::callsOfMalloc() - c_before, allocations - new_before);
}

TEST(WorldFrames, ThreadsThatCullOneWorldGiveTheSameAnswers) {
  Crowd crowd(900);
  constexpr std::size_t kViews = 4;
  std::array<WorldCuller, kViews> alone, together;
  std::array<ShadowCasters, kViews> suns_alone, suns_together;
  std::array<WorldSight, kViews> sights;
  for (int frame = 0; frame < 20; ++frame) {
    crowd.change(frame);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kViews; ++i) {
      const View view = viewAt(frame + 10 * static_cast<int>(i));
      alone[i].cull(crowd.story.world, view);
      threads.emplace_back([&, i, view] { together[i].cull(crowd.story.world, view); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    threads.clear();
    // Lights and lines of sight, too: all of them read the first culler's answers.
    const World& world = crowd.story.world;
    std::array<Visibility, kViews> seen{};
    const Box target = world.boundsOf(crowd.ids[static_cast<std::size_t>(frame)]);
    for (std::size_t i = 0; i < kViews; ++i) {
      suns_alone[i].cull(world, sunAt(frame + static_cast<int>(i)), alone[0]);
      threads.emplace_back([&, i] {
        suns_together[i].cull(world, sunAt(frame + static_cast<int>(i)), alone[0]);
        seen[i] = sights[i].look(world, {0, 1.5, 0}, target);
      });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    for (std::size_t i = 0; i < kViews; ++i) {
      EXPECT_TRUE(std::ranges::equal(suns_alone[i].casters(), suns_together[i].casters())) << frame;
      EXPECT_EQ(seen[i], seen[0]);
    }
    for (std::size_t i = 0; i < kViews; ++i) {
      EXPECT_TRUE(std::ranges::equal(alone[i].visible(), together[i].visible())) << frame;
      EXPECT_FALSE(alone[i].visible().empty());
    }
  }
}

}  // namespace
}  // namespace sightline
