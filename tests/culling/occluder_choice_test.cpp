// Tests the choice of a frame's occluders: candidates, limits of distance, directions.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "sightline/occluders/occluder_database.h"
#include "tests/support/any_culler.h"

namespace sightline {
namespace {

using Objects = std::vector<ObjectId>;

// Polygons that are one object each, in the order of the objects' ids.
class Polygons {
 public:
  using Quad = std::array<Vec3f, 4>;

  explicit Polygons(std::vector<Quad> quads, const std::vector<Box>& boxes = {}) : quads_(std::move(quads)) {
    std::vector<OccluderPolygon> polygons;
    for (const Quad& quad : quads_) {
      polygons.push_back({quad, false, ObjectId(bounds.size())});
      Box box;
      for (const Vec3f& corner : quad) {
        box.extend(corner);
      }
      bounds.push_back(box);
    }
    bounds.insert(bounds.end(), boxes.begin(), boxes.end());
    occluders = makeOccluders(polygons);
    bvh = buildHierarchy(bounds, {});
  }

  Objects usedBy(AnyCuller& culler, const View& view) const {
    culler.cull(view);
    Objects used;
    for (const OccluderId id : culler.occludersUsed()) {
      used.push_back(occluders[id].object);
    }
    std::sort(used.begin(), used.end(), [](ObjectId a, ObjectId b) { return a.value < b.value; });
    return used;
  }

  std::vector<Box> bounds;
  OccluderSet occluders;
  Hierarchy bvh;

