#include "src/culling/focus_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"
#include "tests/culling/demo_frames.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/solids.h"

namespace sightline::culling {
namespace {

using test::Random;

constexpr std::uint32_t kWidth = 320, kHeight = 180;
const FocusSettings kTen{.min_objects = 10};

View anyView(Random& random) {
  View view;
  view.eye = random.point(100.0);
  setOrientation(view, random.point(1.0), {0, 0, 1});
  view.tan_half_fovy = random.in(0.2, 1.2);
  view.near = random.in(0.05, 1.0);
  view.far = 500.0;
  if (random.in(0, 2) < 1) {
    view.shift_x = random.in(-0.5, 0.5);
    view.shift_y = random.in(-0.5, 0.5);
  }
  return view;
}

// Returns the view turned to the left by an angle in degrees.
View turned(View view, double degrees) {
  const double t = degrees * std::numbers::pi / 180.0;
  setOrientation(view, view.forward * std::cos(t) - view.right * std::sin(t), view.up);
  return view;
}

// Returns the direction through a point of the depth buffer.
Vec3d rayThrough(const View& view, double x, double y) {
  const PixelView buffer(view, kWidth, kHeight);
  return view.forward + view.right * ((x - buffer.middle_x) / buffer.scale_x) +
         view.up * ((y - buffer.middle_y) / buffer.scale_y);
}

// Whether the direction is in the window. margin: a fraction of the window's half size.
bool shows(const View& window, const Vec3d& ray, double margin) {
  const double depth = dot(window.forward, ray);
  const double x = dot(window.right, ray) / depth, y = dot(window.up, ray) / depth;
  return depth > 0.0 && std::abs(x) <= (1.0 + margin) * window.tan_half_fovy * window.aspect &&
         std::abs(y) <= (1.0 + margin) * window.tan_half_fovy;
}

TEST(FocusWindow, ShowsWhereTheObjectsWereAdded) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    FocusWindow window(kTen, kWidth, kHeight);
    const View view = anyView(random);
    window.begin(view, false);
    EXPECT_FALSE(window.found());
    const auto x = static_cast<std::uint32_t>(random.in(0, kWidth)),
               y = static_cast<std::uint32_t>(random.in(0, kHeight));
    window.add(x, y, 6);
    window.add(x, y, 5);
    window.add(kWidth - 1 - x, kHeight - 1 - y, 4);
    window.begin(view, true);
    ASSERT_TRUE(window.found()) << x << " " << y;
    EXPECT_TRUE(shows(window.view(), rayThrough(view, x + 0.5, y + 0.5), 0.1)) << x << " " << y;
    EXPECT_EQ(window.view().eye, view.eye);
    EXPECT_GE(window.view().near, view.near);
    EXPECT_LT(window.view().tan_half_fovy, view.tan_half_fovy);
  }
}

TEST(FocusWindow, StaysWithItsDirectionWhenTheViewTurns) {
  Random random(2);
  for (const double degrees : {-25.0, -5.0, 5.0, 25.0}) {
    FocusWindow window(kTen, kWidth, kHeight);
    const View view = anyView(random);
    window.begin(view, false);
    window.add(100, 90, 50);
    window.begin(turned(view, degrees), true);
    ASSERT_TRUE(window.found());
    EXPECT_TRUE(shows(window.view(), rayThrough(view, 100.5, 90.5), 0.1)) << degrees;
  }
}

// Geometry in front of the view's near plane is not drawn, so it must hide nothing in the window either.
TEST(FocusWindow, LiesBeyondTheViewsNearPlane) {
  Random random(3);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    FocusWindow window({.magnification = random.in(1.5, 20.0), .min_objects = 1}, kWidth, kHeight);
    const View view = anyView(random);
    window.begin(view, false);
    window.add(static_cast<std::uint32_t>(random.in(0, kWidth)),
               static_cast<std::uint32_t>(random.in(0, kHeight)), 1);
    const View now = turned(view, random.in(-50, 50));
    window.begin(now, true);
    if (!window.found()) {
      continue;
    }
    ++found;
    const View& w = window.view();
    for (int k = 0; k < 20; ++k) {
      const double x = k < 4 ? 2.0 * (k & 1) - 1.0 : random.in(-1, 1);
      const double y = k < 4 ? 1.0 * (k & 2) - 1.0 : random.in(-1, 1);
      const Vec3d point =
          (w.forward + w.right * (x * w.tan_half_fovy * w.aspect) + w.up * (y * w.tan_half_fovy)) * w.near;
      EXPECT_GE(dot(now.forward, point), now.near) << "turn " << i;
    }
    EXPECT_GT(w.far, w.near);
  }
  EXPECT_GT(found, 100);
}

bool isFound(const FocusSettings& settings, const View& last, const View& view, bool after_last,
             std::uint32_t objects) {
  FocusWindow window(settings, kWidth, kHeight);
  window.begin(last, false);
  window.add(160, 90, objects);
  window.begin(view, after_last);
  return window.found();
}

