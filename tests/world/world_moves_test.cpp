// Instances that move, one at a time and many at once, and the boxes they have.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "tests/support/cut_work.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// As a GPU computes it, in single precision; sums from the front or from the back.
Vec3f transformedInFloats(const Mat4& m, const Vec3f& p, bool from_back) {
  Vec3f at;
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<float, 4> terms{static_cast<float>(m(axis, 0)) * p.x,
                                     static_cast<float>(m(axis, 1)) * p.y,
                                     static_cast<float>(m(axis, 2)) * p.z, static_cast<float>(m(axis, 3))};
    float sum = from_back ? terms[3] : terms[0];
    for (std::size_t i = 1; i < 4; ++i) {
      sum += terms[from_back ? 3 - i : i];
    }
    at[axis] = sum;
  }
  return at;
}

TEST(WorldMoves, ABoxHoldsWhatSinglePrecisionMakesOfTheMesh) {
  std::mt19937 engine(5);
  auto number = test::numbersFrom<double>(engine);
  World world;
  for (int round = 0; round < 400; ++round) {
    // From flat meshes to large ones, near their origin and far from it.
    const double size = std::ldexp(1.0, round % 20 - 10), away = round % 3 == 0 ? 0.0 : 1000.0 * size;
    std::vector<Vec3f> corners;
    for (int i = 0; i < 30; ++i) {
      corners.emplace_back(Vec3d(number(-size, size) + away, number(-size, size) - away,
                                 round % 4 == 0 ? away : number(-size, size)));
    }
    const MeshId mesh = world.addMesh(*makeMesh({.positions = corners.data(), .vertex_count = 30}));
    Mat4 m;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) {
        m(row, column) = column < 3       ? number(-4.0, 4.0)
                         : round % 2 == 0 ? number(-9.0, 9.0)
                                          : number(-5e4, 5e4);
      }
    }
    const InstanceId id = world.add({.mesh = mesh, .moves = round % 2 == 0});
    world.setTransforms(std::array{id}, std::array{m});
    const Box box = world.boundsOf(id);
    for (const Vec3f& corner : corners) {
      for (const bool from_back : {false, true}) {
        const Vec3f at = transformedInFloats(m, corner, from_back);
        EXPECT_TRUE(contains(box, Box{at, at})) << round;
      }
      const Vec3f exact(transformPoint(m, Vec3d(corner)));
      EXPECT_TRUE(contains(box, Box{exact, exact})) << round;
    }
  }
}

// Instances of all sorts: settled, moving, hidden, in a join, removed, and with matrices that place nothing.
TEST(WorldMoves, ManyAtOnceAreAsManyOneByOne) {
  for (const std::uint32_t count : {40u, 900u}) {
    Chance chance(count);
    Story one(allShapes()), many(allShapes()), threads(allShapes());
    const std::array<Story*, 3> all{&one, &many, &threads};
    std::vector<InstanceId> ids;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Mat4 m = chance.placement(60.0, 6.0);
      for (Story* story : all) {
        const InstanceId id = story->add(i % 5, m, i % 11 != 0);
        if (story == &one) {
          ids.push_back(id);
        }
      }
    }
    for (Story* story : all) {
      story->world.addJoin(makeJoin(story->world.joinInput(std::span(ids).first(count / 4))));
      story->world.remove(ids[7]);
    }
    ids.push_back(InstanceId(100000u));
    std::array<WorldCuller, 3> cullers;
    for (int frame = 0; frame < 30; ++frame) {
      std::vector<InstanceId> moved;
      std::vector<Mat4> to;
      for (const InstanceId id : ids) {
        // In some frames all of them, in others a few.
        if (chance.below(frame % 3 == 0 ? 1 : 10) == 0) {
          moved.push_back(id);
          to.push_back(chance.placement(60.0, 6.0));
          if (chance.below(40) == 0) {
            to.back()(1, 2) = std::numeric_limits<double>::quiet_NaN();
          } else if (chance.below(40) == 0) {
            to.back()(0, 0) = std::numeric_limits<double>::infinity();
          } else if (chance.below(40) == 0) {
            to.back()(3, 3) = 2.0;
          } else if (chance.below(10) == 0 && one.world.has(id)) {
            to.back() = one.told.at(id.value).world_from_mesh;
          }
        }
      }
      for (std::size_t i = 0; i < moved.size(); ++i) {
        one.world.setTransform(moved[i], to[i]);
        if (one.told.contains(moved[i].value)) {
          one.told.at(moved[i].value).world_from_mesh = to[i];
        }
      }
      many.world.setTransforms(moved, to);
      threads.world.setTransforms(moved, to, onThreads(3));
      const View view = viewFrom({0.0, 1.5, 0.25 * frame}, {0.2, 0.0, frame % 2 == 0 ? 1.0 : -1.0});
      for (std::size_t i = 0; i < all.size(); ++i) {
        World& world = all[i]->world;
        EXPECT_EQ(world.boundsOf(ids[1]), one.world.boundsOf(ids[1]));
        for (const InstanceId id : moved) {
          ASSERT_EQ(world.boundsOf(id), one.world.boundsOf(id)) << frame;
        }
        // By the frustum alone, which asks the trees and not what is drawn in which order.
        WorldCuller by_frustum({.occlusion = false});
        by_frustum.cull(world, view);
        WorldCuller other({.occlusion = false});
        other.cull(one.world, view);
        ASSERT_TRUE(std::ranges::equal(by_frustum.visible(), other.visible())) << frame;
        cullers[i].cull(world, view);
        ASSERT_TRUE(std::ranges::equal(cullers[i].visible(), cullers[0].visible())) << frame;
        world.tidy(chance.below(2) == 0 ? 3 : 1000);
      }
    }
  }
}

