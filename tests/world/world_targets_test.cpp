// Views of a World draw what hides something that the last frame hid, and no more.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/world/hidden_boxes.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

std::vector<InstanceId> visibleOf(const WorldCuller& culler) {
  return {culler.visible().begin(), culler.visible().end()};
}

// A wall with crates behind it, and posts before it, which hide no crate that the wall does not hide.
struct PostsAndWall {
  Story story{allShapes()};
  InstanceId wall = story.add(0, boxAt({-16, -8, -33}, {32, 24, 1}));
  std::vector<InstanceId> posts, crates;

  PostsAndWall() {
    for (int i = 0; i < 24; ++i) {
      posts.push_back(story.add(0, boxAt({i - 12.0, -2, -15.0 - 0.25 * (i % 3)}, {0.5, 3, 0.5})));
      crates.push_back(story.add(0, boxAt({0.5 * i - 6.0, 0, -44.0 - i % 5}, {0.25, 0.25, 0.25})));
    }
  }
  static View view(int frame) { return viewFrom({0.015625 * frame, 1.5, 0}, {0, 0, -1}); }
};

TEST(WorldTargets, WhatHidesNothingElseIsNotDrawnAndTheSameIsKept) {
  PostsAndWall scene;
  WorldCuller culler;
  std::uint64_t edges = 0, edges_anew = 0;
  for (int frame = 0; frame < 60; ++frame) {
    WorldCuller anew;  // which draws all that is in the view
    anew.cull(scene.story.world, PostsAndWall::view(frame));
    culler.cull(scene.story.world, PostsAndWall::view(frame));
    EXPECT_EQ(visibleOf(culler), visibleOf(anew)) << frame;
    EXPECT_EQ(culler.visible().size(), 1 + scene.posts.size()) << frame;
    if (frame >= 20) {
      edges += culler.stats().edges;
      edges_anew += anew.stats().edges;
    }
  }
  EXPECT_GT(edges, 0u);
  EXPECT_LT(8 * edges, edges_anew);
}

TEST(WorldTargets, WhatMovesBehindAnotherThingIsHiddenByThatInTheEnd) {
  // The second wall is above the posts, and has hidden nothing so far.
  PostsAndWall scene;
  const InstanceId other = scene.story.add(0, boxAt({-6, 4, -11}, {5, 3, 0.5}));
  const InstanceId crate = scene.story.add(0, boxAt({8, 0, -50}, {0.5, 0.5, 0.5}));
  WorldCuller culler;
  int frame = 0;
  for (; frame < 30; ++frame) {
    culler.cull(scene.story.world, PostsAndWall::view(frame));
  }
  EXPECT_TRUE(keeps(culler, other));
  EXPECT_FALSE(keeps(culler, crate));
  scene.story.move(crate, boxAt({-4, 6, -13}, {0.5, 0.5, 0.5}));
  int frames = 0;
  do {
    culler.cull(scene.story.world, PostsAndWall::view(frame++));
  } while (keeps(culler, crate) && ++frames < 60);
  // The wall rests for at most 15 + 7 frames, as one that has hidden nothing.
  EXPECT_LT(frames, 40);
  // Where the wall goes, the crate is seen at once.
  scene.story.remove(other);
  culler.cull(scene.story.world, PostsAndWall::view(frame++));
  EXPECT_TRUE(keeps(culler, crate));
}

TEST(WorldTargets, SeveralJoinsRememberWhatIsOfUseEach) {
  // Two walls of panels, each a join, before each a row of posts in the same join.
  Story story(allShapes());
  std::vector<std::vector<InstanceId>> members(2);
  std::vector<InstanceId> crates;
  for (int i = 0; i < 32; ++i) {
    const double side = i % 2 == 0 ? -16.0 : 0.0;
    std::vector<InstanceId>& join = members[static_cast<std::size_t>(i % 2)];
    join.push_back(story.add(0, boxAt({side + i / 2, -8, -33}, {1, 24, 1})));
    join.push_back(story.add(0, boxAt({side + i / 2 + 0.25, -2, -16}, {0.5, 3, 0.5})));
    // None is behind the gap between the joins, which may be seen through as far as either knows.
    const double x = 0.125 * i + (i % 2 == 0 ? -7.0 : 3.0);
    crates.push_back(story.add(0, boxAt({x, 0, -44.0 - i % 5}, {0.25, 0.25, 0.25})));
  }
  for (const std::vector<InstanceId>& join : members) {
    story.world.addJoin(makeJoin(story.world.joinInput(join)));
  }
  WorldCuller culler;
  std::uint64_t edges = 0, edges_anew = 0;
  for (int frame = 0; frame < 60; ++frame) {
    WorldCuller anew;
    anew.cull(story.world, PostsAndWall::view(frame));
    culler.cull(story.world, PostsAndWall::view(frame));
    for (const InstanceId crate : crates) {
      EXPECT_FALSE(keeps(culler, crate)) << frame;
    }
    if (frame >= 20) {
      edges += culler.stats().edges;
      edges_anew += anew.stats().edges;
    }
  }
  EXPECT_GT(edges, 0u);
  EXPECT_LT(2 * edges, edges_anew);
}

