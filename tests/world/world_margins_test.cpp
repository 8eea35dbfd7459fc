// Where rounding might decide: matrices that flatten, boxes that stand almost where they were baked, and clip
// planes far from the origin.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/culling/fake_sets.h"
#include "tests/support/random_numbers.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// A wall of eight panels whose matrices have this third column, joined, and a crate behind it. Single-sided
// panels lie in the plane of their first two columns, so the third one changes nothing but the sign and size
// of the determinant, which says what their fronts are.
struct JoinedWall {
  Story story{allShapes()};
  std::vector<InstanceId> panels;
  InstanceId crate;
  std::size_t joined = 0;

  explicit JoinedWall(const Vec3d& third_column) {
    for (int i = 0; i < 8; ++i) {
      Mat4 m;
      m(0, 0) = 0.5;
      m(1, 1) = 4.0;
      for (int axis = 0; axis < 3; ++axis) {
        m(axis, 2) = third_column[axis];
        m(axis, 3) = Vec3d(-2.0 + 0.5 * i, -2.0, -4.0)[axis];
      }
      panels.push_back(story.add(1, m));
    }
    Mat4 behind;
    behind(2, 3) = -9.0;
    crate = story.add(0, behind);
    WorldJoin join = makeJoin(story.world.joinInput(panels));
    joined = join.instances.size();
    story.world.addJoin(std::move(join));
  }
  bool showsCrate() const {
    WorldCuller culler({.raster = {.width = 64, .height = 36}});
    const View view = viewFrom({0, 0, 0}, {0, 0, -1});
    culler.cull(story.world, view);
    culler.cull(story.world, view);
    return keeps(culler, crate);
  }
};

TEST(WorldMargins, FlattenedMembersOfJoinsHaveNoSides) {
  // Thin ones have sides: fronts that are seen hide.
  for (const double thickness : {1.0, 0x1p-10}) {
    const JoinedWall wall({0, 0, thickness});
    EXPECT_EQ(wall.joined, 8u) << thickness;
    EXPECT_FALSE(wall.showsCrate()) << thickness;
  }
  // Mirrored ones turn their backs, and hide nothing.
  const JoinedWall mirrored({0, 0, -0x1p-10});
  EXPECT_EQ(mirrored.joined, 8u);
  EXPECT_TRUE(mirrored.showsCrate());
  // Flattened: the determinant is 0, or its sign one that rounding may turn.
  for (const Vec3d& column : {Vec3d(0, 0, 0), Vec3d(0.1, 0.3, 0), Vec3d(0.1, 0.3, 0x1p-60),
                              Vec3d(0.1, 0.3, -0x1p-60), Vec3d(3.0, 1.0, 0x1p-50)}) {
    const JoinedWall flat(column);
    EXPECT_EQ(flat.joined, 0u) << column.x << " " << column.z;
    EXPECT_TRUE(flat.showsCrate()) << column.x << " " << column.z;
  }
}

// The matrix of a panel ten metres before the eye, from x0 to x1 and as high as this (metres).
Mat4 panelTo(double x0, double x1, double height) {
  Mat4 m;
  m(0, 0) = x1 - x0;
  m(1, 1) = height;
  m(0, 3) = x0;
  m(1, 3) = -0.5 * height;
  m(2, 3) = -10.0;
  return m;
}