 private:
  std::vector<Quad> quads_;
};

// Returns a wall that faces +z.
Polygons::Quad wallAt(float z, float x0, float x1, float y0, float y1) {
  return {{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}};
}
// Returns a wall that faces -z.
Polygons::Quad backOfWallAt(float z, float x0, float x1, float y0, float y1) {
  return {{{x1, y0, z}, {x0, y0, z}, {x0, y1, z}, {x1, y1, z}}};
}

// Returns frame f of a camera path along -z with steps of 0.1 m.
View walkingAlongZ(int frame) {
  View view;
  view.eye = {0, 0, -0.1 * frame};
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 1.0;
  return view;
}

Objects objects(std::initializer_list<std::size_t> ids) {
  Objects list;
  for (const std::size_t id : ids) {
    list.emplace_back(id);
  }
  return list;
}

// Bittner et al. 1998, section 3: the occluders of a frame are among those of what the frame before it saw.
TEST(OccluderCandidates, AreThoseOfObjectsThatTheLastFrameKept) {
  const Polygons walls({wallAt(-5, -4, 4, -3, 3), wallAt(-10, -3, 3, -2, 2)});  // the second is hidden
  AnyCuller culler(walls.bvh, walls.bounds, walls.occluders,
                   {.method = AnyMethod::kSupportingPlanes, .occluder_count = 2});
  EXPECT_EQ(walls.usedBy(culler, walkingAlongZ(0)), objects({0, 1})) << "there is no last frame";
  for (int frame = 1; frame < 10; ++frame) {
    EXPECT_EQ(walls.usedBy(culler, walkingAlongZ(frame)), objects({0}));
  }
}

TEST(OccluderCandidates, AreLookedForInTheWholeFrustumNowAndThenWhereThereAreFew) {
  const Polygons walls({wallAt(-5, -4, 4, -3, 3), wallAt(-10, -3, 3, -2, 2)});
  AnyCuller culler(walls.bvh, walls.bounds, walls.occluders,
                   {.method = AnyMethod::kSupportingPlanes, .occluder_count = 8});
  int searches = 0;
  constexpr int kFrames = 40;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Objects used = walls.usedBy(culler, walkingAlongZ(0));
    searches += used == objects({0, 1}) ? 1 : 0;
    EXPECT_TRUE(used == objects({0, 1}) || used == objects({0}));
  }
  EXPECT_GE(searches, 2);
  EXPECT_LE(searches, kFrames / 4);
}

// Bittner et al. 1998, section 3: occluders are within lambda steps of the observer.
TEST(OccluderCandidates, LieWithinLambdaStepsOfTheObserver) {
  const Polygons walls({wallAt(-5, -4, -1, -3, 3), wallAt(-30, 2, 9, -3, 3)});
  const auto usedWith = [&](double lambda_steps) {
    AnyCuller culler(
        walls.bvh, walls.bounds, walls.occluders,
        {.method = AnyMethod::kSupportingPlanes, .occluder_count = 2, .lambda_steps = lambda_steps});
    EXPECT_EQ(walls.usedBy(culler, walkingAlongZ(0)), objects({0, 1})) << "no step is known yet";
    return walls.usedBy(culler, walkingAlongZ(1));
  };
  EXPECT_EQ(usedWith(100.0), objects({0}));      // 10 m
  EXPECT_EQ(usedWith(1000.0), objects({0, 1}));  // 100 m
  EXPECT_EQ(usedWith(0.0), objects({0, 1}));     // without a limit
}

// The area-angle -A (N . V) / |D|^2 of Coorg and Teller 1997, with V as printed and with V to the occluder.
TEST(OccluderCandidates, AreRankedByTheDirectionOfTheSettings) {
  const Polygons::Quad beside{{{-2, -3, -1}, {-2, -3, -30}, {-2, 3, -30}, {-2, 3, -1}}};  // faces +x
  const Polygons walls({beside, wallAt(-30, 0, 6, -3, 3)});
  const auto usedWith = [&](AreaAngleDirection direction) {
    AnyCuller culler(
        walls.bvh, walls.bounds, walls.occluders,
        {.method = AnyMethod::kSupportingPlanes, .occluder_count = 1, .area_angle_direction = direction});
    return walls.usedBy(culler, walkingAlongZ(0));
  };
  EXPECT_EQ(usedWith(AreaAngleDirection::kOccluder), objects({0}));
  EXPECT_EQ(usedWith(AreaAngleDirection::kView), objects({1}));
}

// Coorg and Teller 1997, section 5.1: whether the viewer is hidden from the object, by occluders near the
// object in the direction of the viewer.
TEST(DetailObjectsOfASmallScene, AreHiddenByOccludersTowardsTheViewer) {
  const Box crate{{-0.5, -0.5, -50.5}, {0.5, 0.5, -49.5}};
  const auto culledFrom = [&](double eye_z, const std::vector<Polygons::Quad>& quads) {
    const Polygons walls(quads, {crate});
    const Hierarchy kd_tree =
        buildHierarchy(walls.bounds, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = 1});
    // Cones are narrow and walls small, so that no list contains occluders of the opposite direction.
    const OccluderDatabase near = OccluderDatabase::build(
        kd_tree, walls.occluders, {.directions = 256, .view_angle_deg = 30.0, .turned_away = true});
    AnyCuller culler(walls.bvh, walls.bounds, walls.occluders,
                     {.method = AnyMethod::kSupportingPlanes,
                      .occluder_count = 0,
                      .detail_objects = true,
                      .detail_occluder_count = 8},
                     {.from_objects = &near});
    View view;
    view.eye = {0, 0, eye_z};
    setOrientation(view, {0, 0, eye_z > -50 ? -1.0 : 1.0}, {0, 1, 0});
    culler.cull(view);
    const auto kept = culler.visible();
    const ObjectId crate_id(quads.size());
    return std::find(kept.begin(), kept.end(), crate_id) == kept.end();
  };
  const Polygons::Quad front = wallAt(-40, -2, 2, -2, 2), back = backOfWallAt(-60, -2, 2, -2, 2);
  EXPECT_TRUE(culledFrom(0, {front, back}));
  EXPECT_TRUE(culledFrom(-100, {front, back}));
  EXPECT_FALSE(culledFrom(0, {back}));
  EXPECT_FALSE(culledFrom(-100, {front}));
}

}  // namespace
}  // namespace sightline
