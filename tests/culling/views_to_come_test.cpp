// Culling several views at once: what is planned for, and what is kept in the frames that hold an answer.

#include "src/culling/views_to_come.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/detail_objects.h"
#include "sightline/culling/frustum_method.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/culling/opacity_map_method.h"
#include "sightline/culling/while_it_pays.h"
#include "src/scene/usable_view.h"
#include "tests/culling/demo_frames.h"
#include "tests/culling/edge_scene.h"
#include "tests/culling/fake_sets.h"
#include "tests/culling/kept_objects.h"
#include "tests/culling/seen_though_culled.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using culling::ViewsToCome;
using demo_frames::DemoScene;
using kept_objects::isKept;

// A camera that moves and turns by the same each frame.
struct Motion {
  View view;
  Vec3d step;                 // scene space
  Vec3d axis{0.0, 0.0, 1.0};  // 1 long
  double angle = 0.0;         // radians a frame

  View next() {
    view.eye = view.eye + step;
    step = turned(step);
    setOrientation(view, turned(view.forward), turned(view.up));
    return view;
  }
  Vec3d turned(const Vec3d& v) const {
    return v * std::cos(angle) + cross(axis, v) * std::sin(angle) +
           axis * (dot(axis, v) * (1.0 - std::cos(angle)));
  }
};

Motion randomMotion(test::Random& random) {
  Motion motion;
  const double sizes[] = {0.01, 1.0, 1000.0};
  const double size = sizes[random.below(3)];
  View& view = motion.view;
  view.eye = random.point(random.below(2) == 0 ? 10.0 : 1e5) * size;
  setOrientation(view, random.point(1.0), random.point(1.0));
  view.tan_half_fovy = random.in(0.1, 1.2);
  view.aspect = random.in(0.5, 2.0);
  view.z_near = size * random.in(0.01, 1.0);
  view.z_far =
      random.below(4) == 0 ? std::numeric_limits<double>::infinity() : size * random.in(10.0, 1000.0);
  if (random.below(3) == 0) {
    view.shift_x = random.in(-0.9, 0.9);
    view.shift_y = random.in(-0.9, 0.9);
  }
  motion.step = random.point(random.below(4) == 0 ? 0.0 : random.in(0.0, 0.5)) * size;
  const Vec3d axis = random.point(1.0);
  motion.axis = length(axis) > 0.1 ? normalized(axis) : Vec3d(0, 0, 1);
  motion.angle = random.below(3) == 0 ? 0.0 : random.in(-0.05, 0.05);
  return motion;
}

// A view like this one: a little elsewhere, turned, wider or narrower, with another near plane.
View strayed(const View& view, const Motion& motion, test::Random& random) {
  View other = view;
  const double most = random.below(2) == 0 ? 0.003 : 0.1;
  other.eye = other.eye + random.point(most) * length(motion.step);
  setOrientation(other, view.forward + random.point(most), view.up + random.point(most));
  other.tan_half_fovy *= 1.0 + random.in(-most, most);
  other.aspect *= 1.0 + random.in(-most, most);
  other.z_near *= 1.0 + random.in(-most, most);
  other.z_far *= 1.0 + random.in(-most, most);
  return other;
}

// A corner of the view's volume, or a point of it; at most so far away.
Vec3d pointOf(const View& view, test::Random& random, double farthest) {
  const auto side = [&] {
    const std::uint32_t kind = random.below(3);
    return kind == 0 ? -1.0 : kind == 1 ? 1.0 : random.in(-1.0, 1.0);
  };
  const double far = std::min(view.z_far, farthest);
  const std::uint32_t kind = random.below(3);
  const double depth = kind == 0 ? view.z_near : kind == 1 ? far : random.in(view.z_near, far);
  return view.eye +
         (view.forward + view.right * ((view.shift_x + side()) * view.tan_half_fovy * view.aspect) +
          view.up * ((view.shift_y + side()) * view.tan_half_fovy)) *
             depth;
}