// A panel near the eye is joined with one far away, so that its positions are rounded by some
// millimetres: outwards, over a crate that is seen beside its edge through a telescope.
TEST(WorldMargins, RoundingOfPositionsInAJoinHidesNothing) {
  for (const double far_away : {8.0, 524288.0}) {
    Story story(allShapes());
    const std::vector<InstanceId> panels{story.add(1, panelTo(-4.0, 0.009, 2.0)),
                                         story.add(1, panelTo(far_away, far_away + 4.0, 2.0))};
    Mat4 small;
    small(0, 0) = small(1, 1) = small(2, 2) = 0.003;
    small(2, 3) = -11.0;
    small(0, 3) = 0.0106;
    const InstanceId beside = story.add(0, small);
    small(0, 3) = 0.002;
    const InstanceId behind = story.add(0, small);
    WorldJoin join = makeJoin(story.world.joinInput(panels));
    ASSERT_EQ(join.instances.size(), 2u);
    EXPECT_EQ(join.rounding > 1e-3, far_away > 100.0);
    EXPECT_LE(join.rounding, 0x1p-24 * 2.0 * far_away);
    story.world.addJoin(std::move(join));
    View view = viewFrom({0.009, 0, 0}, {0, 0, -1});
    view.tan_half_fovy = 6e-3;
    view.z_near = 9.9;
    WorldCuller culler({.raster = {.width = 128, .height = 72}});
    for (int frame = 0; frame < 3; ++frame) {
      culler.cull(story.world, view);
      EXPECT_TRUE(keeps(culler, beside)) << far_away;
    }
    EXPECT_FALSE(keeps(culler, behind)) << far_away;
    // From an origin at which its members have no boxes, a join hides nothing, and back again what it did.
    story.world.setOrigin({3.5e38, 0, 0});
    culler.cull(story.world, view);
    EXPECT_TRUE(keeps(culler, behind)) << far_away;
    story.world.setOrigin({});
    culler.cull(story.world, view);
    culler.cull(story.world, view);
    EXPECT_TRUE(keeps(culler, beside)) << far_away;
    EXPECT_FALSE(keeps(culler, behind)) << far_away;
  }
}

TEST(WorldMargins, AJoinOfRoundedPositionsHidesOnlyIfThatIsAllowed) {
  Story story(allShapes());
  const std::vector<InstanceId> panels{story.add(1, panelTo(-10.0, 0.1, 20.0)),
                                       story.add(1, panelTo(0.1, 10.0, 20.0))};
  Mat4 small;
  small(2, 3) = -14.0;
  small(0, 3) = -0.4;
  const InstanceId behind_the_seam = story.add(0, small);
  WorldJoin join = makeJoin(story.world.joinInput(panels));
  EXPECT_GT(join.rounding, 0.0);
  story.world.addJoin(std::move(join));
  for (const double allowed : {WorldCullerSettings{}.join_rounding, 0.0}) {
    WorldCuller culler({.join_rounding = allowed});
    for (int frame = 0; frame < 3; ++frame) {
      culler.cull(story.world, viewFrom({0, 0, 0}, {0, 0, -1}));
    }
    EXPECT_EQ(keeps(culler, behind_the_seam), allowed == 0.0);
  }
}

// A level may be left while a thread still prepares its join.
TEST(WorldMargins, AJoinOfAnotherWorldHidesNothing) {
  Mat4 behind;
  behind(2, 3) = -14.0;
  const auto level = [&behind](double x) {
    auto story = std::make_unique<Story>(allShapes());
    const std::vector<InstanceId> ids{story->add(1, panelTo(x - 10.0, x, 20.0)),
                                      story->add(1, panelTo(x, x + 10.0, 20.0)), story->add(0, behind)};
    return std::pair(std::move(story), ids);
  };
  const auto [old_level, old_ids] = level(0.0);
  const WorldJoin join = makeJoin(old_level->world.joinInput(std::span(old_ids).first(2)));
  ASSERT_EQ(join.instances.size(), 2u);
  const View view = viewFrom({0, 0, 0}, {0, 0, -1});
  const auto keepsCrate = [&](Story& story, InstanceId crate) {
    WorldCuller culler;
    culler.cull(story.world, view);
    culler.cull(story.world, view);
    return keeps(culler, crate);
  };
  const auto [next_level, next_ids] = level(-30.0);
  ASSERT_EQ(next_ids, old_ids);
  next_level->world.addJoin(join);
  EXPECT_TRUE(keepsCrate(*next_level, next_ids[2]));
  Story empty(allShapes());
  empty.world.addJoin(join);
  EXPECT_TRUE(keepsCrate(empty, empty.add(0, behind)));
  // A world that was moved is the same one.
  World moved = std::move(old_level->world);
  moved.addJoin(join);
  old_level->world = std::move(moved);
  EXPECT_FALSE(keepsCrate(*old_level, old_ids[2]));
}

