// The depth pyramid with finer depth buffers, against rays and exact proofs.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/occluders/surface_set.h"
#include "tests/culling/demo_frames.h"
#include "tests/culling/edge_scene.h"
#include "tests/culling/kept_objects.h"
#include "tests/culling/seen_though_culled.h"
#include "tests/support/rounds.h"
#include "tests/support/solids.h"

namespace sightline::culling {
namespace {

using kept_objects::isKept;
using test::EdgeScene;
using test::Random;

// A street with blocks along it, walls that cross the near plane, and small boxes at its far end, all
// objects.
struct Street {
  std::vector<test::OraclePolygon> polygons;
  std::vector<test::PreparedPolygon> prepared;  // the same, for rays
  std::vector<Box> bounds;
  OccluderSet occluders;
  Hierarchy hierarchy;
  std::vector<View> views;
  std::size_t first_small = 0;

  explicit Street(std::uint64_t seed) {
    Random random(seed);
    std::vector<ObjectId> owners;
    for (int i = 0; i < 14; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0, z = -6.0 - 5.0 * i;
      const double x = side * random.in(1.5, 3.5), width = random.in(2.0, 5.0);
      addBlock({Vec3f(Vec3d(std::min(x, x + side * width), -2, z - random.in(2.0, 6.0))),
                Vec3f(Vec3d(std::max(x, x + side * width), random.in(2.0, 9.0), z))},
               owners);
    }
    addBlock({Vec3f(-3, -2, -90), Vec3f(3, static_cast<float>(random.in(0.5, 2.0)), -88)}, owners);
    for (int i = 0; i < 3; ++i) {
      addWallAcrossTheNearPlane(random, owners);
    }
    first_small = bounds.size();
    for (int i = 0; i < 250; ++i) {
      const Vec3d middle(random.in(-8, 8), random.in(-2, 4), random.in(-130, -20));
      const Vec3d half = Vec3d(0.05, 0.05, 0.05) + abs(random.point(0.4));
      bounds.push_back({Vec3f(middle - half), Vec3f(middle + half)});
    }
    std::vector<OccluderPolygon> input;
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      input.push_back({polygons[i].vertices, polygons[i].double_sided, owners[i]});
    }
    prepared = test::prepared(polygons);
    occluders = makeOccluders(input);
    hierarchy = buildHierarchy(bounds, {});
    for (int frame = 0; frame < 6; ++frame) {
      View view = test::viewFrom({random.in(-0.2, 0.2), random.in(-0.2, 0.2), -0.3 * frame},
                                 {random.in(-0.1, 0.1), random.in(-0.05, 0.05), -1.0});
      view.z_near = 1.0;
      views.push_back(view);
    }
  }

 private:
  void addBlock(const Box& box, std::vector<ObjectId>& owners) {
    const test::Solid solid = test::block(box.min, box.max);
    for (std::size_t face = 0; face < solid.faces.size(); ++face) {
      polygons.push_back({solid.polygon(face), false});
      owners.push_back(ObjectId(bounds.size()));
    }
    bounds.push_back(box);
  }
  // Geometry in front of the near plane is not drawn: objects behind it are visible.
  void addWallAcrossTheNearPlane(Random& random, std::vector<ObjectId>& owners) {
    const double x = random.in(-0.4, 0.4), y = random.in(-0.6, 0.0), high = y + random.in(0.1, 0.5);
    const double from = random.in(0.2, 0.9), to = random.in(1.5, 6.0), lean = random.in(-0.8, 0.8);
    const std::vector<Vec3f> corners{Vec3f(Vec3d(x, y, -from)), Vec3f(Vec3d(x + lean, y, -to)),
                                     Vec3f(Vec3d(x + lean, high, -to)), Vec3f(Vec3d(x, high, -from))};
    polygons.push_back({corners, true});
    owners.push_back(ObjectId(bounds.size()));
    Box box;
    for (const Vec3f& corner : corners) {
      box.extend(corner);
    }
    bounds.push_back(box);
  }
};

// Whether rays reach a small box of the street.
bool seen(const Street& street, std::size_t object, const View& view) {
  std::mt19937_64 random(object);
  return test::lookAt(street.bounds[object], view, street.prepared, 400, random).seen;
}

AnySettings focused(bool coherent) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.worth = 1e9}};
  settings.raster = {.width = 96, .height = 96};  // coarse, so that it leaks
  settings.temporal_coherence = coherent;
  return settings;
}

