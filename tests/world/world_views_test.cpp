// What views of a world may be: of a part of it, clipped by a plane, far from the origin, of other axes.

#include <gtest/gtest.h>

#include <limits>

#include "sightline/world/views_ahead.h"
#include "sightline/world/visible_history.h"
#include "tests/support/rounds.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// Tells the part of a story that a view of some groups shows. `groups` holds those of each instance.
ToldScene storyOf(const Story& all, const std::map<std::uint32_t, std::uint32_t>& groups,
                  std::uint32_t of_view) {
  ToldScene part{all.shapes};
  for (const auto& [id, told] : all.told) {
    if ((groups.at(id) & of_view) != 0) {
      part.told[id] = told;
    }
  }
  return part;
}

TEST(WorldViews, WhatIsInNoGroupOfTheViewNeitherShowsNorHides) {
  std::size_t culled = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(6u); ++seed) {
    RandomStory random(seed, 60);
    Story& story = random.story;
    std::map<std::uint32_t, std::uint32_t> groups;
    WorldCuller first({.groups = 1}), second({.groups = 6});
    for (int frame = 0; frame < 24; ++frame) {
      const View view = random.next();
      for (const auto& [id, told] : story.told) {
        const std::uint32_t group = random.chance.below(4) == 0 ? 1u << random.chance.below(3) : 3u;
        if (!groups.contains(id) || random.chance.below(8) == 0) {
          groups[id] = group;
        }
        story.world.setGroups(InstanceId(id), groups[id]);
      }
      first.cull(story.world, view);
      second.cull(story.world, view);
      for (const auto& [culler, of_view] : {std::pair(&first, 1u), std::pair(&second, 6u)}) {
        const ToldScene part = storyOf(story, groups, of_view);
        const Judged judged = judge(part, view, *culler);
        EXPECT_EQ(judged.wrong, "") << seed << " " << frame;
        culled += judged.culled;
        for (const InstanceId id : culler->visible()) {
          EXPECT_TRUE(part.told.contains(id.value));
        }
      }
    }
    View broken = viewFrom({0, 0, 0}, {0, 0, -1});
    broken.z_far = -1.0;
    first.cull(story.world, broken);
    for (const InstanceId id : first.visible()) {
      EXPECT_NE(groups.at(id.value) & 1, 0u);
    }
  }
  EXPECT_GT(culled, test::rounds(500u));
}

// The near plane of a view says the same as a clip plane parallel to it, so exact visibility knows the
// answer.
TEST(WorldViews, WhatIsInNoGroupAtAllIsInNoView) {
  World world;
  const MeshId box = addShape(world, boxShape());
  const Mat4 places[] = {boxAt({-2, 0, -6}, {1, 1, 1}), boxAt({0, 0, -6}, {1, 1, 1}),
                         boxAt({2, 0, -6}, {1, 1, 1})};
  const InstanceId none = world.add({.mesh = box, .world_from_mesh = places[0], .groups = 0}),
                   some = world.add({.mesh = box, .world_from_mesh = places[1]}),
                   removed = world.add({.mesh = box, .world_from_mesh = places[2], .groups = 0});
  // Its place is not known.
  world.add({.mesh = MeshId(), .groups = 0});
  const View view = viewFrom({0, 0, 0}, {0, 0, -1});
  const auto seen = [&] {
    WorldCuller culler;
    culler.cull(world, view);
    culler.cull(world, view);
    return std::vector(culler.visible().begin(), culler.visible().end());
  };
  EXPECT_EQ(seen(), std::vector{some});
  world.remove(removed);
  EXPECT_EQ(seen(), std::vector{some});
  world.setGroups(none, 1);
  EXPECT_EQ(seen(), (std::vector{none, some}));
  world.setGroups(some, 0);
  EXPECT_EQ(seen(), std::vector{none});
  world.removeMesh(box);
  EXPECT_TRUE(seen().empty());
}

