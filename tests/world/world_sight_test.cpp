// Lines of sight to whole boxes, against exact visibility and rays.

#include "sightline/world/world_sight.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/world/rays.h"

namespace sightline {
namespace {

using namespace world_story;

// Whether any point of an instance's box can be seen from a point, among all others.
Verdict exactly(const Story& story, const Vec3d& from, InstanceId target, double near) {
  std::vector<InstanceId> ids;
  Scene scene = story.scene(ids);
  const auto object = static_cast<std::uint32_t>(std::find(ids.begin(), ids.end(), target) - ids.begin());
  View view = viewFrom(from, center(scene.objects[object].bounds) - from);
  view.z_near = near;
  view.tan_half_fovy = 4.0;
  view.aspect = 1.0;
  const ExactVisibility exact(scene.view());
  const ObjectId asked(object);
  return exact.decideBoxes(view, {&asked, 1}, 50'000)[0].verdict;
}

TEST(WorldSight, HiddenBoxesAreHiddenAndVisibleOnesHaveNothingBefore) {
  std::size_t hidden = 0, visible = 0, exactly_hidden = 0;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    RandomStory random(seed, 60);
    const Story& story = random.story;
    WorldSight sight({.near_distance = 0.0625});
    for (int frame = 0; frame < 30; ++frame) {
      const View view = random.next();
      const Rays rays(story);
      for (int question = 0; question < 4; ++question) {
        InstanceId target = random.ids[random.any()];
        if (!story.told.at(target.value).shown) {
          continue;
        }
        const Box box = story.world.boundsOf(target);
        const Vec3d origin = story.world.origin();
        const Visibility answer = sight.look(story.world, view.eye, box, {&target, 1});
        const Verdict verdict = exactly(story, view.eye, target, 0.0625);
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
  EXPECT_GT(hidden, 20u);
  EXPECT_GT(visible, 20u);
  EXPECT_GT(2 * hidden, exactly_hidden);
}

// Two panels side by side hide jointly once they are joined; ignoring one of them opens the way.
TEST(WorldSight, WhatIsIgnoredHidesNothing) {
  Story story(allShapes());
  const auto panelAt = [](double x) {
    Mat4 m;
    m(0, 3) = x, m(1, 3) = -2.0, m(2, 3) = -4.0;
    m(0, 0) = 2.0, m(1, 1) = 4.0;
    return m;
  };
  const std::vector<InstanceId> panels{story.add(1, panelAt(-2.0)), story.add(1, panelAt(0.0))};
  const Box crate{{-0.5f, -0.5f, -9.0f}, {0.5f, 0.5f, -8.0f}};
  WorldSight sight;
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate), Visibility::kPartial);
  story.world.use(story.world.prepareJoin(panels));
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate), Visibility::kHidden);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate, {&panels[1], 1}), Visibility::kPartial);
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, crate, panels), Visibility::kVisible);
  // From behind, the panels are not drawn.
  EXPECT_EQ(sight.look(story.world, {0, 0, -20}, {{-0.5f, -0.5f, -1.0f}, {0.5f, 0.5f, 0.0f}}),
            Visibility::kPartial);
  // A point is a box, too.
  EXPECT_EQ(sight.look(story.world, {0, 0, 0}, {{0.25f, 0, -9}, {0.25f, 0, -9}}), Visibility::kHidden);
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