// By this test's own arithmetic, up to the rounding of coordinates so far from the origin.
bool inVolume(const View& view, const Vec3d& point) {
  const Vec3d v = point - view.eye;
  const double x = dot(v, view.right), y = dot(v, view.up), z = dot(v, view.forward);
  const double rounding = 1e-12 * (length(v) + length(view.eye));
  const double width = view.tan_half_fovy * view.aspect, height = view.tan_half_fovy;
  return z >= view.z_near - rounding && z <= view.z_far + rounding &&
         std::abs(x - view.shift_x * width * z) <= width * z + rounding * (1.0 + width) &&
         std::abs(y - view.shift_y * height * z) <= height * z + rounding * (1.0 + height);
}

// How far a point is from the segment between two others.
double distanceTo(const Vec3d& point, const Vec3d& from, const Vec3d& to) {
  double least = std::min(length(point - from), length(point - to));
  const Vec3d along = to - from;
  const double t = dot(point - from, along) / dot(along, along);
  if (t > 0.0 && t < 1.0) {
    least = std::min(least, length(point - from - along * t));
  }
  return least;
}

TEST(ViewsToCome, TheWideViewShowsAllOfEveryViewThatIsHeld) {
  std::size_t planned = 0, held = 0, refused = 0, points = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    test::Random random(seed);
    Motion motion = randomMotion(random);
    ViewsToCome views(2 + random.below(15));
    views.see(motion.view);
    EXPECT_FALSE(views.plan()) << "seed " << seed;
    views.see(motion.next());
    if (!views.plan()) {
      continue;
    }
    ++planned;
    const View wide = views.wide();
    const ViewerRegion& viewers = views.viewers();
    ASSERT_TRUE(validate(wide).has_value()) << "seed " << seed;
    EXPECT_TRUE(views.contain(motion.view)) << "seed " << seed;
    View next = motion.view;
    for (int frame = 0; frame < 12; ++frame) {
      for (int n = 0; n < 6; ++n) {
        const View view = n == 0 ? next : strayed(next, motion, random);
        if (!views.contain(view)) {
          ++refused;
          continue;
        }
        ++held;
        const double size = length(view.eye) + length(wide.eye);
        EXPECT_LE(distanceTo(view.eye - wide.eye, viewers.offsets[0], viewers.offsets[1]),
                  viewers.radius + 1e-12 * size)
            << "seed " << seed;
        EXPECT_LE(nearDistance(view), viewers.near_distance) << "seed " << seed;
        for (int k = 0; k < 12; ++k) {
          const Vec3d point = pointOf(view, random, 1e5 * view.z_near);
          ++points;
          EXPECT_TRUE(inVolume(wide, point)) << "seed " << seed << ", frame " << frame << ", view " << n;
        }
      }
      next = motion.next();
    }
  }
  EXPECT_GT(planned, 700u);
  EXPECT_GT(held, 10'000u);
  EXPECT_GT(refused, 10'000u);
  EXPECT_GT(points, 100'000u);
}

// What is beside all that was planned for is not contained, however little.
TEST(ViewsToCome, ViewsThatLeaveWhatWasPlannedAreNotContained) {
  test::Random random(5);
  std::size_t planned = 0;
  for (int n = 0; n < 300; ++n) {
    Motion motion = randomMotion(random);
    ViewsToCome views(8);
    views.see(motion.view);
    views.see(motion.next());
    if (!views.plan()) {
      continue;
    }
    ++planned;
    const View& at = motion.view;
    const double path = length(views.viewers().offsets[1] - views.viewers().offsets[0]);
    std::vector<View> others(8, at);
    others[0].eye = at.eye + at.right * (path + 2.0 * views.viewers().radius + 1e-6);
    others[1].eye = at.eye - at.forward * (path + 2.0 * views.viewers().radius + 1e-6);
    setOrientation(others[2], -at.forward, at.up);
    setOrientation(others[3], at.right, at.up);
    others[4].tan_half_fovy *= 3.0;
    others[5].z_near *= 1.5;
    others[6].z_far = 2.0 * at.z_far + 10.0 * path;
    others[7].orthographic = true;
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (i != 6 || std::isfinite(at.z_far)) {
        EXPECT_FALSE(views.contain(others[i])) << "motion " << n << ", view " << i;
      }
    }
  }
  EXPECT_GT(planned, 100u);
}

// A view from the eye of another one, that shows what a wide view does but for this slope at each border. Its
// axes are not quite at right angles, as those of a caller in single precision.
View narrowerBy(double slope, const View& wide, const View& from, double skew) {
  View view = wide;
  view.eye = from.eye;
  view.z_near = 0.97 * from.z_near;
  view.z_far = 0.97 * from.z_far;
  view.right = normalized(wide.right + wide.forward * skew);
  view.up = normalized(wide.up + wide.forward * skew);
  const double height = wide.tan_half_fovy, width = height * wide.aspect;
  view.tan_half_fovy = height - slope;
  view.aspect = (width - slope) / (height - slope);
  view.shift_x = wide.shift_x * width / (width - slope);
  view.shift_y = wide.shift_y * height / (height - slope);
  return view;
}

// With skewed axes, the borders of the picture are not where right and up point: they follow from
// clipFromScene().
TEST(ViewsToCome, TheWideViewShowsAllOfViewsWhoseAxesAreNotQuiteAtRightAngles) {
  std::size_t contained = 0, outside = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    test::Random random(seed);
    Motion motion = randomMotion(random);
    ViewsToCome views(8);
    views.see(motion.view);
    views.see(motion.next());
    if (!views.plan()) {
      continue;
    }
    const View& wide = views.wide();
    for (const double slope : {0.0, 1e-8, 1e-7, 4e-7, 1e-5, 1e-3, 4e-3}) {
      const View view = narrowerBy(slope, wide, motion.view, random.below(2) == 0 ? 0.9e-6 : -0.9e-6);
      const Vec3d across = cross(view.up, view.forward);
      const double volume = dot(view.right, across);
      const Vec3d x = across / volume, y = cross(view.forward, view.right) / volume,
                  z = cross(view.right, view.up) / volume;
      bool all_inside = true;
      for (const double side_x : {-1.0, 1.0}) {
        for (const double side_y : {-1.0, 1.0}) {
          const Vec3d ray = z + x * ((view.shift_x + side_x) * view.tan_half_fovy * view.aspect) +
                            y * ((view.shift_y + side_y) * view.tan_half_fovy);
          // Far away, the way from one eye to the other is nothing.
          const double right = dot(ray, wide.right), up = dot(ray, wide.up), depth = dot(ray, wide.forward);
          const double height = wide.tan_half_fovy, width = height * wide.aspect;
          all_inside = all_inside && std::abs(right / depth - wide.shift_x * width) <= width &&
                       std::abs(up / depth - wide.shift_y * height) <= height;
        }
      }
      const bool held = views.contain(view);
      EXPECT_TRUE(!held || all_inside) << "seed " << seed << ", slope " << slope;
      contained += held ? 1 : 0;
      outside += all_inside ? 0 : 1;
    }
  }
  EXPECT_GT(contained, 100u);
  EXPECT_GT(outside, 100u);
}