// Whether a point is in a view's frustum, and not so near to its sides that rounding might matter.
bool isWithin(const View& view, const Vec3d& point) {
  const Vec3d at = point - view.eye;
  const double depth = dot(at, view.forward), height = 0.999 * depth * view.tan_half_fovy;
  return depth > 1.001 * view.z_near && depth < 0.999 * view.z_far && std::abs(dot(at, view.up)) < height &&
         std::abs(dot(at, view.right)) < height * view.aspect;
}

// So many instances that their hierarchies are built anew in slices, all the while they change.
TEST(WorldMoves, WhateverIsInTheViewIsKeptWhileTheHierarchyIsBuiltAnew) {
  std::size_t kept = 0, shown = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(3u); ++seed) {
    Chance chance(seed);
    Story story(allShapes());
    std::vector<InstanceId> ids;
    const auto add = [&] {
      ids.push_back(story.add(0, chance.placement(200.0, 6.0), chance.below(20) != 0));
    };
    for (int i = 0; i < 3000; ++i) {
      add();
    }
    WorldCuller culler({.occlusion = false});
    for (int frame = 0; frame < 300; ++frame) {
      for (int change = 0; change < 20; ++change) {
        const std::size_t which = chance.below(static_cast<std::uint32_t>(ids.size()));
        const std::uint32_t kind = chance.below(4);
        if (kind == 0) {
          add();
        } else if (kind == 1) {
          story.remove(ids[which]);
          ids[which] = ids.back();
          ids.pop_back();
        } else if (kind == 2) {
          story.show(ids[which], chance.below(3) != 0);
        } else {
          story.move(ids[which], chance.placement(200.0, 6.0));
        }
      }
      std::vector<InstanceId> moved;
      std::vector<Mat4> to;
      for (std::size_t i = static_cast<std::size_t>(frame % 7); i < ids.size() && frame % 2 == 0; i += 7) {
        moved.push_back(ids[i]);
        Told& told = story.told.at(ids[i].value);
        told.world_from_mesh(0, 3) += chance.eighths(-2.0, 2.0);
        to.push_back(told.world_from_mesh);
      }
      story.world.setTransforms(moved, to);
      if (frame % 90 == 60) {
        story.world.setOrigin({chance.eighths(-50.0, 50.0), 0.0, chance.eighths(-50.0, 50.0)});
      }
      story.world.tidy(frame % 100 < 50 ? 300 : 3000);
      const double heading = 0.1 * frame;
      const View view =
          viewFrom({chance.eighths(-50, 50), 1.5, 0}, {std::sin(heading), 0.0, std::cos(heading)});
      culler.cull(story.world, view);
      kept += culler.visible().size();
      for (const auto& [id, told] : story.told) {
        if (!told.shown) {
          ASSERT_FALSE(keeps(culler, InstanceId(id))) << seed << " " << frame;
          continue;
        }
        ++shown;
        for (const Vec3f& corner : story.shapes[0].corners) {
          if (isWithin(view, transformPoint(told.world_from_mesh, Vec3d(corner)))) {
            ASSERT_TRUE(keeps(culler, InstanceId(id))) << seed << " " << frame;
          }
        }
      }
    }
  }
  EXPECT_LT(2 * kept, shown);
}