TEST(WorldViews, WhatIsBehindTheClipPlaneNeitherShowsNorHides) {
  std::size_t culled = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(8u); ++seed) {
    RandomStory random(seed, 70);
    WorldCuller culler;
    for (int frame = 0; frame < 24; ++frame) {
      const View view = random.next();
      View clipped = view;
      clipped.z_near = 6.0;
      const Plane plane{view.forward, -dot(view.forward, view.eye) - clipped.z_near};
      culler.setClipPlane(plane);
      culler.cull(random.story.world, view);
      culler.cull(random.story.world, view);
      const Judged judged = judge(random.story, clipped, culler);
      EXPECT_EQ(judged.wrong, "") << seed << " " << frame;
      culled += judged.culled;
      Box behind;
      for (int axis = 0; axis < 3; ++axis) {
        const double at = view.eye[axis] + view.forward[axis] - random.story.world.origin()[axis];
        behind.min[axis] = static_cast<float>(at - 0.01);
        behind.max[axis] = static_cast<float>(at + 0.01);
      }
      EXPECT_EQ(culler.classify(behind), Visibility::kHidden);
    }
  }
  EXPECT_GT(culled, test::rounds(1000u));
}

// The same story here and far away; all numbers are short, so that nothing is rounded.
TEST(WorldViews, FarFromTheOriginAnswersAreTheSameAroundAnotherOne) {
  const Vec3d away(1 << 23, 0, -(1 << 24));
  for (std::uint32_t seed = 0; seed < test::rounds(6u); ++seed) {
    RandomStory random(seed, 60);
    World far;
    std::vector<MeshId> meshes;
    for (const Shape& shape : allShapes()) {
      meshes.push_back(addShape(far, shape));
    }
    // Without changes, so that both have the same ids.
    for (const auto& [id, told] : random.story.told) {
      EXPECT_EQ(far.add({.mesh = meshes[told.shape],
                         .world_from_mesh = movedBy(told.world_from_mesh, away),
                         .shown = told.shown}),
                InstanceId(id));
    }
    const std::vector<InstanceId> some{random.ids[1], random.ids[3], random.ids[5], random.ids[6]};
    far.setOrigin(away);
    far.addJoin(makeJoin(far.joinInput(some)));
    random.story.world.addJoin(makeJoin(random.story.world.joinInput(some)));
    WorldCuller here, there, loose;
    double heading = 0.0;
    for (int frame = 0; frame < 24; ++frame) {
      const View view = viewFrom({0.125 * frame, 1.5, 2.0}, {std::sin(heading), 0.0, std::cos(heading)});
      heading += 0.3;
      View far_view = view;
      far_view.eye = view.eye + away;
      here.cull(random.story.world, view);
      there.cull(far, far_view);
      EXPECT_TRUE(std::ranges::equal(here.visible(), there.visible())) << seed << " " << frame;
      // Around the old origin boxes are metres larger, and still right; it may also move between two frames.
      far.setOrigin({});
      loose.cull(far, far_view);
      EXPECT_EQ(judge(random.story, view, {&there, &loose}).wrong, "") << seed << " " << frame;
      EXPECT_GE(loose.visible().size(), there.visible().size());
      far.setOrigin(away + Vec3d(frame, 0, 0));
      loose.cull(far, far_view);
      EXPECT_EQ(judge(random.story, view, loose).wrong, "") << seed << " " << frame;
      far.setOrigin({std::numeric_limits<double>::quiet_NaN(), 0, 0});
      far.setOrigin(away);
    }
    EXPECT_EQ(far.origin(), away);
  }
}

// Axes of other programs, as a matrix of signs: what was x, y, z there.
struct Axes {
  const char* name;
  Mat4 own_from_here;
  bool left_handed;
};
Mat4 axes(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  Mat4 m;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 0) = x[axis], m(axis, 1) = y[axis], m(axis, 2) = z[axis];
  }
  return m;
}