// How many frames hold what was planned in one, if the camera goes on as it did.
std::size_t framesHeld(ViewsToCome& views, Motion motion) {
  std::size_t held = 0;
  for (; held < 100; ++held) {
    views.see(motion.next());
    if (!views.takeHeld()) {
      break;
    }
  }
  return held;
}

View plainView() {
  View view;
  setOrientation(view, {1, 0, 0}, {0, 0, 1});
  return view;
}

TEST(ViewsToCome, NothingIsPlannedForWhatCannotBeFollowed) {
  Motion motion{.view = plainView(), .step = {0.1, 0, 0}};
  ViewsToCome one(1), views(8);
  for (int frame = 0; frame < 4; ++frame) {
    one.see(motion.view);
    EXPECT_FALSE(one.plan());
    views.see(motion.next());
    EXPECT_EQ(views.plan(), frame > 0);
  }
  // The camera turns by more than 30 degrees.
  const View before = motion.view;
  for (const Vec3d& forward : {Vec3d(1, 1, 0), Vec3d(0, 1, 0), Vec3d(-1, 0, 0), Vec3d(-1, -0.01, 0)}) {
    View turned = before;
    setOrientation(turned, forward, {0, 0, 1});
    views.see(before);
    views.see(turned);
    EXPECT_FALSE(views.plan()) << forward.x << ' ' << forward.y;
  }
  // Either view is orthographic.
  for (const bool last : {false, true}) {
    View first = before, second = before;
    (last ? first : second).orthographic = true;
    views.see(first);
    views.see(second);
    EXPECT_FALSE(views.plan()) << last;
  }
  views.see(before);
  views.see(before);
  EXPECT_TRUE(views.plan());
  EXPECT_TRUE(views.takeHeld());
  views.forget();
  EXPECT_FALSE(views.takeHeld());
  views.see(before);
  EXPECT_FALSE(views.plan()) << "there was no frame before";
}

