// Meshes: what is welded, what stands for another mesh, and whether it lies inside.

#include "sightline/world/world_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "tests/world/world_story.h"

namespace sightline {
namespace {

using namespace world_story;

MeshView viewOf(const std::vector<Vec3f>& corners) {
  return {.positions = corners.data(), .vertex_count = static_cast<std::uint32_t>(corners.size())};
}

// A box shape with these corners.
std::vector<Vec3f> boxFrom(const Vec3f& min, const Vec3f& max) {
  std::vector<Vec3f> corners = boxShape().corners;
  for (Vec3f& p : corners) {
    p = {p.x > 0 ? max.x : min.x, p.y > 0 ? max.y : min.y, p.z > 0 ? max.z : min.z};
  }
  return corners;
}

std::string faultOf(const std::vector<Vec3f>& occluder, const std::vector<Vec3f>& drawn) {
  const Status status = checkInside(viewOf(occluder), viewOf(drawn));
  return status ? std::string() : status.error().message;
}

TEST(WorldMesh, SaysWhatWasWeldedAndWhatStaysOpen) {
  const Shape box = boxShape();
  const WorldMesh welded = *makeMesh(viewOf(box.corners));
  EXPECT_EQ(welded.vertices, 36u);
  EXPECT_EQ(welded.positions, 8u);
  EXPECT_EQ(welded.open_edges, 0u);
  // Vertices that are nearly equal are not welded; each of the twelve triangles is alone then.
  std::vector<Vec3f> torn = box.corners;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    torn[i].x += 0x1p-20f * static_cast<float>(i);
  }
  const WorldMesh open = *makeMesh(viewOf(torn));
  EXPECT_EQ(open.positions, 36u);
  EXPECT_EQ(open.open_edges, 36u);
  const WorldMesh panel = *makeMesh(viewOf(panelShape(false).corners));
  EXPECT_EQ(panel.positions, 4u);
  EXPECT_EQ(panel.open_edges, 4u);
  const WorldMesh nothing = *makeMesh({});
  EXPECT_EQ(nothing.triangles + nothing.vertices + nothing.positions + nothing.open_edges, 0u);
  const WorldMesh light = boxMesh({{-1, -1, -1}, {1, 1, 1}});
  EXPECT_TRUE(light.bounds.wellFormed());
  EXPECT_TRUE(light.surfaces.parts.empty());
}

// Its triangles name some vertices of a buffer of many meshes, with vertices of others between them.
TEST(WorldMesh, OfALargeBufferIsAsOfItsOwn) {
  const std::vector<Vec3f> own = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const std::vector<std::uint32_t> in_buffer = {3, 70, 900, 999};
  std::vector<Vec3f> buffer(1000, Vec3f(std::numeric_limits<float>::quiet_NaN(), 5.0f, 5.0f));
  std::vector<std::uint32_t> buffer_indices;
  for (std::size_t i = 0; i < own.size(); ++i) {
    buffer[in_buffer[i]] = own[i];
  }
  for (const std::uint32_t index : indices) {
    buffer_indices.push_back(in_buffer[index]);
  }
  const auto made = [](const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& of) {
    return *makeMesh({.positions = positions.data(),
                      .vertex_count = static_cast<std::uint32_t>(positions.size()),
                      .indices = of.data(),
                      .index_count = of.size()});
  };
  const WorldMesh mesh = made(own, indices), shared = made(buffer, buffer_indices);
  EXPECT_EQ(shared.bounds, (Box{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(shared.triangles, 4u);
  EXPECT_EQ(shared.vertices, 4u);
  EXPECT_EQ(shared.positions, 4u);
  EXPECT_EQ(shared.open_edges, 0u);
  EXPECT_EQ(shared.volume, mesh.volume);
  EXPECT_GT(mesh.volume, 0.0);
  EXPECT_FALSE(mesh.surfaces.vertices.empty());
  EXPECT_EQ(surfaceBytes(shared.surfaces), surfaceBytes(mesh.surfaces));
  // What no triangle names is not read, so it costs nothing, however much of it there is.
  const Result<WorldMesh> first = makeMesh({.positions = own.data(),
                                            .vertex_count = 0xffffffffu,
                                            .indices = indices.data(),
                                            .index_count = indices.size()});
  EXPECT_EQ(surfaceBytes(first->surfaces), surfaceBytes(mesh.surfaces));
  const Result<WorldMesh> few = makeMesh({.positions = own.data(),
                                          .vertex_count = static_cast<std::uint32_t>(indices.size()),
                                          .indices = indices.data(),
                                          .index_count = indices.size()});
  EXPECT_EQ(surfaceBytes(few->surfaces), surfaceBytes(mesh.surfaces));
}

TEST(WorldMesh, SaysWhetherItIsInsideOut) {
  Shape box = boxShape();
  for (Vec3f& corner : box.corners) {
    corner = {2.0f * corner.x + 100.0f, 3.0f * corner.y, corner.z - 50.0f};
  }
  MeshView view = viewOf(box.corners);
  EXPECT_EQ(makeMesh(view)->volume, 6.0);
  view.clockwise = true;
  EXPECT_EQ(makeMesh(view)->volume, -6.0);
  view.left_handed = true;
  EXPECT_EQ(makeMesh(view)->volume, 6.0);
  view.clockwise = false;
  EXPECT_EQ(makeMesh(view)->volume, -6.0);
}

// Within the drawn box its far sides show their backs, which are not drawn, so one sees past the box that
// hides in its place.
TEST(WorldMesh, AnotherMeshHidesNothingFromWithinTheDrawnOne) {
  const std::vector<Vec3f> drawn = boxFrom({-4, -4, -4}, {4, 4, 4}), inner = boxFrom({-1, -1, -1}, {1, 1, 1});
  const MeshView hides = viewOf(inner);
  World world;
  const InstanceId box = world.add({.mesh = world.addMesh(*makeMesh(viewOf(drawn), {.occluder = &hides}))});
  const InstanceId behind =
      world.add({.mesh = world.addMesh(boxMesh({{-0.125f, -0.125f, -9}, {0.125f, 0.125f, -8}}))});
  for (const bool joined : {false, true}) {
    if (joined) {
      const InstanceId both[] = {box};
      world.addJoin(makeJoin(world.joinInput(both)));
    }
    for (const double z : {2.0, 9.0}) {
      WorldCuller culler;
      culler.cull(world, viewFrom({0, 0, z}, {0, 0, -1}));
      culler.cull(world, viewFrom({0, 0, z}, {0, 0, -1}));
      EXPECT_EQ(culler.classify(world.boundsOf(behind)) == Visibility::kHidden, z > 4.0) << z << joined;
    }
  }
}

// The drawn mesh is a box with a part that is drawn in other levels of detail; a smaller box hides for it.
TEST(WorldMesh, AnotherMeshHidesInItsPlace) {
  const std::vector<Vec3f> drawn = boxFrom({-4, -4, 0}, {4, 4, 1}),
                           inner = boxFrom({-1, -1, 0.25f}, {1, 1, 0.75f});
  EXPECT_EQ(faultOf(inner, drawn), "");
  const MeshView hides = viewOf(inner);
  const WorldMesh mesh =
      *makeMesh(viewOf(drawn), {.occluder = &hides, .drawn_bounds = {{0, 0, 0}, {5, 1, 1}}});
  EXPECT_EQ(mesh.bounds, (Box{{-4, -4, 0}, {5, 4, 1}}));
  EXPECT_EQ(mesh.triangles, 12u);
  World world;
  world.add({.mesh = world.addMesh(mesh)});
  const MeshId crate = world.addMesh(boxMesh({{-0.125f, -0.125f, -9}, {0.125f, 0.125f, -8}}));
  const InstanceId behind = world.add({.mesh = crate});
  Mat4 aside;
  aside(0, 3) = 4.0;
  const InstanceId beside = world.add({.mesh = crate, .world_from_mesh = aside});
  WorldCuller culler;
  culler.cull(world, viewFrom({0, 0, 6}, {0, 0, -1}));
  culler.cull(world, viewFrom({0, 0, 6}, {0, 0, -1}));
  EXPECT_EQ(culler.classify(world.boundsOf(behind)), Visibility::kHidden);
  EXPECT_NE(culler.classify(world.boundsOf(beside)), Visibility::kHidden);
  MeshView broken = hides;
  broken.position_stride = 1;
  EXPECT_FALSE(makeMesh(viewOf(drawn), {.occluder = &broken}));
}

// A number of the drawn bounds that is not one says nothing about how far that side reaches.
TEST(WorldMesh, WithDrawnBoundsThatAreNotNumbersItIsAlwaysKept) {
  const std::vector<Vec3f> drawn = boxFrom({0, 0, 0}, {1, 1, 1});
  for (int side = 0; side < 6; ++side) {
    Box bounds{{-10, -10, -10}, {10, 10, 10}};
    (side < 3 ? bounds.min : bounds.max)[side % 3] = std::numeric_limits<float>::quiet_NaN();
    const WorldMesh mesh = *makeMesh(viewOf(drawn), {.drawn_bounds = bounds});
    EXPECT_FALSE(mesh.bounds.wellFormed()) << side;
    World world;
    const InstanceId id = world.add({.mesh = world.addMesh(mesh)});
    WorldCuller culler;
    // Nothing of the triangles is in this view.
    culler.cull(world, viewFrom({0, 0, -2}, {0, 0, -1}));
    EXPECT_TRUE(culler.isVisible(id)) << side;
  }
}

TEST(WorldMesh, WhatTouchesOrCrossesTheDrawnMeshIsNotInside) {
  const std::vector<Vec3f> drawn = boxFrom({0, 0, 0}, {4, 4, 4});
  EXPECT_EQ(faultOf(boxFrom({1, 1, 1}, {3, 3, 3}), drawn), "");
  for (const std::vector<Vec3f>& wrong :
       {boxFrom({1, 1, 1}, {3, 3, 4}), boxFrom({1, 1, 1}, {3, 3, 5}), boxFrom({5, 1, 1}, {6, 3, 3}),
        boxFrom({-1, -1, -1}, {5, 5, 5}), boxFrom({0, 0, 0}, {4, 4, 4}), boxFrom({4, 1, 1}, {6, 3, 3})}) {
    EXPECT_NE(faultOf(wrong, drawn), "");
  }
  // Two pieces, one inside and one outside.
  std::vector<Vec3f> pieces = boxFrom({1, 1, 1}, {3, 3, 3});
  const std::vector<Vec3f> other = boxFrom({6, 6, 6}, {7, 7, 7});
  pieces.insert(pieces.end(), other.begin(), other.end());
  EXPECT_NE(faultOf(pieces, drawn), "");
  // A hollow box: what is in the hollow is outside.
  std::vector<Vec3f> hollow = drawn;
  std::vector<Vec3f> hole = boxFrom({1, 1, 1}, {3, 3, 3});
  for (std::size_t i = 0; i < hole.size(); i += 3) {
    std::swap(hole[i + 1], hole[i + 2]);
  }
  hollow.insert(hollow.end(), hole.begin(), hole.end());
  EXPECT_NE(faultOf(boxFrom({1.5f, 1.5f, 1.5f}, {2, 2, 2}), hollow), "");
  EXPECT_EQ(faultOf(boxFrom({0.25f, 0.25f, 0.25f}, {0.5f, 3, 3}), hollow), "");
  // Inside out, or open, there is no inside.
  EXPECT_NE(faultOf(boxFrom({1.5f, 1.5f, 1.5f}, {2, 2, 2}), hole), "");
  std::vector<Vec3f> open = drawn;
  open.resize(open.size() - 3);
  EXPECT_NE(faultOf(boxFrom({1, 1, 1}, {3, 3, 3}), open), "");
  EXPECT_NE(faultOf({{1, 1, 1}, {2, HUGE_VALF, 1}, {2, 2, 2}}, drawn), "");
  EXPECT_EQ(faultOf({}, drawn), "");
  EXPECT_FALSE(checkInside({.position_stride = 3}, viewOf(drawn)));
}

// The drawn mesh is a cross of five cubes, not convex, so the planes of its faces run through its inside.
// Each corner of the occluders is in such a plane, so whichever one is asked about is.
TEST(WorldMesh, ACornerInThePlaneOfADrawnTriangleDoesNotDecideWhatIsInside) {
  const std::array<std::array<float, 2>, 5> cubes{{{0, 0}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}}};
  std::vector<Vec3f> cross;
  for (const auto& [x, z] : cubes) {
    const std::vector<Vec3f> cube = boxFrom({x - 1, -1, z - 1}, {x + 1, 1, z + 1});
    for (std::size_t i = 0; i < cube.size(); i += 3) {
      // Faces between two of the cubes are not drawn.
      const Vec3f middle =
          (min(min(cube[i], cube[i + 1]), cube[i + 2]) + max(max(cube[i], cube[i + 1]), cube[i + 2])) * 0.5f;
      const bool is_between = middle.y == 0.0f && std::abs(middle.x) + std::abs(middle.z) == 1.0f;
      if (!is_between) {
        cross.insert(cross.end(), cube.begin() + static_cast<std::ptrdiff_t>(i),
                     cube.begin() + static_cast<std::ptrdiff_t>(i) + 3);
      }
    }
  }
  ASSERT_EQ(cross.size(), 3u * 2u * 22u);
  // These reach from the plane x = -1 to the plane x = 1, and from z = -1 to z = 1.
  EXPECT_EQ(faultOf(boxFrom({-1, -0.5f, -0.5f}, {1, 0.5f, 0.5f}), cross), "");
  EXPECT_EQ(faultOf(boxFrom({-0.5f, -0.5f, -1}, {0.5f, 0.5f, 1}), cross), "");
  // Outside are boxes beyond an arm, between the planes of its sides, and boxes beside two arms, between the
  // planes of the cross's top and bottom.
  for (const std::vector<Vec3f>& outside :
       {boxFrom({-1, -0.5f, 4}, {1, 0.5f, 5}), boxFrom({-1, -0.5f, -9}, {1, 0.5f, -8}),
        boxFrom({1.5f, -1, 1.5f}, {2.5f, 1, 2.5f}), boxFrom({-2.5f, -1, 1.5f}, {-1.5f, 1, 2.5f})}) {
    EXPECT_NE(faultOf(outside, cross).find("lies outside"), std::string::npos);
  }
}

// A tetrahedron is inside a box if all four of its corners are, since a box is convex.
TEST(WorldMesh, InsideABoxIsWhatHasAllCornersInside) {
  std::mt19937 engine(11);
  std::size_t inside = 0;
  for (int i = 0; i < 4000; ++i) {
    // Whole numbers, so that touching is frequent.
    std::array<Vec3f, 4> t;
    bool all = true;
    for (Vec3f& p : t) {
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = static_cast<float>(engine() % 10);
        all = all && p[axis] > 0.0f && p[axis] < 9.0f;
      }
    }
    const Vec3d a(t[1] - t[0]), b(t[2] - t[0]), c(t[3] - t[0]);
    if (dot(cross(a, b), c) == 0.0) {
      continue;
    }
    const std::vector<Vec3f> corners{t[0], t[1], t[2], t[0], t[2], t[3], t[0], t[3], t[1], t[1], t[3], t[2]};
    EXPECT_EQ(faultOf(corners, boxFrom({0, 0, 0}, {9, 9, 9})) == "", all);
    inside += all ? 1 : 0;
  }
  EXPECT_GT(inside, 50u);
}

TEST(World, UserDataAreTheCallersOwn) {
  World world;
  const MeshId mesh = world.addMesh(boxMesh({{0, 0, 0}, {1, 1, 1}}));
  const InstanceId id = world.add({.mesh = mesh, .user_data = 0xfedcba9876543210u});
  EXPECT_EQ(world.userDataOf(id), 0xfedcba9876543210u);
  world.remove(id);
  EXPECT_EQ(world.userDataOf(id), 0u);
  EXPECT_EQ(world.userDataOf(world.add({.mesh = mesh})), 0u);
}

TEST(World, ItSaysThatAnIdWasGivenAgain) {
  World world;
  const MeshId mesh = world.addMesh(boxMesh({{0, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(world.bornOf(InstanceId(0u)), 0u);
  const InstanceId id = world.add({.mesh = mesh});
  const std::uint64_t first = world.bornOf(id);
  EXPECT_GT(first, 0u);
  world.setTransform(id, boxAt({1, 2, 3}, {4, 5, 6}));
  world.setShown(id, false);
  EXPECT_EQ(world.bornOf(id), first);
  world.replace(id, {.mesh = mesh});
  const std::uint64_t second = world.bornOf(id);
  EXPECT_GT(second, first);
  world.remove(id);
  EXPECT_EQ(world.bornOf(id), 0u);
  EXPECT_EQ(world.bornOf(InstanceId()), 0u);
  EXPECT_EQ(world.add({.mesh = mesh}), id);
  EXPECT_GT(world.bornOf(id), second);
}

TEST(World, ABoxFromTheOriginContainsTheOneInWorldSpace) {
  std::mt19937 engine(5);
  const auto number = test::numbersFrom<double>(engine);
  World world;
  for (int i = 0; i < 1000; ++i) {
    const double reach = std::ldexp(1.0, i % 30);
    const auto point = [&](double size) {
      return Vec3d(number(-size, size), number(-size, size), number(-size, size));
    };
    const Vec3d origin = point(reach), min = point(reach), max = min + Vec3d(1, 2, 3);
    world.setOrigin(origin);
    const Box box = world.boxFromOrigin(min, max);
    EXPECT_TRUE(box.wellFormed());
    for (int axis = 0; axis < 3; ++axis) {
      const double low = min[axis] - origin[axis], high = max[axis] - origin[axis];
      EXPECT_LT(box.min[axis], low);
      EXPECT_GT(box.max[axis], high);
      EXPECT_NEAR(box.min[axis], low, 0x1p-21 * std::abs(low) + 1e-30);
      EXPECT_NEAR(box.max[axis], high, 0x1p-21 * std::abs(high) + 1e-30);
    }
  }
}

}  // namespace
}  // namespace sightline