// Instances of a mesh, turned and scaled, around an origin.
struct Field {
  std::mt19937 engine;
  World world;
  std::vector<InstanceId> ids;
  std::vector<Mat4> matrices;

  Field(std::uint32_t seed, const Vec3d& origin) : engine(seed) {
    auto number = test::numbersFrom<double>(engine);
    std::vector<Vec3f> corners;
    for (int i = 0; i < 60; ++i) {
      corners.emplace_back(Vec3d(number(-1, 1), number(0, 2), number(-1, 1)));
    }
    const MeshId mesh = world.addMesh(*makeMesh({.positions = corners.data(), .vertex_count = 60}));
    world.setOrigin(origin);
    for (int i = 0; i < 100; ++i) {
      const double turn = number(0.0, 6.0), size = std::exp2(number(-3.0, 3.0));
      const Vec3d at = origin + Vec3d(number(-500, 500), number(-20, 20), number(-500, 500));
      Mat4 m;
      m(0, 0) = m(2, 2) = size * std::cos(turn);
      m(0, 2) = size * std::sin(turn);
      m(2, 0) = -m(0, 2);
      m(1, 1) = size;
      for (int axis = 0; axis < 3; ++axis) {
        m(axis, 3) = at[axis];
      }
      ids.push_back(world.add({.mesh = mesh, .world_from_mesh = m}));
      matrices.push_back(m);
    }
  }
};

TEST(WorldMargins, WhatStandsWhereItWasBakedIsNoTombstoneAndWhatWasMovedIs) {
  for (const Vec3d& origin : {Vec3d(), Vec3d(1 << 20, 0, -(1 << 22))}) {
    Field field(3, origin);
    // Turned meshes have larger boxes in a world than in a bake, so the baked ones are the world's, as
    // rounding may have left them: a unit in the last place of single precision off, towards either side.
    std::vector<Box> rounded;
    for (const InstanceId id : field.ids) {
      Box box = field.world.boundsOf(id);
      for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::nextafterf(box.min[axis], field.engine() % 2 == 0 ? -1e9f : 1e9f);
        box.max[axis] = std::nextafterf(box.max[axis], field.engine() % 2 == 0 ? -1e9f : 1e9f);
      }
      rounded.push_back(box);
    }
    fake_sets::FakeSets sets(rounded);
    const SetsId standing = field.world.addSets(field.ids, sets.boxes(), origin);
    EXPECT_EQ(field.world.tombstones(standing), 0u);
    field.world.removeSets(standing);
    // Each moved along one axis by eight millionths of its largest coordinate: that is no rounding.
    for (std::size_t i = 0; i < field.ids.size(); ++i) {
      const Box& box = rounded[i];
      const double size = maxComponent(max(abs(Vec3d(box.min)), abs(Vec3d(box.max))));
      Mat4 moved = field.matrices[i];
      moved(static_cast<int>(i % 3), 3) += (i % 2 == 0 ? 8e-6 : -8e-6) * size;
      field.world.setTransform(field.ids[i], moved);
    }
    const SetsId shifted = field.world.addSets(field.ids, sets.boxes(), origin);
    EXPECT_EQ(field.world.tombstones(shifted), field.ids.size());
  }
}