TEST(ViewsToCome, AnAnswerIsHeldForAtMostAsManyFramesAsWereAskedFor) {
  for (const std::uint32_t most : {2u, 3u, 8u, 16u, 1000u}) {
    for (const double step : {0.0, 0.01}) {
      Motion motion{.view = plainView(), .step = {0, step, 0}};
      ViewsToCome views(most);
      views.see(motion.view);
      views.see(motion.next());
      ASSERT_TRUE(views.plan());
      // One of them is the frame that was planned in.
      EXPECT_EQ(framesHeld(views, motion), std::min(most, 16u) - 1) << most << ", " << step;
      EXPECT_FALSE(views.takeHeld());
    }
  }
  // Also if the camera comes back.
  ViewsToCome views(4);
  views.see(plainView());
  views.see(plainView());
  ASSERT_TRUE(views.plan());
  EXPECT_TRUE(views.takeHeld());
  views.end();
  EXPECT_FALSE(views.takeHeld());
}

TEST(ViewsToCome, TheNearerThingsAreAndTheFasterTheCameraTheFewerViewsArePlanned) {
  constexpr std::uint32_t kWidth = 320, kHeight = 180;
  const auto held = [&](double depth, double step) {
    const std::vector<float> buffer(kWidth * kHeight, static_cast<float>(1.0 / depth));
    Motion motion{.view = plainView(), .step = {0, step, 0}};
    ViewsToCome views(16);
    views.see(motion.view);
    views.measure(motion.view, {buffer, kWidth, kHeight, kWidth});
    views.see(motion.next());
    return views.plan() ? framesHeld(views, motion) + 1 : 0;
  };
  // A metre at 10 metres is 0.1 / tan_half_fovy * 90 = 18 pixels. At 0.05 metres a frame that is 0.9 pixels.
  const std::size_t slow = held(10.0, 0.05);
  EXPECT_GE(slow, 4u);
  EXPECT_LT(slow, 16u);
  EXPECT_EQ(held(20.0, 0.1), slow);
  EXPECT_NEAR(static_cast<double>(held(10.0, 0.1)), 0.5 * static_cast<double>(slow), 1.0);
  EXPECT_NEAR(static_cast<double>(held(5.0, 0.05)), 0.5 * static_cast<double>(slow), 1.0);
  EXPECT_EQ(held(10.0, 10.0), 0u);
  EXPECT_EQ(held(0.1, 0.5), 0u);
  EXPECT_EQ(held(1e6, 0.05), 16u);
}

// A demo scene and what rays see of it.
class SeenScene {
 public:
  explicit SeenScene(const DemoScene& of) : demo(of), exact(of.scene.view()) {}

  CullingScene culled() const {
    return {.hierarchy = &demo.bvh,
            .object_bounds = demo.bounds,
            .object_boxes = &demo.objectBoxes(),
            .occluders = &demo.occluders,
            .surfaces = &demo.surfaces()};
  }
  Culler culler(std::uint32_t views_at_once, DepthPyramidMethodSettings settings = kAll) const {
    return Culler(culled(), depthPyramid(settings), {.views_at_once = views_at_once});
  }

  static constexpr DepthPyramidMethodSettings kAll{
      .surfaces = SurfaceUse::kAlone,
      .drawing = {.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0}};
  const DemoScene& demo;
  ExactVisibility exact;
};

const SeenScene& seenCity() {
  static const SeenScene kCity(demo_frames::smallCity());
  return kCity;
}
const SeenScene& seenBuilding() {
  static const SeenScene kBuilding(demo_frames::smallBuilding());
  return kBuilding;
}