// What is drawn for things that come into view hides nothing, or is no more than what is drawn already.
TEST(WorldTargets, BoxesCanBeClassifiedAfterEachFrame) {
  Story story(allShapes());
  story.add(0, boxAt({2, -8, -33}, {20, 24, 1}));  // hides the crates
  story.add(0, boxAt({-3, -3, -20}, {4, 5, 1}));   // hides nothing
  for (int i = 0; i < 30; ++i) {
    story.add(0, boxAt({6 + 0.25 * i, 0, -44}, {0.25, 0.25, 0.25}));
  }
  WorldCuller culler;
  std::vector<InstanceId> news;
  for (int frame = 0; frame < 60; ++frame) {
    for (const InstanceId id : news) {
      story.remove(id);
    }
    news.clear();
    for (int i = 0; i < 20; ++i) {
      news.push_back(story.add(0, boxAt({0.25 * i - 30, 2, -44}, {0.125, 0.125, 0.125})));
    }
    culler.cull(story.world, viewFrom({0.001953125 * frame, 1.5, 0}, {0, 0, -1}));
    EXPECT_EQ(culler.classify({{10, 0, -50}, {11, 1, -48}}), Visibility::kHidden) << frame;
  }
}

// Boxes of a world of instances of one unit cube.
class HiddenBoxesTest : public testing::Test {
 protected:
  HiddenBoxesTest() {
    data_.meshes.push_back({.there = true, .extent = world::MeshExtent({{0, 0, 0}, {1, 1, 1}})});
  }
  std::uint32_t add(double x) {
    Mat4 m;
    m(0, 3) = x;
    const std::uint32_t id = data_.addInstance({.mesh = MeshId(0u), .world_from_mesh = m});
    data_.place(id);
    return id;
  }
  void remove(std::uint32_t id) {
    data_.unplace(id);
    data_.instances[id].there = false;
    data_.free_instances.push_back(id);
  }
  // The middles of the boxes along x, ascending.
  std::vector<double> middles(std::size_t most = 128, std::size_t turn = 0) const {
    std::vector<Box> boxes;
    hidden_.append(
        data_, most, turn, [this](std::uint32_t id) { return id != left_out_; }, boxes);
    std::vector<double> at;
    for (const Box& box : boxes) {
      at.push_back(std::round(2.0 * center(box).x) / 2.0);
    }
    std::ranges::sort(at);
    return at;
  }

  world::WorldData data_;
  world::HiddenBoxes hidden_;
  std::uint32_t left_out_ = world::InstanceData::kNone;
};

TEST_F(HiddenBoxesTest, AreWhereTheInstancesAreNow) {
  const std::uint32_t one = add(0.0), two = add(10.0), three = add(20.0);
  hidden_.begin(data_);
  for (const std::uint32_t id : {one, two, three}) {
    hidden_.addInstance(id);
  }
  hidden_.addNode({{4, 0, 0}, {8, 1, 1}});
  EXPECT_EQ(middles(), (std::vector{0.5, 6.0, 10.5, 20.5}));
  data_.world_from_mesh[two](0, 3) = 50.0;
  data_.moved(two);
  EXPECT_EQ(middles(), (std::vector{0.5, 6.0, 20.5, 50.5}));
  left_out_ = three;
  EXPECT_EQ(middles(), (std::vector{0.5, 6.0, 50.5}));
  hidden_.begin(data_);
  EXPECT_TRUE(middles().empty());
}

TEST_F(HiddenBoxesTest, AreNotThoseOfAnInstanceThatGotTheIdOfAnother) {
  const std::uint32_t one = add(0.0), two = add(10.0);
  hidden_.begin(data_);
  hidden_.addInstance(one);
  hidden_.addInstance(two);
  remove(one);
  EXPECT_EQ(middles(), (std::vector{10.5}));
  ASSERT_EQ(add(70.0), one);
  EXPECT_EQ(middles(), (std::vector{10.5}));
  hidden_.begin(data_);
  hidden_.addInstance(one);
  EXPECT_EQ(middles(), (std::vector{70.5}));
}

TEST_F(HiddenBoxesTest, AreOthersInEachTurnWhereThereAreMany) {
  std::vector<std::uint32_t> ids;
  for (int i = 0; i < 100; ++i) {
    ids.push_back(add(10.0 * i));
  }
  hidden_.begin(data_);
  for (const std::uint32_t id : ids) {
    hidden_.addInstance(id);
  }
  EXPECT_EQ(middles(1000).size(), 100u);
  const std::vector<double> first = middles(10, 0), second = middles(10, 1);
  EXPECT_EQ(first.size(), 10u);
  EXPECT_NE(first, second);
}

TEST_F(HiddenBoxesTest, OfNodesStayInPlaceWhenTheOriginMoves) {
  hidden_.begin(data_);
  hidden_.addNode({{4, 0, 0}, {8, 1, 1}});
  data_.origin = {100.0, 0.0, 0.0};
  EXPECT_EQ(middles(), (std::vector{-94.0}));
}

}  // namespace
}  // namespace sightline
