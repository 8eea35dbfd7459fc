// Positions of joins are rounded to single precision: what that must not hide. And origins that move.

#include <gtest/gtest.h>

#include <vector>

#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

// A shape of these corners instead of those of a box of 1 m.
Shape block(const Vec3f& low, const Vec3f& high) {
  Shape shape = boxShape();
  shape.settings.double_sided = true;
  for (Vec3f& corner : shape.corners) {
    corner = {corner.x > 0 ? high.x : low.x, corner.y > 0 ? high.y : low.y, corner.z > 0 ? high.z : low.z};
  }
  return shape;
}

struct Place {
  World world;

  MeshId mesh(const Shape& shape) { return addShape(world, shape); }
  InstanceId add(MeshId mesh, const Vec3d& size, const Vec3d& at) {
    return world.add({.mesh = mesh, .world_from_mesh = boxAt(at, size)});
  }
  double join(const std::vector<InstanceId>& members) {
    WorldJoin join = makeJoin(world.joinInput(members));
    const double rounding = join.rounding;
    world.addJoin(std::move(join));
    return rounding;
  }
  bool keeps(InstanceId instance, const View& view, WorldCullerSettings settings = {}) const {
    settings.raster = {.width = 128, .height = 72};
    WorldCuller culler(settings);
    for (int frame = 0; frame < 4; ++frame) {
      culler.cull(world, view);
    }
    return culler.isVisible(instance);
  }
};

View lookingAlong(const Vec3d& eye, double tan_half_fovy, double near, double far) {
  View view = viewFrom(eye, {0, 0, -1});
  view.tan_half_fovy = tan_half_fovy;
  view.z_near = near;
  view.z_far = far;
  return view;
}

TEST(WorldRounding, APosterCloseBeforeAWallThatIsRoundedTowardsTheEyeIsSeen) {
  Place place;
  const MeshId panel = place.mesh(panelShape(true));
  const InstanceId wall = place.add(panel, {40, 40, 1}, {-20, -20, -100.0018}),
                   far_away = place.add(panel, {4, 4, 1}, {-2, -2, -130000}),
                   poster = place.add(panel, {8, 8, 1}, {-4, -4, -100.0008});
  const View view = lookingAlong({0, 0, 0}, 0.5, 0.1, 1000);
  EXPECT_TRUE(place.keeps(poster, view));
  EXPECT_GT(place.join({wall, far_away}), 1e-3);
  EXPECT_TRUE(place.keeps(poster, view));
}

TEST(WorldRounding, AMemberJustBesideTheViewMayBeRoundedIntoIt) {
  Place place;
  const double edge = -10.45 * 0x1p-10;
  Shape side;
  side.settings.double_sided = true;
  addQuad(side, {0, 0, 0}, {0, 0, -1}, {0, 1, -1}, {0, 1, 0});
  const MeshId panel = place.mesh(panelShape(true)), corridor = place.mesh(side);
  const std::vector<InstanceId> members{place.add(panel, {edge + 20, 20, 1}, {-20, -10, -10}),
                                        place.add(corridor, {1, 20, 11990}, {-20, -10, -10}),
                                        place.add(panel, {24, 20, 1}, {-20, -10, -12000}),
                                        place.add(panel, {1, 1, 1}, {29999, 0, -20})};
  const InstanceId crate =
      place.add(place.mesh(block({-0.02025f, -0.001f, -20.01f}, {-0.0199f, 0.001f, -20.0f})), {1, 1, 1}, {});
  const View view = lookingAlong({0, 0, 0}, 0.01015625 / 10 * 9 / 16, 9, 1e5);
  EXPECT_TRUE(place.keeps(crate, view));
  EXPECT_GT(place.join(members), 1e-4);
  EXPECT_TRUE(place.keeps(crate, view));
}

TEST(WorldRounding, AJoinFarFromTheZeroOfTheWorldKnowsItsRounding) {
  Place place;
  const Vec3d base{0x1p44, 0, 0};
  place.world.setOrigin(base);
  const MeshId panel = place.mesh(panelShape(true));
  const std::vector<InstanceId> members{place.add(panel, {4.003, 2, 1}, base + Vec3d{-4, -1, -10}),
                                        place.add(panel, {4, 2, 1}, base + Vec3d{8, -1, -10})};
  const InstanceId crate = place.add(
      place.mesh(block({0.00305f, -0.0002f, -11.0001f}, {0.00351f, 0.0002f, -11.0f})), {1, 1, 1}, base);
  const View view = lookingAlong(base + Vec3d{0x1p-8, 0, 0}, 1e-3, 9.9, 1000);
  EXPECT_TRUE(place.keeps(crate, view));
  EXPECT_GT(place.join(members), 0.0);
  EXPECT_TRUE(place.keeps(crate, view));
  EXPECT_TRUE(place.keeps(crate, view, {.join_rounding = 0.0}));
}

TEST(MovingOrigin, ArrivesAlsoWhereItIsAskedForInEachFrame) {
  Place place;
  const MeshId panel = place.mesh(panelShape(true));
  for (int i = 0; i < 3000; ++i) {
    place.add(panel, {1, 1, 1}, {static_cast<double>(i), 0, 0});
  }
  const Vec3d there{100, 0, 0};
  const auto callsUntilThere = [&](bool asks_again) {
    place.world.setOrigin({});
    place.world.moveOrigin(there);
    int calls = 0;
    for (; calls < 1000 && place.world.origin() != there; ++calls) {
      place.world.tidy(1000);
      if (asks_again) {
        place.world.moveOrigin(there);
      }
    }
    return calls;
  };
  const int once = callsUntilThere(false);
  EXPECT_LT(once, 1000);
  EXPECT_EQ(callsUntilThere(true), once);
}

TEST(MovingOrigin, SettingThePresentOneKeepsWhatIsUnderWay) {
  Place place;
  const MeshId panel = place.mesh(panelShape(true));
  for (int i = 0; i < 3000; ++i) {
    place.add(panel, {1, 1, 1}, {static_cast<double>(i), 0, 0});
  }
  // All were inserted one by one, so the hierarchy is built anew. It is so if fewer nodes are tested.
  const View view = lookingAlong({1500, 0.5, 10}, 0.1, 0.1, 100);
  const auto nodesTested = [&] {
    WorldCuller culler;
    culler.cull(place.world, view);
    return culler.stats().boxes_tested;
  };
  const std::uint32_t before = nodesTested();
  for (int call = 0; call < 200; ++call) {
    place.world.tidy(1000);
    place.world.setOrigin({});
  }
  const std::uint32_t after = nodesTested();
  for (int call = 0; call < 200; ++call) {
    place.world.tidy(1000);
  }
  EXPECT_EQ(after, nodesTested()) << before;
}

}  // namespace
}  // namespace sightline