TEST(FocusWindow, IsNotFoundWithoutObjectsOrALastViewOrPerspective) {
  Random random(4);
  const View view = anyView(random);
  EXPECT_TRUE(isFound(kTen, view, view, true, 10));
  EXPECT_FALSE(isFound(kTen, view, view, true, 9));
  EXPECT_FALSE(isFound(kTen, view, view, false, 10));
  View orthographic = view;
  orthographic.orthographic = true;
  EXPECT_FALSE(isFound(kTen, orthographic, orthographic, true, 10));
  EXPECT_FALSE(isFound(kTen, view, orthographic, true, 10));
}

TEST(FocusWindow, ForgetsTheObjectsOfEarlierViews) {
  Random random(5);
  const View view = anyView(random);
  FocusWindow window(kTen, kWidth, kHeight);
  window.begin(view, false);
  window.add(160, 90, 100);
  window.begin(view, true);
  ASSERT_TRUE(window.found());
  window.begin(view, true);
  EXPECT_FALSE(window.found());
}

TEST(FocusWindow, IsNotFoundAtAbsurdMagnifications) {
  Random random(6);
  const View view = anyView(random);
  for (const double magnification : {1e9, 1e300, std::numeric_limits<double>::infinity(), 1e-300}) {
    for (const std::uint32_t least : {0u, 10u}) {
      const FocusSettings settings{.magnification = magnification, .min_objects = least};
      EXPECT_FALSE(isFound(settings, view, view, true, 100)) << magnification;
    }
  }
}

TEST(FocusWindow, IsNotFoundFarOffTheViewingDirection) {
  Random random(7);
  View view = anyView(random);
  view.tan_half_fovy = 0.5;
  view.shift_x = view.shift_y = 0.0;
  for (const double degrees : {0.0, 40.0, 70.0, 80.0}) {
    EXPECT_TRUE(isFound(kTen, view, turned(view, degrees), true, 100)) << degrees;
    EXPECT_TRUE(isFound(kTen, view, turned(view, -degrees), true, 100)) << degrees;
  }
  for (const double degrees : {85.0, 90.0, 120.0, 180.0}) {
    EXPECT_FALSE(isFound(kTen, view, turned(view, degrees), true, 100)) << degrees;
    EXPECT_FALSE(isFound(kTen, view, turned(view, -degrees), true, 100)) << degrees;
  }
}

TEST(FocusWindow, MayShowEachBoxThatHasAPointInIt) {
  Random random(8);
  int inside = 0, none = 0;
  for (int i = 0; i < 3000; ++i) {
    FocusWindow window(kTen, kWidth, kHeight);
    const View view = anyView(random);
    window.begin(view, false);
    window.add(static_cast<std::uint32_t>(random.in(40, 280)), static_cast<std::uint32_t>(random.in(40, 140)),
               100);
    window.begin(view, true);
    ASSERT_TRUE(window.found());
    const Vec3d middle =
        view.eye + window.view().forward * random.in(-5, 50) + random.point(random.in(0.1, 10.0));
    const Vec3d half = abs(random.point(random.in(0.01, 8.0)));
    const Box box{Vec3f(middle - half), Vec3f(middle + half)};
    bool point_inside = false;
    for (int k = 0; k < 60 && !point_inside; ++k) {
      Vec3d point;
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = random.in(box.min[axis], box.max[axis]);
      }
      point_inside = test::insideView(window.view(), point);
    }
    inside += point_inside ? 1 : 0;
    none += window.mayShow(box) ? 0 : 1;
    EXPECT_TRUE(!point_inside || window.mayShow(box)) << "turn " << i;
  }
  EXPECT_GT(inside, 300);
  EXPECT_GT(none, 300);
}

// A street with blocks along it, walls that cross the near plane, and small boxes at its far end, all
// objects.
struct Street {
  std::vector<test::OraclePolygon> polygons;
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
    occluders = makeOccluders(input);
    hierarchy = buildHierarchy(bounds, {});
    for (int frame = 0; frame < 6; ++frame) {
      View view = test::viewFrom({random.in(-0.2, 0.2), random.in(-0.2, 0.2), -0.3 * frame},
                                 {random.in(-0.1, 0.1), random.in(-0.05, 0.05), -1.0});
      view.near = 1.0;
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

bool kept(const AnyCuller& culler, std::size_t object) {
  return std::binary_search(culler.visible().begin(), culler.visible().end(), ObjectId(object));
}

AnySettings focused(bool coherent) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.min_objects = 0}};
  settings.raster = {.width = 96, .height = 96};  // coarse, so that it leaks
  settings.temporal_coherence = coherent;
  return settings;
}