TEST(WorldViews, AxesMayBeAnyAndOfEitherHand) {
  // Z up, right-handed (Blender); Y up, left-handed (Unity); Z up, left-handed (Unreal).
  for (const Axes& own : {Axes{"z up", axes({1, 0, 0}, {0, 0, 1}, {0, -1, 0}), false},
                          Axes{"left-handed", axes({1, 0, 0}, {0, 1, 0}, {0, 0, -1}), true},
                          Axes{"z up, left-handed", axes({0, 1, 0}, {0, 0, 1}, {-1, 0, 0}), true}}) {
    std::size_t culled = 0, culled_here = 0;
    for (std::uint32_t seed = 0; seed < test::rounds(4u); ++seed) {
      RandomStory random(seed, 60);
      World world;
      std::vector<MeshId> meshes;
      for (const Shape& shape : allShapes()) {
        std::vector<Vec3f> corners;
        for (const Vec3f& corner : shape.corners) {
          corners.emplace_back(transformPoint(own.own_from_here, Vec3d(corner)));
        }
        // The same picture: fronts stay counter-clockwise in it.
        const MeshView view{.positions = corners.data(),
                            .vertex_count = static_cast<std::uint32_t>(corners.size()),
                            .left_handed = own.left_handed};
        meshes.push_back(world.addMesh(*makeMesh(view, shape.settings)));
      }
      const Mat4 back = transposed(own.own_from_here);
      for (const auto& [id, told] : random.story.told) {
        EXPECT_EQ(world.add({.mesh = meshes[told.shape],
                             .world_from_mesh = own.own_from_here * told.world_from_mesh * back,
                             .shown = told.shown}),
                  InstanceId(id));
      }
      WorldCuller here, there;
      for (int frame = 0; frame < 12; ++frame) {
        const View view =
            viewFrom({0.5 * frame - 3.0, 1.5, 2.0}, {std::sin(0.5 * frame), 0, std::cos(0.5 * frame)});
        View own_view = view;
        own_view.eye = transformPoint(own.own_from_here, view.eye);
        own_view.right = transformDirection(own.own_from_here, view.right);
        own_view.up = transformDirection(own.own_from_here, view.up);
        own_view.forward = transformDirection(own.own_from_here, view.forward);
        for (int i = 0; i < 2; ++i) {
          here.cull(random.story.world, view);
          there.cull(world, own_view);
        }
        const Judged judged = judge(random.story, view, {&there, &here});
        EXPECT_EQ(judged.wrong, "") << own.name << " " << seed << " " << frame;
        culled += judged.culled;
        culled_here += judged.culled + there.visible().size() - here.visible().size();
      }
    }
    EXPECT_GT(20 * culled, 19 * culled_here) << own.name;
    EXPECT_GT(culled_here, test::rounds(500u));
  }
}

TEST(WorldViews, HistoryFadesInWhatTakesThePlaceOfARemovedOneAfterAnySteps) {
  Story story(allShapes());
  Mat4 at;
  at(2, 3) = -5.0;
  const InstanceId crate = story.add(0, at);
  const View view = viewFrom({0, 0, 4}, {0, 0, -1});
  WorldCuller culler;
  VisibleHistory history({.hold_s = 1.0, .fade_in_s = 0.5});
  culler.cull(story.world, view);
  history.update(story.world, culler, 0.0);
  for (int frame = 0; frame < 100; ++frame) {
    story.remove(crate);
    ASSERT_EQ(story.add(0, at), crate);
    culler.cull(story.world, view);
    history.update(story.world, culler, 0.1);
    ASSERT_FLOAT_EQ(history.opacity(crate), 0.2f) << frame;
  }
}