// A finer buffer may hide a box of which the first one shows a point.
TEST(FocusedCuller, SeesNoPointOfABoxThatAFinerBufferHides) {
  std::size_t hidden_by_windows = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Street street(seed);
    DepthPyramidMethodSettings settings{.raster = {.width = 96, .height = 96}, .focus = {.worth = 1e9}};
    const CullingScene scene{
        .hierarchy = &street.hierarchy, .object_bounds = street.bounds, .occluders = &street.occluders};
    std::unique_ptr<CullingMethod> owned = depthPyramid(settings);
    settings.focus.windows = 0;
    std::unique_ptr<CullingMethod> owned_without = depthPyramid(settings);
    CullingMethod &method = *owned, &without = *owned_without;
    Culler culler(scene, std::move(owned)), culler_without(scene, std::move(owned_without));
    std::vector<MovingBox> boxes;
    std::vector<Vec3f> points;
    for (const Box& box : street.bounds) {
      boxes.push_back({box});
      points.push_back(Vec3f(center(box)));
    }
    std::vector<Visibility> states(boxes.size());
    std::vector<std::uint8_t> seen(boxes.size()), seen_without(boxes.size());
    for (const View& view : street.views) {
      culler.cull(view);
      culler_without.cull(view);
      method.classify(boxes, states);
      method.seesPoints(points, seen);
      without.seesPoints(points, seen_without);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_FALSE(seen[i] != 0 && states[i] == Visibility::kHidden) << "seed " << seed << ", box " << i;
        hidden_by_windows += seen_without[i] != 0 && states[i] == Visibility::kHidden ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hidden_by_windows, 0u);
}

TEST(FocusedCuller, CullsNothingThatARayReachesThoughWallsCrossTheNearPlane) {
  std::size_t focused_frames = 0, judged = 0, more = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(16u); ++seed) {
    const Street street(seed);
    AnySettings settings = focused(seed % 2 == 0);
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    settings.focus.magnification = 1.0;
    AnyCuller without(street.hierarchy, street.bounds, street.occluders, settings);
    for (std::size_t frame = 0; frame < street.views.size(); ++frame) {
      const View& view = street.views[frame];
      culler.cull(view);
      without.cull(view);
      focused_frames += culler.statistic("map", "focused");
      EXPECT_EQ(without.statistic("map", "focused"), 0u);
      for (std::size_t i = 0; i < street.bounds.size(); ++i) {
        if (isKept(culler, ObjectId(i))) {
          continue;
        }
        ++judged;
        more += isKept(without, ObjectId(i)) ? 1 : 0;
        std::mt19937_64 random(i);
        // The polygons of an occluding object would block rays to itself.
        const test::Sight sight = i < street.first_small
                                      ? test::Sight{}
                                      : test::lookAt(street.bounds[i], view, street.prepared,
                                                     isKept(without, ObjectId(i)) ? 400 : 20, random);
        EXPECT_FALSE(sight.seen) << "seed " << seed << ", frame " << frame << ", object " << i << " at "
                                 << sight.point.x << " " << sight.point.y << " " << sight.point.z;
      }
    }
  }
  EXPECT_GT(focused_frames, test::rounds(60u));
  EXPECT_GT(judged, test::rounds(5'000u));
  EXPECT_GT(more, test::rounds(40u)) << "hidden by the window's map alone";
}

TEST(FocusedCuller, HasAtMostAsManyWindowsAsItIsToldAndNoneWithoutMagnification) {
  const Street street(3);
  for (const std::uint32_t windows : {0u, 1u, 2u, kMaxFocusWindows, 1'000'000u}) {
    AnySettings settings = focused(false);
    settings.focus.windows = windows;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    std::uint64_t max_windows = 0;
    for (const View& view : street.views) {
      culler.cull(view);
      max_windows = std::max(max_windows, culler.statistic("map", "focused"));
    }
    EXPECT_LE(max_windows, windows);
    EXPECT_EQ(max_windows > 0, windows > 0);
  }
  for (const double magnification : {1.0, 0.5, 0.0, -3.0, std::numeric_limits<double>::quiet_NaN()}) {
    AnySettings settings = focused(false);
    settings.focus.magnification = magnification;
    AnyCuller other(street.hierarchy, street.bounds, street.occluders, settings);
    for (int frame = 0; frame < 3; ++frame) {
      other.cull(street.views[0]);
      EXPECT_EQ(other.statistic("map", "focused"), 0u) << magnification;
    }
  }
}

TEST(FocusedCuller, DrawsNoWindowThatDoesNotPay) {
  const Street street(3);
  for (const double worth : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    AnySettings settings = focused(false);
    settings.focus.worth = worth;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    for (const View& view : street.views) {
      culler.cull(view);
      EXPECT_EQ(culler.statistic("map", "focused"), 0u) << worth;
    }
  }
}

TEST(FocusedCuller, GivesTheSameAnswersWithAbsurdSettings) {
  const Street street(5);
  AnySettings without = focused(false);
  without.focus.windows = 0;
  for (const double magnification : {1.0001, 1e3, 1e9, 1e300, std::numeric_limits<double>::infinity()}) {
    AnySettings settings = focused(false);
    settings.focus.magnification = magnification;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    AnyCuller plain(street.hierarchy, street.bounds, street.occluders, without);
    for (const View& view : street.views) {
      culler.cull(view);
      plain.cull(view);
      for (const ObjectId object : culler.visible()) {
        EXPECT_TRUE(isKept(plain, object)) << magnification;
      }
    }
  }
}

TEST(FocusedCuller, HidesObjectsInTheFirstFrameAndInOrthographicViews) {
  std::uint64_t hidden_first = 0, hidden_orthographic = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Street street(seed);
    AnyCuller first(street.hierarchy, street.bounds, street.occluders, focused(false));
    first.cull(street.views[0]);
    hidden_first += first.statistic("map", "focus_hidden");
    AnyCuller orthographic(street.hierarchy, street.bounds, street.occluders, focused(false));
    for (View view : street.views) {
      view.orthographic = true;
      for (const double height : {6.0, 20.0, 60.0}) {
        view.ortho_height = height;
        orthographic.cull(view);
        hidden_orthographic += orthographic.statistic("map", "focus_hidden");
      }
    }
  }
  EXPECT_GT(hidden_first, 0u);
  EXPECT_GT(hidden_orthographic, 0u);
}