TEST(FocusedCuller, CullsNothingThatARayReachesThoughWallsCrossTheNearPlane) {
  std::size_t focused_frames = 0, judged = 0, more = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
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
        if (kept(culler, i)) {
          continue;
        }
        ++judged;
        more += kept(without, i) ? 1 : 0;
        std::mt19937_64 random(i);
        // The polygons of an occluding object would block rays to itself.
        const std::span<const test::OraclePolygon> polygons(street.polygons);
        const test::Sight sight = i < street.first_small ? test::Sight{}
                                                         : test::lookAt(street.bounds[i], view, polygons,
                                                                        kept(without, i) ? 400 : 20, random);
        EXPECT_FALSE(sight.seen) << "seed " << seed << ", frame " << frame << ", object " << i << " at "
                                 << sight.point.x << " " << sight.point.y << " " << sight.point.z;
      }
    }
  }
  EXPECT_GT(focused_frames, 60u);
  EXPECT_GT(judged, 5'000u);
  EXPECT_GT(more, 40u) << "hidden by the window's map alone";
}

TEST(FocusedCuller, HasNoWindowInTheFirstFrameAfterAJumpInOrthographicViewsOrWithoutMagnification) {
  const Street street(3);
  const View view = street.views[0];
  AnyCuller culler(street.hierarchy, street.bounds, street.occluders, focused(false));
  culler.cull(view);
  EXPECT_EQ(culler.statistic("map", "focused"), 0u);
  culler.cull(view);
  EXPECT_EQ(culler.statistic("map", "focused"), 1u);
  culler.cull(turned(view, 70.0));
  EXPECT_EQ(culler.statistic("map", "focused"), 0u) << "a jump";
  culler.cull(view);
  culler.cull(view);
  EXPECT_EQ(culler.statistic("map", "focused"), 1u);
  culler.reset();
  culler.cull(view);
  EXPECT_EQ(culler.statistic("map", "focused"), 0u) << "after reset()";
  View orthographic = view;
  orthographic.orthographic = true;
  for (int frame = 0; frame < 3; ++frame) {
    culler.cull(orthographic);
    EXPECT_EQ(culler.statistic("map", "focused"), 0u);
  }
  for (const double magnification : {1.0, 0.5, 0.0, -3.0, 1e9, 1e300, std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN()}) {
    AnySettings settings = focused(false);
    settings.focus.magnification = magnification;
    AnyCuller other(street.hierarchy, street.bounds, street.occluders, settings);
    for (int frame = 0; frame < 3; ++frame) {
      other.cull(view);
      EXPECT_EQ(other.statistic("map", "focused"), 0u) << magnification;
    }
  }
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

AnySettings focusedCity(double magnification) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.min_objects = 0}};
  settings.focus.magnification = magnification;
  settings.temporal_coherence = false;
  return settings;
}

TEST(FocusedCuller, KeepsASubsetOfWhatIsKeptWithoutAWindow) {
  std::size_t fewer = 0;
  for (const std::size_t place : {0u, 100u, 200u, 300u}) {
    AnyCuller with = boxCity().culler(HierarchyKind::kBvh, focusedCity(8.0));
    AnyCuller without = boxCity().culler(HierarchyKind::kBvh, focusedCity(1.0));
    std::size_t frame = place;
    for (const View& view : smoothFrames(place, 20)) {
      with.cull(view);
      without.cull(view);
      for (const ObjectId object : with.visible()) {
        EXPECT_TRUE(kept(without, object.value)) << "frame " << frame << ", object " << object.value;
      }
      fewer += with.visible().size() < without.visible().size() ? 1 : 0;
      ++frame;
    }
  }
  EXPECT_GT(fewer, 0u);
}

TEST(FocusedCuller, CullsNothingThatIsSeenInTheBoxCity) {
  const ExactVisibility exact(boxCity().scene.view());
  AnyCuller culler = boxCity().culler(HierarchyKind::kBvh, focusedCity(8.0));
  AnyCuller frustum = boxCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  std::size_t seen = 0, culled = 0, focused_frames = 0;
  std::size_t frame = 0;
  for (const View& view : smoothFrames(0, 20)) {
    culler.cull(view);
    frustum.cull(view);
    focused_frames += culler.statistic("map", "focused");
    std::vector<ObjectId> hidden;
    for (const ObjectId object : frustum.visible()) {
      if (!kept(culler, object.value)) {
        hidden.push_back(object);
      }
    }
    culled += hidden.size();
    std::vector<Witness> witnesses = exact.visibleThroughPixels(view, 320, 180);
    seen += witnesses.size();
    const std::vector<Witness> aimed = exact.visibleByAimedRays(view, hidden, 12);
    witnesses.insert(witnesses.end(), aimed.begin(), aimed.end());
    for (const Witness& witness : witnesses) {
      if (!kept(culler, witness.object.value)) {
        EXPECT_FALSE(exact.confirm(view, witness))
            << "frame " << frame << ", object " << witness.object.value;
      }
    }
    ++frame;
  }
  EXPECT_GT(focused_frames, 15u);
  EXPECT_GT(seen, 500u);
  EXPECT_GT(culled, 2000u);
}

}  // namespace
}  // namespace sightline::culling