// A new origin that takes many calls of tidy(), while instances come, go, move, and are too far away for one
// of the two origins: then all is as in a world in which it came at once.
TEST(WorldMoves, AnOriginThatComesInSlicesIsAsOneThatComesAtOnce) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    Chance chance(seed);
    Story sliced(allShapes()), at_once(allShapes());
    const std::array<Story*, 2> both{&sliced, &at_once};
    // In the last round, single precision overflows: some have a box from one origin alone.
    const Vec3d next = seed == 3 ? Vec3d(2e38, 0, -2e38) : Vec3d(4096, -16, 1 << 20);
    std::vector<InstanceId> ids;
    const auto placement = [&] {
      const Mat4 m = chance.placement(60.0, 6.0);
      return movedBy(m, next * (static_cast<double>(chance.below(3)) - 1.0));
    };
    const auto add = [&] {
      const Mat4 m = placement();
      const bool shown = chance.below(10) != 0;
      const std::size_t shape = ids.size() % 5;
      ids.push_back(sliced.add(shape, m, shown));
      at_once.add(shape, m, shown);
    };
    for (int i = 0; i < 3000; ++i) {
      add();
    }
    sliced.world.moveOrigin(next);
    int calls = 0;
    for (; sliced.world.origin() != next && calls < 2000; ++calls) {
      EXPECT_EQ(sliced.world.origin(), Vec3d());
      for (int change = 0; change < 5; ++change) {
        const std::size_t which = chance.below(static_cast<std::uint32_t>(ids.size()));
        const std::uint32_t kind = chance.below(4);
        const Mat4 m = placement();
        if (kind == 0) {
          add();
        } else if (kind == 1) {
          sliced.remove(ids[which]);
          at_once.remove(ids[which]);
          ids[which] = ids.back();
          ids.pop_back();
        } else {
          for (Story* story : both) {
            kind == 2 ? story->show(ids[which], calls % 2 == 0) : story->move(ids[which], m);
          }
        }
      }
      if (calls == 20) {  // a list, for which the hierarchy is built anew
        std::vector<Instance> list;
        for (int i = 0; i < 2000; ++i) {
          list.push_back({.mesh = sliced.meshes[0], .world_from_mesh = placement()});
        }
        for (Story* story : both) {
          std::vector<InstanceId> listed;
          story->world.add(list, listed);
          for (std::size_t i = 0; i < listed.size(); ++i) {
            story->told[listed[i].value] = {0, list[i].world_from_mesh, true};
          }
          if (story == &sliced) {
            ids.insert(ids.end(), listed.begin(), listed.end());
          }
        }
      }
      sliced.world.tidy(300);
      at_once.world.tidy(1000);
    }
    ASSERT_EQ(sliced.world.origin(), next);
    EXPECT_GT(calls, 60);
    at_once.world.setOrigin(next);
    const auto unplaced =
        std::ranges::count_if(ids, [&](InstanceId id) { return sliced.world.boundsOf(id).empty(); });
    EXPECT_EQ(unplaced > 500, seed == 3);
    for (const Vec3d& eye : {Vec3d(0, 1.5, 0), next}) {
      for (int turn = 0; turn < 8; ++turn) {
        const View view = viewFrom(eye, {std::sin(turn), 0.1, std::cos(turn)});
        WorldCuller one({.occlusion = false}), other({.occlusion = false});
        one.cull(sliced.world, view);
        other.cull(at_once.world, view);
        EXPECT_TRUE(std::ranges::equal(one.visible(), other.visible())) << seed << " " << turn;
      }
    }
    for (const InstanceId id : ids) {
      ASSERT_EQ(sliced.world.boundsOf(id), at_once.world.boundsOf(id));
    }
    // One that is given up has no effect, nor has one that is not finite.
    sliced.world.moveOrigin({1, 2, 3});
    sliced.world.tidy();
    sliced.world.setOrigin(next);
    sliced.world.moveOrigin({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    for (int i = 0; i < 200; ++i) {
      sliced.world.tidy();
    }
    EXPECT_EQ(sliced.world.origin(), next);
  }
}