// Boxes that move are tested by the windows too.
TEST(FocusedCuller, HidesMovingBoxesWhereItHidesObjects) {
  const Street street(3);
  AnySettings settings = focused(false);
  AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
  settings.focus.windows = 0;
  AnyCuller without(street.hierarchy, street.bounds, street.occluders, settings);
  std::size_t by_windows = 0;
  for (const View& view : street.views) {
    culler.cull(view, street.bounds);
    without.cull(view, street.bounds);
    for (std::size_t i = 0; i < street.bounds.size(); ++i) {
      if (culler.dynamicStates()[i] == Visibility::kHidden &&
          without.dynamicStates()[i] != Visibility::kHidden) {
        ++by_windows;
        EXPECT_FALSE(i >= street.first_small && seen(street, i, view)) << i;
      }
    }
  }
  EXPECT_GT(by_windows, 0u);
}

TEST(FocusedCuller, GivesTheSameAnswersWithThreads) {
  const Street street(4);
  AnyCuller serial(street.hierarchy, street.bounds, street.occluders, focused(true));
  AnyCuller threaded(street.hierarchy, street.bounds, street.occluders, focused(true));
  threaded.setParallelFor([](std::uint32_t count, const RangeBody& body) {
    std::vector<std::thread> threads;
    for (std::uint32_t i = 0; i < count; ++i) {
      threads.emplace_back([&body, i] { body(i, i + 1); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
  });
  std::uint64_t windows = 0;
  for (int round = 0; round < 3; ++round) {
    for (const View& view : street.views) {
      serial.cull(view);
      threaded.cull(view);
      windows += serial.statistic("map", "focused");
      EXPECT_TRUE(std::ranges::equal(serial.visible(), threaded.visible()));
      EXPECT_EQ(serial.statistic("map", "focused"), threaded.statistic("map", "focused"));
    }
  }
  EXPECT_GT(windows, 0u);
}

TEST(FocusedCuller, DrawsMoreOccludersThanTheFirstBufferHas) {
  std::uint64_t hidden[2] = {};
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Street street(seed);
    for (const bool more : {false, true}) {
      AnySettings settings = focused(false);
      settings.occluder_count = 4;
      settings.focus.occluder_count = more ? 64 : 0;
      AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
      for (const View& view : street.views) {
        culler.cull(view);
        hidden[more ? 1 : 0] += culler.statistic("map", "focus_hidden");
      }
    }
  }
  EXPECT_GT(hidden[1], hidden[0]);
}

// A box whose image ends within a pixel of a wall's edge is hidden by a window alone, and only if the wall is
// drawn there. Its neighbour shows by a thousandth of a pixel.
void expectTheWallHidesInWindows(const test::OraclePolygon& wall, bool moves) {
  const EdgeScene scene;
  const std::vector<Box> bounds{test::boundsOf(wall), scene.boxBetween(159.8, 160.2, 90.2, 90.8),
                                scene.boxBetween(160.1, 160.501, 92.2, 92.8)};
  const Hierarchy hierarchy = buildHierarchy(bounds, {});
  const SurfaceSet surfaces = test::surfacesOf({&wall, 1});
  const MovingSurfaces moving{.surfaces = &surfaces};
  const OccluderSet none;
  for (const std::uint32_t windows : {0u, 2u}) {
    AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.windows = windows, .worth = 1e9}};
    settings.surfaces = SurfaceUse::kAlone;
    AnyCuller culler(hierarchy, bounds, none, settings, {.surfaces = moves ? nullptr : &surfaces});
    culler.cull(scene.view, {}, nullptr, {&moving, moves ? 1u : 0u});
    EXPECT_EQ(isKept(culler, ObjectId(1u)), windows == 0);
    EXPECT_TRUE(isKept(culler, ObjectId(2u)));
  }
}

