// Moving occluders hide objects in their own frame and have no effect on later frames.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sightline/occluders/occluder_database.h"
#include "tests/culling/demo_frames.h"
#include "tests/culling/kept_objects.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace demo_frames;
using test::OraclePolygon;

// A field of boxes behind three static walls, past which another wall moves. The set of the moving wall is
// always in the same memory, and its occluder always has the same id.
struct Crossing {
  static constexpr int kFrames = 24;

  test::Random random{11};
  std::vector<OraclePolygon> walls{test::wall(-9, -6, -2, 2, -8), test::wall(-1, 1, -2, 2, -8),
                                   test::wall(6, 9, -2, 2, -8)};
  std::vector<Box> bounds;
  OccluderSet occluders, moving;
  OraclePolygon mover;

  Crossing() {
    std::vector<OccluderPolygon> input;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      bounds.push_back({walls[w].vertices[0], walls[w].vertices[2]});
      input.push_back({walls[w].vertices, false, ObjectId(w)});
    }
    occluders = makeOccluders(input);
    for (int i = 0; i < 150; ++i) {
      const Vec3d middle(random.in(-20, 20), random.in(-3, 3), random.in(-24, -11));
      const Vec3d half(random.in(0.05, 0.5), random.in(0.05, 0.5), random.in(0.05, 0.5));
      bounds.push_back({Vec3f(middle - half), Vec3f(middle + half)});
    }
  }

  // Per frame, the eye moves by centimetres and the wall by a metre.
  View step(int frame) {
    const float x = -12.0f + static_cast<float>(frame);
    mover = test::wall(x, x + 4, -3, 3, -5);
    const OccluderPolygon polygon{mover.vertices, false, ObjectId()};
    moving = makeOccluders({&polygon, 1});
    return test::viewFrom({0.01 * frame, 0.0, 0.0}, {0, 0, -1});
  }
};

class MovingOccluders : public ::testing::TestWithParam<std::tuple<std::size_t, HierarchyKind, bool>> {
 protected:
  AnySettings settings() const {
    AnySettings settings = kStructures[std::get<0>(GetParam())].settings;
    settings.raster = {.width = 512, .height = 512};
    settings.detail_objects = std::get<2>(GetParam());
    return settings;
  }
  HierarchyKind kind() const { return std::get<1>(GetParam()); }
};

TEST_P(MovingOccluders, HideNothingThatARayReachesAndNothingWhenTheyAreGone) {
  SCOPED_TRACE(kStructures[std::get<0>(GetParam())].name);
  Crossing scene;
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, {}, {.kind = kind(), .max_leaf_objects = 1});
  const OccluderDatabase near = OccluderDatabase::build(hierarchy, scene.occluders, {.turned_away = true});
  const AnyLists databases{.from_objects = &near};
  AnyCuller culler(hierarchy, scene.bounds, scene.occluders, settings(), databases);
  std::size_t hidden_by_it = 0, shown_again = 0;
  std::vector<bool> hidden_before(scene.bounds.size(), false);
  for (int frame = 0; frame < Crossing::kFrames; ++frame) {
    const View view = scene.step(frame);
    const bool there = frame % 6 != 5;  // now and then it is gone
    AnyCuller still(hierarchy, scene.bounds, scene.occluders, settings(), databases);
    still.cull(view);
    // A moving box is behind the moving wall.
    const float x = scene.mover.vertices[0].x;
    const Box follower{{2 * x + 3.5f, -0.5f, -11}, {2 * x + 4.5f, 0.5f, -10}};
    culler.cull(view, {&follower, 1}, there ? &scene.moving : nullptr);

    std::vector<OraclePolygon> polygons = scene.walls;
    if (there) {
      polygons.push_back(scene.mover);
    }
    for (std::size_t i = 0; i < scene.bounds.size(); ++i) {
      const bool hidden = !kept_objects::isKept(culler, ObjectId(i));
      if (hidden) {
        EXPECT_FALSE(test::lookAt(scene.bounds[i], view, polygons, 80, scene.random.engine()).seen)
            << "frame " << frame << " object " << i;
      }
      hidden_by_it += hidden && kept_objects::isKept(still, ObjectId(i)) ? 1 : 0;
      shown_again += !hidden && hidden_before[i] ? 1 : 0;
      hidden_before[i] = hidden;
    }
    if (culler.dynamicStates()[0] == Visibility::kHidden) {
      EXPECT_FALSE(test::lookAt(follower, view, polygons, 80, scene.random.engine()).seen)
          << "frame " << frame;
    }
    if (there && x > -8.0f && x < 4.0f) {
      EXPECT_EQ(culler.dynamicStates()[0], Visibility::kHidden) << "frame " << frame;
      EXPECT_EQ(culler.stats().occluders, culler.occludersUsed().size() + 1)
          << "its own, and the one that moves";
    }
    for (const OccluderId id : culler.occludersUsed()) {
      EXPECT_LT(id.value, scene.occluders.occluders.size());
    }
  }
  EXPECT_GT(hidden_by_it, 50u);
  EXPECT_GT(shown_again, 50u);
}

INSTANTIATE_TEST_SUITE_P(All, MovingOccluders,
                         ::testing::Combine(::testing::Range(std::size_t{0}, std::size(kStructures)),
                                            ::testing::ValuesIn(kKinds), ::testing::Bool()));

// Only relations of the culler's own occluders are kept from frame to frame, never those of moving ones.
TEST(MovingOccluders, LeaveNoRelationsBehind) {
  Crossing scene;
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, {}, {.max_leaf_objects = 1});
  const AnySettings settings{.method = AnyMethod::kKeptPlanes, .kept_planes = {.joint_occlusion = false}};
  const OccluderSet none;
  AnyCuller culler(hierarchy, scene.bounds, none, settings);
  for (int frame = 0; frame < Crossing::kFrames; ++frame) {
    const View view = scene.step(frame);
    culler.cull(view, {}, &scene.moving);
    EXPECT_EQ(culler.statistic("relations", "kept"), 0u);
    EXPECT_EQ(culler.statistic("relations", "reused"), 0u);
    if (frame > 8 && frame < 14) {
      EXPECT_GT(culler.statistic("relations", "rebuilt"), 0u);
    }
  }
}

}  // namespace
}  // namespace sightline