// A mirror lies in a wall that is joined with the floor, as double precision places it. Its clip plane cuts
// the wall away, and the join, whose positions are rounded, lies on the plane's other side.
TEST(WorldMargins, AJoinThatAClipPlaneCutsHidesNothing) {
  World world;
  const MeshId quad = [&world] {
    const std::array<float, 12> corners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::array<std::uint32_t, 6> indices{0, 1, 2, 0, 2, 3};
    auto mesh = makeMesh(
        {.positions = corners.data(), .vertex_count = 4, .indices = indices.data(), .index_count = 6},
        {.double_sided = true});
    return world.addMesh(std::move(*mesh));
  }();
  const auto place = [&](const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
    Mat4 matrix;
    const Vec3d normal = cross(u, v);
    for (int axis = 0; axis < 3; ++axis) {
      matrix(axis, 0) = u[axis];
      matrix(axis, 1) = v[axis];
      matrix(axis, 2) = normal[axis];
      matrix(axis, 3) = corner[axis];
    }
    return world.add({.mesh = quad, .world_from_mesh = matrix});
  };
  const double z = 0.1;  // of the wall, which single precision places elsewhere
  const std::array<InstanceId, 3> members{place({-2, -2, z}, {4, 0, 0}, {0, 4, 0}),
                                          place({-2, -2, z}, {4, 0, 0}, {0, 0, 1}),
                                          place({-2, -2, z + 1}, {4, 0, 0}, {0, 0, 1})};
  const InstanceId behind = world.add({.mesh = world.addMesh(boxMesh({{-0.5f, -0.5f, 5}, {0.5f, 0.5f, 6}}))});
  WorldJoin join = makeJoin(world.joinInput(members));
  ASSERT_EQ(join.instances.size(), members.size());
  ASSERT_GT(join.rounding, 0.0);
  world.addJoin(std::move(join));
  const View view = viewFrom({0, 0, -3}, {0, 0, 1});
  for (const double beyond_wall : {-1e-3, 1e-12, 5e-10, 1e-8, 2e-8, 1e-6}) {
    WorldCuller culler;
    culler.setClipPlane({{0, 0, 1}, -(z + beyond_wall)});
    culler.cull(world, view);
    culler.cull(world, view);
    EXPECT_EQ(keeps(culler, behind), beyond_wall > 0.0) << beyond_wall;
  }
}

// Boxes reach over a clip plane by less than double precision can tell so far from the origin. The test
// judges by long double, which on some machines is no more precise and could judge nothing.
TEST(WorldMargins, NoBoxThatReachesOverAClipPlaneIsHiddenByItFarAway) {
  if (std::numeric_limits<long double>::digits < 64) {
    GTEST_SKIP() << "needs a long double of more digits to judge";
  }
  std::size_t over = 0, behind_in_double = 0, hidden = 0;
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    std::mt19937 engine(seed);
    auto number = test::numbersFrom<double>(engine);
    World world;
    const double far = std::ldexp(1.0, 20 + static_cast<int>(seed % 12));
    const Vec3d away(number(-far, far), number(-far, far), number(-far, far));
    world.setOrigin(away);
    const Vec3d normal = normalized(Vec3d(number(-1, 1), number(-1, 1), number(-1, 1)));
    const Plane plane{normal, -dot(normal, away)};
    WorldCuller culler;
    culler.setClipPlane(plane);
    culler.cull(world, viewFrom(away + Vec3d(0, 0, 4), {0, 0, -1}));
    for (int i = 0; i < 500; ++i) {
      // A small box around a point of the plane, up to how well double precision knows it.
      const double error = 0x1p-52 * far;
      Box box;
      for (int axis = 0; axis < 3; ++axis) {
        const double at = number(-4.0, 4.0) * error;
        box.min[axis] = static_cast<float>(at - 0.25 * error);
        box.max[axis] = static_cast<float>(at + 0.25 * error);
      }
      long double reach = static_cast<long double>(plane.offset);
      double at_far_corner = plane.evaluate(away);
      for (int axis = 0; axis < 3; ++axis) {
        const double corner = normal[axis] > 0.0 ? box.max[axis] : box.min[axis];
        reach += static_cast<long double>(normal[axis]) *
                 (static_cast<long double>(away[axis]) + static_cast<long double>(corner));
        at_far_corner += normal[axis] * corner;
      }
      if (reach > 0x1p-60L * far) {
        ++over;
        behind_in_double += at_far_corner < 0.0 ? 1 : 0;
        EXPECT_NE(culler.classify(box), Visibility::kHidden) << seed << " " << i;
      }
      // What is surely behind the plane is hidden.
      const Vec3d below = normal * (-0x1p-40 * far);
      Box behind;
      behind.extend(Vec3f(below));
      hidden += culler.classify(behind) == Visibility::kHidden ? 1 : 0;
    }
  }
  EXPECT_GT(over, 5000u);
  EXPECT_GT(behind_in_double, 100u);  // which a plane without a margin would have hidden
  EXPECT_EQ(hidden, 40u * 500u);
}

}  // namespace
}  // namespace sightline