// A walk that follows a path of the scene, stands still, turns, zooms, jumps and goes back.
std::vector<View> wander(const SeenScene& seen, std::uint64_t seed, std::size_t count) {
  test::Random random(seed);
  std::vector<View> views;
  while (views.size() < count) {
    const std::vector<CameraPath>& paths = seen.demo.scene.paths;
    const CameraPath& path = paths[random.below(static_cast<std::uint32_t>(paths.size()))];
    std::size_t frame = random.below(static_cast<std::uint32_t>(path.frames.size()));
    Motion motion{.view = path.view(frame, seen.demo.scene.origin)};
    const std::uint32_t kind = random.below(4);
    motion.step = kind == 0 ? Vec3d() : motion.view.forward * random.in(-0.1, 0.1) + random.point(0.05);
    motion.angle = kind == 1 ? 0.0 : random.in(-0.03, 0.03);
    for (std::uint32_t i = 4 + random.below(20); i > 0; --i) {
      if (kind == 3 && frame + 1 < path.frames.size()) {
        motion.view = path.view(++frame, seen.demo.scene.origin);
      } else {
        motion.next();
      }
      if (random.below(20) == 0) {
        motion.view.tan_half_fovy *= random.in(0.97, 1.03);
      }
      views.push_back(motion.view);
    }
  }
  views.resize(count);
  return views;
}

// Every object's box is given as a moving one too.
void expectWhatIsSeenIsKept(const SeenScene& seen, Culler& culler, std::span<const View> views,
                            const std::string& where) {
  std::size_t held = 0, hidden = 0, hidden_boxes = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    culler.cull(views[v], seen.demo.bounds);
    if (!culler.stats().held) {
      continue;
    }
    ++held;
    std::vector<ObjectId> culled;
    const Frustum frustum = frustumOf(views[v]);
    for (std::size_t o = 0; o < seen.demo.bounds.size(); ++o) {
      std::uint8_t cut = kAllFrustumPlanes;
      const bool outside = classify(frustum, seen.demo.bounds[o], cut) == FrustumSide::kOutside;
      const bool kept = isKept(culler, ObjectId(o));
      const bool box_kept = culler.dynamicStates()[o] != Visibility::kHidden;
      EXPECT_FALSE(outside && kept) << where << ", view " << v << ", object " << o;
      hidden += !outside && !kept ? 1 : 0;
      hidden_boxes += !outside && !box_kept ? 1 : 0;
      if (!outside && (!kept || !box_kept)) {
        culled.emplace_back(o);
      }
    }
    const auto is_kept = [&](ObjectId object) {
      return isKept(culler, object) && culler.dynamicStates()[object.value] != Visibility::kHidden;
    };
    const kept_objects::Sightings sightings =
        kept_objects::lookForCulled(seen.exact, views[v], {.samples = 4}, culled, is_kept);
    for (const SeenPoint& witness : sightings.though_culled) {
      ADD_FAILURE() << where << ", view " << v << ": object " << witness.object.value << " is seen at "
                    << witness.point.x << ' ' << witness.point.y << ' ' << witness.point.z;
    }
  }
  EXPECT_GT(held, views.size() / 4) << where;
  EXPECT_GT(hidden, held) << where;
  EXPECT_GT(hidden_boxes, held) << where;
}

TEST(ViewsAtOnce, WhatIsSeenIsKeptInFramesThatHoldAnAnswer) {
  for (const std::uint32_t count : {2u, 6u, 16u}) {
    Culler in_city = seenCity().culler(count), in_building = seenBuilding().culler(count);
    expectWhatIsSeenIsKept(seenCity(), in_city, wander(seenCity(), count, 120),
                           "city " + std::to_string(count));
    expectWhatIsSeenIsKept(seenBuilding(), in_building, wander(seenBuilding(), count, 120),
                           "building " + std::to_string(count));
  }
}

TEST(ViewsAtOnce, WhatIsSeenIsKeptWithFinerBuffersToo) {
  DepthPyramidMethodSettings settings = SeenScene::kAll;
  settings.raster = {.width = 64, .height = 36};
  settings.focus.worth = 1e9;
  Culler culler = seenCity().culler(6, settings);
  expectWhatIsSeenIsKept(seenCity(), culler, wander(seenCity(), 77, 120), "city, finer buffers");
}

