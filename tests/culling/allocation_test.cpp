// Counts the calls of operator new in this program: a frame must not allocate once its storage has grown.

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "scenes/procedural.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "tests/culling/demo_frames.h"
#include "tests/culling/fake_sets.h"
#include "tests/support/count_allocations.h"

namespace sightline {
namespace {

using namespace demo_frames;

std::size_t allocationsIn(AnyCuller& culler, std::span<const View> views,
                          std::span<const Box> dynamic_boxes) {
  const std::size_t before = allocations;
  for (const View& view : views) {
    culler.cull(view, dynamic_boxes);
  }
  return allocations - before;
}

// Returns settings with every structure, with a small budget for relations, and with all uses of the
// database and several boxes an object.
std::vector<NamedSettings> allSettings() {
  std::vector<NamedSettings> all(std::begin(kStructures), std::end(kStructures));
  all.push_back({"frustum", {.method = AnyMethod::kFrustum}});
  all.push_back(
      {"little room", {.method = AnyMethod::kKeptPlanes, .kept_planes = {.relation_bytes = 100'000}}});
  for (const NamedSettings& method : kMethods) {
    NamedSettings with_database = method;
    with_database.settings.use_lists = true;
    with_database.settings.detail_objects = true;
    with_database.settings.object_boxes = true;
    all.push_back(with_database);
  }
  return all;
}

// How often the views of a test are culled before nothing may be allocated. Where finer depth buffers are
// drawn at any price, objects that they did not hide rest for up to 135 views, so they lie elsewhere in each
// of the first rounds.
int warmUps(const AnySettings& settings) {
  return settings.method == AnyMethod::kDepthPyramid && settings.focus.worth > FocusSettings{}.worth ? 8 : 2;
}

TEST(Allocations, AreCountedByThisTest) {
  AnyCuller culler = smallCity().culler(HierarchyKind::kBvh, {});
  EXPECT_GT(allocationsIn(culler, smallCity().frames(smallCity().scene.paths[0], 0, 1), {}), 0u);
}

// Nothing looks at the scene and the kind of hierarchy together, so each scene has one kind.
TEST(Allocations, DoNotHappenInAFrameOnceTheStorageHasGrown) {
  for (const auto& [demo, kind] :
       {std::pair(&smallCity(), HierarchyKind::kKdTree), std::pair(&smallBuilding(), HierarchyKind::kBvh)}) {
    // The views are a camera path with jumps, after which occluders are chosen as in a first frame.
    std::vector<View> views = demo->frames(demo->scene.paths[0], 80, 30);
    const std::vector<View> others = jumps(*demo, 21, 6);
    views.insert(views.end(), others.begin(), others.end());
    const std::vector<Box> dynamic_boxes(demo->bounds.begin(), demo->bounds.begin() + 20);
    for (const auto& [name, settings, stands_for_method] : allSettings()) {
      AnyCuller culler = demo->culler(kind, settings);
      for (int round = 0; round < warmUps(settings); ++round) {
        allocationsIn(culler, views, dynamic_boxes);
      }
      EXPECT_EQ(allocationsIn(culler, views, dynamic_boxes), 0u) << name << " " << nameOf(kind);
    }
  }
}

// More objects are in view than are looked at after a jump before anything is hidden.
TEST(Allocations, DoNotHappenWithSurfacesAlsoAfterAJump) {
  const DemoScene city(makeBoxCity({.buildings = 1500, .boxes = 4500}));
  const CullingScene scene{.hierarchy = &city.bvh,
                           .object_bounds = city.bounds,
                           .object_boxes = &city.objectBoxes(),
                           .surfaces = &city.surfaces()};
  const std::vector<View> views = city.frames(city.scene.paths[1], 0, 20);
  using MakeMethod = std::unique_ptr<CullingMethod> (*)();
  const MakeMethod methods[] = {[] { return depthPyramid(); },
                                [] { return opacityMap({.surfaces = SurfaceUse::kAlone}); }};
  for (const MakeMethod& method : methods) {
    Culler culler(scene, method());
    const auto allocationsInViews = [&] {
      const std::size_t before = allocations;
      for (const View& view : views) {
        culler.cull(view);
      }
      return allocations - before;
    };
    for (int round = 0; round < 8; ++round) {
      allocationsInViews();
    }
    EXPECT_EQ(allocationsInViews(), 0u);
  }
}

// A slow walk, in which most frames hold the answer of another, with a jump in it.
TEST(Allocations, DoNotHappenWithSeveralViewsAtOnce) {
  const DemoScene& demo = smallCity();
  const CullingScene scene{.hierarchy = &demo.bvh,
                           .object_bounds = demo.bounds,
                           .object_boxes = &demo.objectBoxes(),
                           .surfaces = &demo.surfaces()};
  std::vector<View> views;
  for (View view : demo.frames(demo.scene.paths[0], 40, 2)) {
    for (int frame = 0; frame < 20; ++frame) {
      view.eye = view.eye + view.forward * 0.02;
      views.push_back(view);
    }
  }
  const std::vector<Box> dynamic_boxes(demo.bounds.begin(), demo.bounds.begin() + 20);
  Culler culler(scene, depthPyramid(), {.views_at_once = 6});
  std::size_t counted = 0, held = 0;
  for (int round = 0; round < 9; ++round) {
    const std::size_t before = allocations;
    held = 0;
    for (const View& view : views) {
      culler.cull(view, dynamic_boxes);
      held += culler.stats().held ? 1 : 0;
    }
    counted = allocations - before;
  }
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(held, views.size() / 2);
}

TEST(Allocations, DoNotHappenWithOccludersThatMove) {
  const DemoScene& demo = smallCity();
  const std::vector<View> views = demo.frames(demo.scene.paths[0], 80, 20);
  // In each frame a wall stands in front of the eye.
  std::vector<OccluderSet> moving;
  for (const View& view : views) {
    std::vector<Vec3f> corners;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      corners.push_back(Vec3f(view.eye + view.forward * 6.0 + view.right * (3.0 * x) + view.up * (2.0 * y)));
    }
    const OccluderPolygon wall{corners, true, ObjectId()};
    moving.push_back(makeOccluders({&wall, 1}));
    ASSERT_EQ(moving.back().occluders.size(), 1u);
  }
  for (const auto& [name, settings, stands_for_method] : allSettings()) {
    AnyCuller culler = demo.culler(HierarchyKind::kBvh, settings);
    std::size_t counted = 0;
    for (int round = 0; round <= warmUps(settings); ++round) {
      const std::size_t before = allocations;
      for (std::size_t v = 0; v < views.size(); ++v) {
        culler.cull(views[v], {}, v % 5 == 4 ? nullptr : &moving[v]);
      }
      counted = allocations - before;
    }
    EXPECT_EQ(counted, 0u) << name;
  }
}

TEST(Allocations, DoNotHappenWhenTheVisibleSetIsAnotherInEachFrame) {
  const DemoScene& demo = smallCity();
  const std::vector<View> views = demo.frames(demo.scene.paths[0], 80, 24);
  std::vector<NamedSettings> all = allSettings();
  all.push_back({"visibility octree", {.method = AnyMethod::kVisibilityOctree}});
  for (auto& [name, settings, stands_for_method] : all) {
    settings.visible_sets = true;
    fake_sets::FakeSets sets(demo.bounds);
    std::mt19937_64 random(3);
    std::vector<std::vector<bool>> members;
    for (std::size_t v = 0; v < views.size(); ++v) {
      members.push_back(fake_sets::randomMembers(sets.boxes(), random));
    }
    AnyCuller culler(demo.bvh, demo.bounds, demo.occluders, settings, demo.listsFor(settings), &sets);
    std::size_t counted = 0;
    for (int round = 0; round < 3; ++round) {
      counted = 0;
      for (std::size_t v = 0; v < views.size(); ++v) {
        // Some frames have the same set as the last one, some have none.
        if (v % 8 == 7) {
          sets.useEverything();
        } else if (v % 4 != 3) {
          sets.use(static_cast<std::uint32_t>(v), members[v]);
        }
        counted += allocationsIn(culler, std::span(views).subspan(v, 1), {});
      }
    }
    EXPECT_EQ(counted, 0u) << name;
  }
}

}  // namespace
}  // namespace sightline
