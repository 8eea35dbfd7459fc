// Positions of joins are rounded to single precision: what that must not hide. And origins that move.

#include <gtest/gtest.h>

#include <vector>

#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "tests/support/square_view.h"

namespace sightline {
namespace {

using Corners = std::vector<Vec3f>;

void addQuad(Corners& corners, Vec3f a, Vec3f b, Vec3f c, Vec3f d) {
  corners.insert(corners.end(), {a, b, c, a, c, d});
}

Corners unitPanel() {
  Corners corners;
  addQuad(corners, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  return corners;
}

Corners block(const Vec3f& low, const Vec3f& high) {
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const auto corner = [&](int i) {
    return Vec3f{(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z};
  };
  Corners corners;
  for (const auto& face : kFaces) {
    addQuad(corners, corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3]));
  }
  return corners;
}

struct Place {
  World world;

  MeshId mesh(const Corners& corners) {
    const MeshView view{.positions = corners.data(),
                        .vertex_count = static_cast<std::uint32_t>(corners.size())};
    MeshSettings settings;
    settings.double_sided = true;
    return world.addMesh(*makeMesh(view, settings));
  }
  InstanceId add(MeshId mesh, const Vec3d& size, const Vec3d& at) {
    Mat4 m;
    for (int axis = 0; axis < 3; ++axis) {
      m(axis, axis) = size[axis];
      m(axis, 3) = at[axis];
    }
    return world.add({.mesh = mesh, .world_from_mesh = m});
  }
  double join(const std::vector<InstanceId>& members) {
    WorldJoin join = world.prepareJoin(members);
    const double rounding = join.rounding;
    world.use(std::move(join));
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
  View view;
  view.eye = eye;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = tan_half_fovy;
  view.z_near = near;
  view.z_far = far;
  return view;
}

TEST(WorldRounding, APosterCloseBeforeAWallThatIsRoundedTowardsTheEyeIsSeen) {
  Place place;
  const MeshId panel = place.mesh(unitPanel());
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
  Corners side;
  addQuad(side, {0, 0, 0}, {0, 0, -1}, {0, 1, -1}, {0, 1, 0});
  const MeshId panel = place.mesh(unitPanel()), corridor = place.mesh(side);
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
  const MeshId panel = place.mesh(unitPanel());
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
  const MeshId panel = place.mesh(unitPanel());
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
  const MeshId panel = place.mesh(unitPanel());
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