// A box behind a wall, which ends less than a pixel beside it: a finer buffer alone hides the box, and only
// from where the camera begins. It comes out from behind the wall in frames that hold an answer.
TEST(ViewsAtOnce, AFinerBufferHidesOnlyWhatIsHiddenFromAllViewers) {
  constexpr double kBoxEnd = 160.1, kWallEnd = 160.9;
  const test::EdgeScene edge;
  const test::OraclePolygon wall = edge.wallBetween(-100.0, kWallEnd);
  const std::vector<Box> bounds{test::boundsOf(wall), edge.boxBetween(158.0, kBoxEnd, 90.2, 90.8)};
  const Hierarchy hierarchy = buildHierarchy(bounds, {});
  const SurfaceSet surfaces = test::surfacesOf({&wall, 1});
  const CullingScene scene{.hierarchy = &hierarchy, .object_bounds = bounds, .surfaces = &surfaces};
  DepthPyramidMethodSettings settings = SeenScene::kAll;
  settings.raster = {.width = test::EdgeScene::kWidth, .height = test::EdgeScene::kHeight};
  settings.focus = {.windows = 2, .worth = 1e9};
  Culler culler(scene, depthPyramid(settings), {.views_at_once = 8});
  // From here on the camera sees past the wall, metres to the right.
  const double box_x = edge.xAt(kBoxEnd, edge.kBoxDepth), wall_x = edge.xAt(kWallEnd, edge.kWallDepth);
  const double seen_from =
      (wall_x * edge.kBoxDepth - box_x * edge.kWallDepth) / (edge.kBoxDepth - edge.kWallDepth);
  std::size_t hidden_at_first = 0, held_and_seen = 0;
  for (int frame = 0; frame < 8; ++frame) {
    View view = edge.view;
    view.eye.x = 0.31 * seen_from * frame;
    culler.cull(view);
    const bool kept = isKept(culler, ObjectId(1u));
    hidden_at_first += frame == 0 && !kept ? 1 : 0;
    held_and_seen += culler.stats().held && view.eye.x > seen_from ? 1 : 0;
    EXPECT_TRUE(kept || view.eye.x < seen_from) << frame;
  }
  EXPECT_EQ(hidden_at_first, 1u);
  EXPECT_GT(held_and_seen, 2u);
}

// A camera at rest sees the same in all frames of an answer, and finds it again.
TEST(ViewsAtOnce, AtRestAllFramesKeepTheSameAndOnlyEveryNthIsCulled) {
  const View view = seenCity().demo.frames(seenCity().demo.scene.paths[0], 40, 1)[0];
  constexpr std::uint32_t kCount = 5;
  Culler culler = seenCity().culler(kCount);
  culler.cull(view);
  EXPECT_FALSE(culler.stats().held);
  std::vector<ObjectId> kept;
  for (std::uint32_t frame = 0; frame < 4 * kCount; ++frame) {
    culler.cull(view);
    const CullStats& stats = culler.stats();
    EXPECT_EQ(stats.held, frame % kCount != 0) << frame;
    if (stats.held) {
      EXPECT_TRUE(std::ranges::equal(culler.visible(), kept)) << frame;
      EXPECT_EQ(stats.nodes_tested + stats.objects_tested + stats.nodes_visited, 0u);
      for (const MethodStatistic& statistic : culler.statistics()) {
        EXPECT_EQ(statistic.value, 0u) << statistic.name;
      }
    } else {
      kept.assign(culler.visible().begin(), culler.visible().end());
      EXPECT_GT(stats.nodes_tested, 0u);
    }
  }
}

// Along a street, a step a frame.
std::vector<View> slowWalk(const SeenScene& seen, std::size_t count) {
  Motion motion{.view = seen.demo.frames(seen.demo.scene.paths[0], 40, 1)[0]};
  motion.step = motion.view.forward * 0.02;
  motion.angle = 0.002;
  std::vector<View> views;
  while (views.size() < count) {
    views.push_back(motion.next());
  }
  return views;
}

std::size_t heldFrames(Culler& culler, std::span<const View> views, const OccluderSet* moving = nullptr,
                       std::span<const MovingSurfaces> moving_surfaces = {}) {
  std::size_t held = 0;
  for (const View& view : views) {
    culler.cull(view, {}, moving, moving_surfaces);
    held += culler.stats().held ? 1 : 0;
  }
  return held;
}

