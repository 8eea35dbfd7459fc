// Changes of every kind in every frame: what is culled is proved hidden.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/world/world_sight.h"
#include "tests/support/rounds.h"
#include "tests/world/hard_story.h"

namespace sightline {
namespace {

using namespace world_story;

TEST(WorldFuzz, WhateverIsSeenIsKeptHoweverTheWorldIsChanged) {
  std::size_t culled = 0;
  const std::array<Vec3d, 4> bases{Vec3d(), Vec3d(20000, 0, -8000), Vec3d(0x1p30, 0x1p20, -0x1p30),
                                   Vec3d(0x1p44, 0, 0x1p40)};
  for (std::uint32_t seed = 0; seed < test::rounds(12u); ++seed) {
    HardStory story(seed, bases[seed % bases.size()]);
    story.world.setOrigin(seed % 3 == 0 ? Vec3d() : story.base);
    WorldCuller every, first({.raster = {.width = 128, .height = 72}, .groups = 1}), sometimes, both;
    for (std::uint32_t frame = 0; frame < 60; ++frame) {
      View view = story.next();
      view.orthographic = seed % 5 % 2 == 1;
      view.ortho_height = 12.0;
      View other = view;
      other.eye = view.eye + view.right * 0.0625;
      every.cull(story.world, story.inWorld(view));
      first.cull(story.world, story.inWorld(view));
      both.cull(story.world, std::array{story.inWorld(view), story.inWorld(other)});
      if (frame % 6 == 0) {
        sometimes.cull(story.world, story.inWorld(view));
      }
      if (frame % 3 == 0) {
        const Judged judged = frame % 6 == 0 ? story.judged(view, {&every, &both, &sometimes}, ~0u)
                                             : story.judged(view, {&every, &both}, ~0u);
        EXPECT_EQ(judged.wrong, "") << seed << " " << frame;
        culled += judged.culled;
        EXPECT_EQ(story.judged(view, first, 1).wrong, "") << seed << " " << frame;
        EXPECT_EQ(story.judged(other, both, ~0u).wrong, "") << seed << " " << frame;
      }
    }
    EXPECT_EQ(story.world.instances(), story.pieces.size());
  }
  EXPECT_GT(culled, test::rounds(500u));
}

// What no line of sight from a point meets is in no picture from there either.
TEST(WorldFuzz, LinesOfSightHideNothingThatIsSeen) {
  std::size_t hidden = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(10u); ++seed) {
    HardStory story(seed, seed % 2 == 0 ? Vec3d() : Vec3d(20000, 0, -8000));
    story.world.setOrigin(story.base);
    // Nearer things are in the picture and hide nothing for the line of sight.
    WorldSight sight({.near_distance = 0.25, .groups = 2});
    for (std::uint32_t frame = 0; frame < 40; ++frame) {
      const View view = story.next();
      const ToldScene drawn = story.drawn(2);
      std::vector<InstanceId> ids;
      const Scene scene = drawn.scene(ids);
      const ExactVisibility exact(scene.view());
      std::vector<ObjectId> said_hidden;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        const Visibility said = sight.look(story.world, view.eye + story.base, story.world.boundsOf(ids[i]),
                                           std::span(ids).subspan(i, 1));
        if (said == Visibility::kHidden) {
          said_hidden.emplace_back(i);
        }
      }
      hidden += said_hidden.size();
      for (const Decision& decision : exact.decide(view, said_hidden, 20'000)) {
        EXPECT_EQ(decision.verdict, Verdict::kHidden) << seed << " " << frame;
      }
    }
  }
  EXPECT_GT(hidden, test::rounds(200u));
}

TEST(WorldFuzz, AnInstanceThatIsReplacedKeepsItsIdAndIsAnother) {
  Story story(allShapes());
  const InstanceId wall = story.add(0, Mat4()), other = story.add(0, Mat4());
  WorldCuller culler;
  const View view = viewFrom({0.5, 0.5, 4}, {0, 0, -1});
  culler.cull(story.world, view);
  story.world.replace(wall, {.mesh = story.meshes[1], .user_data = 7});
  story.world.replace(InstanceId(500u), {.mesh = story.meshes[1]});
  EXPECT_EQ(story.world.instances(), 2u);
  EXPECT_EQ(story.world.meshOf(wall), story.meshes[1]);
  EXPECT_EQ(story.world.userDataOf(wall), 7u);
  EXPECT_EQ(story.world.meshOf(other), story.meshes[0]);
  EXPECT_FALSE(culler.isVisible(InstanceId(500u)));
  EXPECT_FALSE(culler.isVisible(InstanceId()));
  culler.cull(story.world, view);
  EXPECT_EQ(std::ranges::count(culler.appeared(), wall), 1);
  EXPECT_EQ(std::ranges::count(culler.disappeared(), wall), 1);
}

}  // namespace
}  // namespace sightline