TEST(FocusedCuller, DrawsTheSurfacesOfWhatTheViewKeepsInWindows) {
  expectTheWallHidesInWindows(EdgeScene().wallBetween(-100.0, 160.5), false);
}

// The wall has no rectangle in the view.
TEST(FocusedCuller, DrawsTheSurfacesOfWhatReachesTheNearPlaneInWindows) {
  expectTheWallHidesInWindows(EdgeScene().wallPastTheEye(160.5), false);
}

TEST(FocusedCuller, DrawsSurfacesThatMoveInWindows) {
  expectTheWallHidesInWindows(EdgeScene().wallBetween(-100.0, 160.5), true);
}

const demo_frames::DemoScene& boxCity() {
  static const demo_frames::DemoScene kCity(makeBoxCity({500, 2500, 1}));
  return kCity;
}

std::vector<View> smoothFrames(std::size_t first, std::size_t count) {
  for (const CameraPath& path : boxCity().scene.paths) {
    if (path.name == "smooth") {
      return boxCity().frames(path, first, count);
    }
  }
  return {};
}

AnySettings focusedCity(double magnification, SurfaceUse surfaces) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.worth = 1e9}};
  settings.focus.magnification = magnification;
  settings.surfaces = surfaces;
  settings.temporal_coherence = false;
  return settings;
}

AnyCuller cityCuller(const AnySettings& settings) {
  static const SurfaceSet kSurfaces = findSurfaces(boxCity().scene.view());
  return AnyCuller(boxCity().bvh, boxCity().bounds, boxCity().occluders, settings, {.surfaces = &kSurfaces});
}

class FocusedCity : public ::testing::TestWithParam<SurfaceUse> {};
INSTANTIATE_TEST_SUITE_P(All, FocusedCity, ::testing::Values(SurfaceUse::kNone, SurfaceUse::kAlone));

TEST_P(FocusedCity, KeepsASubsetOfWhatIsKeptWithoutAWindow) {
  std::size_t fewer = 0;
  for (const std::size_t place : {0u, 100u, 200u, 300u}) {
    AnyCuller with = cityCuller(focusedCity(8.0, GetParam()));
    AnyCuller without = cityCuller(focusedCity(1.0, GetParam()));
    std::size_t frame = place;
    for (const View& view : smoothFrames(place, 20)) {
      with.cull(view);
      without.cull(view);
      for (const ObjectId object : with.visible()) {
        EXPECT_TRUE(isKept(without, object)) << "frame " << frame << ", object " << object.value;
      }
      fewer += with.visible().size() < without.visible().size() ? 1 : 0;
      ++frame;
    }
  }
  EXPECT_GT(fewer, 0u);
}

TEST_P(FocusedCity, CullsNothingThatIsSeen) {
  const ExactVisibility exact(boxCity().scene.view());
  AnyCuller culler = cityCuller(focusedCity(8.0, GetParam()));
  AnyCuller frustum = boxCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  std::size_t seen = 0, culled = 0, focused_frames = 0;
  std::size_t frame = 0;
  for (const View& view : smoothFrames(0, 20)) {
    culler.cull(view);
    frustum.cull(view);
    focused_frames += culler.statistic("map", "focused");
    std::vector<ObjectId> hidden;
    for (const ObjectId object : frustum.visible()) {
      if (!isKept(culler, object)) {
        hidden.push_back(object);
      }
    }
    culled += hidden.size();
    const kept_objects::Sightings sightings =
        kept_objects::lookForCulled(exact, view, {.width = 320, .height = 180, .samples = 12}, hidden,
                                    [&](ObjectId object) { return isKept(culler, object); });
    seen += sightings.through_pixels;
    for (const SeenPoint& witness : sightings.though_culled) {
      ADD_FAILURE() << "frame " << frame << ", object " << witness.object.value << " is seen";
    }
    ++frame;
  }
  EXPECT_GT(focused_frames, 15u);
  EXPECT_GT(seen, 500u);
  EXPECT_GT(culled, 2000u);
}

}  // namespace
}  // namespace sightline::culling