TEST(ViewsAtOnce, OnlyWhatHidesForAllViewersIsHeld) {
  const SeenScene& seen = seenCity();
  const std::vector<View> views = slowWalk(seen, 24);
  Culler culler = seen.culler(8);
  EXPECT_GT(heldFrames(culler, views), 8u);
  const OccluderSet nothing;
  EXPECT_EQ(heldFrames(culler, views, &nothing), 0u);
  const MovingSurfaces none{};
  EXPECT_EQ(heldFrames(culler, views, nullptr, {&none, 1}), 0u);
  // In turns with frames that nothing moves in: there, what was planned before has ended.
  for (std::size_t v = 0; v < views.size(); ++v) {
    culler.cull(views[v], {}, v % 2 == 1 ? &nothing : nullptr);
    EXPECT_FALSE(culler.stats().held) << v;
  }
  Culler one_by_one = seen.culler(1);
  EXPECT_EQ(heldFrames(one_by_one, views), 0u);

  const auto heldWith = [&](std::unique_ptr<CullingMethod> method, bool sets = false) {
    fake_sets::FakeSets everything(seen.demo.bounds);
    CullingScene scene = seen.culled();
    scene.sets = sets ? &everything : nullptr;
    Culler other(scene, std::move(method), {.visible_sets = sets, .views_at_once = 8});
    return heldFrames(other, views);
  };
  EXPECT_GT(heldWith(depthPyramid()), 8u);
  EXPECT_EQ(heldWith(depthPyramid(), true), 0u);
  EXPECT_GT(heldWith(whileItPays(depthPyramid(), {.object_us = 1e6, .triangle_us = 1e6})), 8u);
  EXPECT_EQ(heldWith(detailObjects(depthPyramid())), 0u);
  EXPECT_EQ(heldWith(depthPyramid({.surfaces = SurfaceUse::kNone})), 0u);
  EXPECT_EQ(heldWith(depthPyramid({.surfaces = SurfaceUse::kWithOccluders})), 0u);
  EXPECT_EQ(heldWith(opacityMap({.surfaces = SurfaceUse::kAlone})), 0u);
  EXPECT_EQ(heldWith(occlusionTree({})), 0u);
  EXPECT_EQ(heldWith(frustumCulling()), 0u);
}

TEST(ViewsAtOnce, ViewsThatAreNotPlannedForAreCulledByThemselves) {
  const SeenScene& seen = seenCity();
  const View view = seen.demo.frames(seen.demo.scene.paths[0], 40, 1)[0];
  Culler culler = seen.culler(8);
  const auto startHolding = [&] {
    for (int frame = 0; frame < 3; ++frame) {
      culler.cull(view);
    }
    // Another frame would be held, or be the first of a new answer and the next one held.
    culler.cull(view);
    return culler.stats().held;
  };
  std::vector<View> others(4, view);
  others[0].eye = view.eye + view.right * 5.0;
  setOrientation(others[1], -view.forward, view.up);
  others[2].orthographic = true;
  others[3].tan_half_fovy = 1.9 * view.tan_half_fovy;
  for (std::size_t i = 0; i < others.size(); ++i) {
    culler.reset();
    EXPECT_TRUE(startHolding()) << i;
    culler.cull(others[i]);
    EXPECT_FALSE(culler.stats().held) << i;
  }
  // A view that is no view keeps everything, and ends what was planned.
  culler.reset();
  EXPECT_TRUE(startHolding());
  View none = view;
  none.tan_half_fovy = -1.0;
  culler.cull(none);
  EXPECT_FALSE(culler.stats().held);
  EXPECT_EQ(culler.visible().size(), seen.demo.bounds.size());
  culler.cull(view);
  EXPECT_FALSE(culler.stats().held);
}

// What hid half of the objects is gone.
TEST(ViewsAtOnce, ResetForgetsTheAnswer) {
  const SeenScene& seen = seenCity();
  const View view = seen.demo.frames(seen.demo.scene.paths[0], 40, 1)[0];
  Culler culler = seen.culler(8);
  for (int frame = 0; frame < 4; ++frame) {
    culler.cull(view);
  }
  ASSERT_TRUE(culler.stats().held);
  const std::size_t kept = culler.visible().size();
  const SurfaceSet nothing;
  CullingScene open = seen.culled();
  open.surfaces = &nothing;
  open.occluders = nullptr;
  culler.reset(open);
  for (int frame = 0; frame < 12; ++frame) {
    culler.cull(view);
    EXPECT_FALSE(frame < 1 && culler.stats().held);
    EXPECT_GT(culler.visible().size(), kept) << frame;
  }
}

}  // namespace
}  // namespace sightline