// A crowd that takes more steps in each frame than tidy() has.
TEST(WorldMoves, ACrowdDoesNotKeepAnotherOriginFromComing) {
  World world;
  const MeshId box = world.addMesh(boxMesh({{0, 0, 0}, {1, 1, 1}}));
  Chance chance(2);
  std::vector<InstanceId> crowd;
  std::vector<Mat4> at;
  for (int i = 0; i < 2000; ++i) {
    at.push_back(chance.placement(60.0, 6.0));
    const InstanceId id = world.add({.mesh = box, .world_from_mesh = at.back(), .moves = i % 2 == 0});
    if (i % 2 == 0) {
      crowd.push_back(id);
    }
  }
  world.rebuild();
  const Vec3d origin(64, 0, 64);
  world.moveOrigin(origin);
  int calls = 0;
  for (; calls < 2000 && world.origin() != origin; ++calls) {
    for (std::size_t i = 0; i < crowd.size(); ++i) {
      at[2 * i](0, 3) += calls % 2 == 0 ? 0.125 : -0.125;
      world.setTransform(crowd[i], at[2 * i]);
    }
    world.tidy(200);
  }
  EXPECT_EQ(world.origin(), origin);
}

// Instances of a mesh without triangles have no box, and are in every answer until they go, one by one.
TEST(WorldMoves, ThoseWithoutABoxComeAndGoInAnyOrder) {
  World world;
  const MeshId empty = world.addMesh(*makeMesh(MeshView{})),
               box = world.addMesh(boxMesh({{0, 0, 0}, {1, 1, 1}}));
  WorldCuller culler({.occlusion = false});
  Chance chance(8);
  std::vector<InstanceId> there;  // ascending
  const auto sort = [&] { std::ranges::sort(there); };
  const auto expectAll = [&] {
    culler.cull(world, viewFrom({0, 0, 1000}, {0, 0, 1}));
    EXPECT_TRUE(std::ranges::equal(culler.visible(), there));
  };
  for (int round = 0; round < 60; ++round) {
    for (int i = 0; i < 8; ++i) {
      there.push_back(world.add({.mesh = empty}));
    }
    sort();
    expectAll();
    for (int i = 0; i < 6; ++i) {
      const std::size_t which = chance.below(static_cast<std::uint32_t>(there.size()));
      const InstanceId id = there[which];
      if (i % 3 == 0) {
        world.setTransform(id, chance.placement(60.0, 6.0));  // it has no box elsewhere either
        continue;
      }
      if (i % 3 == 1) {
        world.replace(id, {.mesh = box});
      } else {
        world.setShown(id, false);
      }
      there.erase(there.begin() + static_cast<std::ptrdiff_t>(which));
    }
    expectAll();
    if (round % 20 == 10) {
      world.setOrigin({static_cast<double>(round), 0, 0});
      expectAll();
    }
  }
  world.removeMesh(empty);
  there.clear();
  expectAll();
}

TEST(WorldMoves, InstancesWithoutAMatrixStay) {
  Story story(allShapes());
  std::vector<InstanceId> ids;
  for (int i = 0; i < 30; ++i) {
    ids.push_back(story.add(0, Mat4()));
  }
  Mat4 first, second;
  first(0, 3) = 5.0;
  second(0, 3) = -5.0;
  // Fewer matrices than instances: the others stay.
  story.world.setTransforms(ids, std::array{first, second});
  EXPECT_GT(story.world.boundsOf(ids[0]).min.x, 4.0f);
  EXPECT_LT(story.world.boundsOf(ids[1]).max.x, -3.0f);
  EXPECT_GT(story.world.boundsOf(ids[2]).min.x, -1.0f);
  story.world.setTransforms({}, {});
}

}  // namespace
}  // namespace sightline