TEST(WorldViews, HistoryHoldsAndFades) {
  Story story(allShapes());
  Mat4 at;
  at(2, 3) = -5.0;
  const InstanceId crate = story.add(0, at), other = story.add(0, Mat4());
  const View to = viewFrom({0, 0, 4}, {0, 0, -1}), away = viewFrom({0, 0, 4}, {0, 0, 1});
  WorldCuller culler;
  VisibleHistory history({.hold_s = 1.0, .fade_in_s = 0.5});
  const auto frame = [&](const View& view, double seconds) {
    culler.cull(story.world, view);
    history.update(story.world, culler, seconds);
  };
  const auto held = [&] { return std::vector(history.held().begin(), history.held().end()); };
  frame(to, 0.0);
  EXPECT_EQ(held(), (std::vector{crate, other}));
  EXPECT_EQ(history.opacity(crate), 1.0f);
  frame(away, 0.25);
  frame(away, 0.5);
  EXPECT_EQ(held(), (std::vector{crate, other}));
  EXPECT_EQ(history.opacity(crate), 0.0f);
  frame(to, 0.25);
  EXPECT_EQ(history.opacity(crate), 0.5f);
  frame(to, 0.125);
  EXPECT_EQ(history.opacity(crate), 0.75f);
  frame(to, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(history.opacity(crate), 0.75f);
  // What takes the place of a removed one fades in as new.
  story.remove(crate);
  EXPECT_EQ(story.add(0, at), crate);
  frame(to, 0.125);
  EXPECT_EQ(history.opacity(crate), 0.25f);
  EXPECT_EQ(history.opacity(other), 1.0f);
  story.remove(other);
  frame(away, 0.5);
  EXPECT_EQ(held(), std::vector{crate});
  frame(away, 0.5);
  EXPECT_TRUE(held().empty());
  EXPECT_EQ(history.opacity(InstanceId(99u)), 0.0f);
}

// The crate goes while it is held and not seen, and another one that was never seen gets its id.
TEST(WorldViews, HistoryDoesNotTakeAnotherForOneThatItHolds) {
  Story story(allShapes());
  Mat4 at;
  at(2, 3) = -5.0;
  const InstanceId crate = story.add(0, at);
  const View to = viewFrom({0, 0, 4}, {0, 0, -1}), away = viewFrom({0, 0, 4}, {0, 0, 1});
  WorldCuller culler;
  VisibleHistory history({.hold_s = 1.0, .fade_in_s = 0.5});
  const auto frame = [&](const View& view) {
    culler.cull(story.world, view);
    history.update(story.world, culler, 0.125);
  };
  frame(to);
  frame(away);
  EXPECT_EQ(history.held().size(), 1u);
  story.remove(crate);
  ASSERT_EQ(story.add(0, at), crate);
  frame(away);
  EXPECT_TRUE(history.held().empty());
  frame(to);
  EXPECT_EQ(history.opacity(crate), 0.25f);
}

// A camera walks past the end of a wall; the crate behind it is foreseen half a second before it is seen.
TEST(WorldViews, WhatWillBeSeenIsForeseen) {
  Story story(allShapes());
  Mat4 wall;
  wall(0, 0) = 16.0, wall(1, 1) = 8.0, wall(0, 3) = -16.0, wall(2, 3) = -8.0, wall(1, 3) = -2.0;
  Mat4 crate_at;
  crate_at(0, 3) = -2.0, crate_at(2, 3) = -16.0;
  story.add(0, wall);
  const InstanceId crate = story.add(0, crate_at);
  WorldCuller culler, ahead;
  int seen_from = -1, foreseen_from = -1;
  for (int frame = 0; frame < 240; ++frame) {
    const View view = viewFrom({-8.0 + 0.05 * frame, 0, 0}, {0, 0, -1});
    std::array<View, 3> views;
    viewsAhead(view, {.velocity = {3.0, 0, 0}}, 0.5, views);
    EXPECT_NEAR(views[2].eye.x, view.eye.x + 1.5, 1e-12);
    EXPECT_EQ(views[2].tan_half_fovy, view.tan_half_fovy);
    culler.cull(story.world, view);
    ahead.cull(story.world, views);
    seen_from = seen_from < 0 && keeps(culler, crate) ? frame : seen_from;
    foreseen_from = foreseen_from < 0 && keeps(ahead, crate) ? frame : foreseen_from;
  }
  EXPECT_GT(seen_from, 40);
  EXPECT_GE(seen_from - foreseen_from, 25);
  EXPECT_LE(seen_from - foreseen_from, 40);
}

TEST(WorldViews, AViewAheadHasWhatTheCameraTurnsTo) {
  const View view = viewFrom({0, 0, 0}, {0, 0, -1});
  std::array<View, 5> views;
  viewsAhead(view, {.turn_rad_per_s = {0, 2.0, 0}, .spread = 1.0}, 0.5, views);
  // Two radians a second to the left make one radian in half a second.
  EXPECT_NEAR(views[4].forward.x, -std::sin(1.0), 1e-12);
  EXPECT_NEAR(views[4].forward.z, -std::cos(1.0), 1e-12);
  for (const View& each : views) {
    EXPECT_TRUE(validate(each));
    EXPECT_GE(each.tan_half_fovy, view.tan_half_fovy);
    EXPECT_GE(each.tan_half_fovy * each.aspect, view.tan_half_fovy * view.aspect);
  }
  View wide = view;
  wide.tan_half_fovy = 20.0;
  wide.orthographic = true;
  viewsAhead(wide, {.spread = 2.0}, 0.5, views);
  EXPECT_EQ(views[4].ortho_height, wide.ortho_height + 2.0);
  wide.orthographic = false;
  viewsAhead(wide, {.turn_rad_per_s = {5, 5, 5}}, 0.5, views);
  EXPECT_GE(views[0].tan_half_fovy, 20.0 - 1e-9);
  viewsAhead(view, {}, 0.5, {});
}

// Half a metre to the side is an angle of 1/20 ten metres away.
TEST(WorldViews, AViewAheadIsWiderByWhatTheSpreadIsAtADepth) {
  View view = viewFrom({0, 0, 0}, {0, 0, -1});
  const auto widerBy = [&](double depth) {
    std::array<View, 1> views;
    viewsAhead(view, {.spread = 1.0, .depth = depth}, 0.5, views);
    return std::atan(views[0].tan_half_fovy) - std::atan(view.tan_half_fovy);
  };
  EXPECT_NEAR(widerBy(10.0), std::atan(0.05), 1e-12);
  EXPECT_NEAR(widerBy(50.0), std::atan(0.01), 1e-12);
  view.z_near = 0.25;
  view.z_far = 400.0;
  EXPECT_NEAR(widerBy(0.0), std::atan(0.05), 1e-12);
  view.z_near = 1e-9;
  view.z_far = 1e4;
  EXPECT_NEAR(widerBy(0.0), std::atan(0.05), 1e-12);
  view.z_far = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(widerBy(0.0), std::atan(0.05), 1e-12);
}

// The axis of an off-centre view is nearer to one border, or outside of both, as in a tile of a large
// display.
TEST(WorldViews, AViewAheadIsWiderToAllSidesHoweverItIsShifted) {
  for (const double shift : {0.0, 0.5, -0.5, 1.2, -1.2, 2.0}) {
    for (const bool orthographic : {false, true}) {
      View view = viewFrom({0, 0, 0}, {0, 0, -1});
      view.orthographic = orthographic;
      view.tan_half_fovy = 0.5;
      view.ortho_height = 4.0;
      view.shift_x = shift;
      view.shift_y = -0.75 * shift;
      std::array<View, 2> views;
      viewsAhead(view, {.turn_rad_per_s = {0, 0.5, 0}, .spread = 1.0}, 0.25, views);
      // Borders to the right and to the left, up and down, each outwards.
      const auto borders = [&](const View& of) {
        const double high = orthographic ? 0.5 * of.ortho_height : of.tan_half_fovy, wide = high * of.aspect;
        return std::array{wide * (1.0 + of.shift_x), wide * (1.0 - of.shift_x), high * (1.0 + of.shift_y),
                          high * (1.0 - of.shift_y)};
      };
      const auto before = borders(view);
      for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_TRUE(validate(views[i]));
        // By a metre a second, or by the angle turned until the next view.
        const double time = 0.125 * static_cast<double>(i + 1), angle = 0.5 * 0.125;
        for (std::size_t border = 0; border < 4; ++border) {
          const double least =
              orthographic ? before[border] + time : std::tan(std::atan(before[border]) + angle);
          EXPECT_GE(borders(views[i])[border], least - 1e-9) << shift << " " << border;
          EXPECT_LE(borders(views[i])[border], least + 0.5) << shift << " " << border;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline
