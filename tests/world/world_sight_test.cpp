// Lines of sight to whole boxes, against exact visibility and rays.

#include "sightline/world/world_sight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/rounds.h"
#include "tests/world/rays.h"

namespace sightline {
namespace {

using namespace world_story;

// A scene of what a story shows, for questions whether any point of an instance's box can be seen from a
// point among all others.
class ExactSight {
 public:
  explicit ExactSight(const ToldScene& story) : scene_(story.scene(ids_)), exact_(scene_.view()) {}

  Verdict verdict(const Vec3d& from, InstanceId target, double near) const {
    const ObjectId asked(static_cast<std::size_t>(std::ranges::find(ids_, target) - ids_.begin()));
    View view = viewFrom(from, center(scene_.objects[asked.value].bounds) - from);
    view.z_near = near;
    view.tan_half_fovy = 4.0;
    view.aspect = 1.0;
    return exact_.decideBoxes(view, {&asked, 1}, 50'000)[0].verdict;
  }

 private:
  std::vector<InstanceId> ids_;
  Scene scene_;
  ExactVisibility exact_;
};

TEST(WorldSight, HiddenBoxesAreHiddenAndVisibleOnesHaveNothingBefore) {
  std::size_t hidden = 0, visible = 0, exactly_hidden = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(8u); ++seed) {
    RandomStory random(seed, 60);
    const Story& story = random.story;
    WorldSight sight({.near_distance = 0.0625});
    for (int frame = 0; frame < 30; ++frame) {
      const View view = random.next();
      const Rays rays(story);
      const ExactSight exact(story);
      for (int question = 0; question < 4; ++question) {
        InstanceId target = random.ids[random.any()];
        if (!story.told.at(target.value).shown) {
          continue;
        }
        const Box box = story.world.boundsOf(target);
        const Vec3d origin = story.world.origin();
        const Visibility answer = sight.look(story.world, view.eye, box, {&target, 1});
        const Verdict verdict = exact.verdict(view.eye, target, 0.0625);
        exactly_hidden += verdict == Verdict::kHidden ? 1 : 0;
        if (answer == Visibility::kHidden) {
          ++hidden;
          EXPECT_EQ(verdict, Verdict::kHidden) << seed << " " << frame;
        } else if (answer == Visibility::kVisible) {
          ++visible;
          for (int i = 0; i < 50; ++i) {
            const auto at = [&](int axis) { return random.chance.number(box.min[axis], box.max[axis]); };
            const Vec3d to = Vec3d(at(0), at(1), at(2)) + origin - view.eye;
            for (const Hit& hit : rays.hits(view.eye, normalized(to), 0.125, length(to))) {
              EXPECT_EQ(hit.id, target) << seed << " " << frame;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(hidden, test::rounds(20u));
  EXPECT_GT(visible, test::rounds(20u));
  EXPECT_GT(2 * hidden, exactly_hidden);
}

// Two panels side by side hide jointly once they are joined; ignoring one of them opens the way.
TEST(WorldSight, WhatIsIgnoredHidesNothing) {
  Story story(allShapes());
  const std::vector<InstanceId> panels{story.add(1, boxAt({-2, -2, -4}, {2, 4, 1})),
                                       story.add(1, boxAt({0, -2, -4}, {2, 4, 1}))};
  const Box crate{{-0.5f, -0.5f, -9.0f}, {0.5f, 0.5f, -8.0f}};
  WorldSight sight;
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate), Visibility::kPartial);
  story.world.addJoin(makeJoin(story.world.joinInput(panels)));
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate), Visibility::kHidden);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate, {&panels[1], 1}), Visibility::kPartial);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate, panels), Visibility::kVisible);
  // From behind, the panels are not drawn.
  EXPECT_EQ(sight.look(story.world, {0, 0, -20}, {{-0.5f, -0.5f, -1.0f}, {0.5f, 0.5f, 0.0f}}),
            Visibility::kPartial);
  // A point is a box, too.
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, {{0.25f, 0, -9}, {0.25f, 0, -9}}), Visibility::kHidden);
}

// The box is narrower than the numbers of world space so far from its origin, and a panel before it hides its
// middle third.
TEST(WorldSight, ABoxThatSticksOutOnBothSidesIsNotHiddenFarFromTheOriginOfWorldSpace) {
  for (const int exponent : {30, 40, 44}) {
    World world;
    const Vec3d origin(std::ldexp(1.0, exponent), 0, 0);
    world.setOrigin(origin);
    const auto half = static_cast<float>(0.49 * std::ldexp(1.0, exponent - 53));
    const std::array<float, 12> corners{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    const std::array<std::uint32_t, 6> indices{0, 1, 2, 0, 2, 3};
    auto panel = makeMesh(
        {.positions = corners.data(), .vertex_count = 4, .indices = indices.data(), .index_count = 6},
        {.double_sided = true});
    Mat4 matrix;
    matrix(0, 0) = half / 6.0;
    matrix(1, 1) = matrix(2, 2) = 10.0 * half / 3.0;
    matrix(0, 3) = origin.x;
    matrix(2, 3) = -1.0;
    world.add({.mesh = world.addMesh(std::move(*panel)), .world_from_mesh = matrix});
    WorldSight sight;
    EXPECT_NE(sight.look(world, origin, {{-half, -1e-4f, -2.001f}, {half, 1e-4f, -2.0f}}),
              Visibility::kHidden)
        << "2^" << exponent;
  }
}

TEST(WorldSight, HardQuestionsAreAnsweredWithMaybe) {
  Story story(allShapes());
  story.add(0, Mat4());
  WorldSight sight;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Box crate{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_EQ(sight.look(story.world, {kNan, 0, 0}, crate), Visibility::kPartial);
  EXPECT_EQ(sight.look(story.world, {0, HUGE_VAL, 0}, crate), Visibility::kPartial);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate), Visibility::kPartial);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, Box{}), Visibility::kPartial);
  EXPECT_EQ(sight.look(World(), {0, 0, 9}, crate), Visibility::kVisible);
  const InstanceId none(77u);
  EXPECT_EQ(sight.look(World(), {0, 0, 9}, crate, {&none, 1}), Visibility::kVisible);
}

}  // namespace
}  // namespace sightline
