#include "src/layers/extents/part_extents.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "tests/layers/extent_scene.h"

namespace sightline::layers::extent_tests {
namespace {

using Kind = ExtentAxis::Kind;
using Frame = ExtentAxis::Frame;
using shapes::Random;

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

std::vector<ExtentAxis> allKinds() {
  std::vector<ExtentAxis> axes = cameraExtents();
  axes.push_back({Kind::kSpatial, Frame::kWorld, {0, 2, 0}, {}});
  axes.push_back({Kind::kSpatial, Frame::kWorld, {1, -3, 2}, {}});
  axes.push_back({Kind::kAngular, Frame::kWorld, {0, 0, 5}, {3, 0, 0}});
  axes.push_back({Kind::kAngular, Frame::kCamera, {1, 1, 0}, {1, -1, 1}});
  return axes;
}

Vec3d inWorld(const Vec3d& d, Frame frame, const View& view) {
  return frame == Frame::kWorld ? d : view.right * d.x + view.up * d.y + view.forward * d.z;
}
Exact unitExact(const Vec3d& d) {
  const Exact e(d);
  return e / length(e);
}

// Returns the pseudo-angle of a point; that of the eye itself is 0.
long double exactPseudoAngle(const Exact& p, const Exact& zero, const Exact& quarter) {
  const long double s = dot(p, quarter), c = dot(p, zero), sum = std::abs(s) + std::abs(c);
  const long double side = sum > 0 ? s / sum : 0;
  return c >= 0 ? side : s > 0 ? 2 - side : -2 - side;
}

bool holdsAngle(const Interval& range, long double angle) {
  for (const long double shift : {0.0L, 4.0L, -4.0L}) {
    if (range.low <= angle + shift && angle + shift <= range.high) {
      return true;
    }
  }
  return false;
}

// Returns the widest gap between neighbouring angles on the circle.
long double widestGap(std::vector<long double> angles) {
  std::sort(angles.begin(), angles.end());
  long double widest = angles.front() + 4 - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    widest = std::max(widest, angles[i] - angles[i - 1]);
  }
  return widest;
}

void checkHeights(const Interval& own, const std::vector<Exact>& points, const Exact& direction,
                  const std::string& where) {
  long double low = dot(points[0], direction), high = low;
  for (const Exact& p : points) {
    low = std::min(low, dot(p, direction));
    high = std::max(high, dot(p, direction));
  }
  EXPECT_LE(own.low, low) << where;
  EXPECT_GE(own.high, high) << where;
  const long double loose = 1e-6L * (std::abs(low) + std::abs(high));
  EXPECT_GE(own.low, low - loose) << where;
  EXPECT_LE(own.high, high + loose) << where;
}

void checkAngles(const Interval& own, const std::vector<Exact>& points, std::size_t vertices,
                 const Exact& zero, const Exact& quarter, const std::string& where) {
  EXPECT_GE(own.low, -2.0f) << where;
  EXPECT_LE(own.low, 2.0f) << where;
  EXPECT_GE(own.high, own.low) << where;
  EXPECT_LE(own.high, own.low + 4.0f) << where;
  std::vector<long double> angles;
  long double size = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const long double angle = exactPseudoAngle(points[i], zero, quarter);
    ASSERT_TRUE(holdsAngle(own, angle))
        << where << ", " << double(angle) << " in " << own.low << " " << own.high;
    size = std::max(size, length(points[i] - points[0]));
    if (i < vertices) {
      angles.push_back(angle);
    }
  }
  const long double gap = widestGap(angles);
  if (gap < 1.9999L) {
    EXPECT_EQ(own, (Interval{-2, 2})) << where;
  } else if (gap > 2.01L) {
    // If a range is within half a degree of half a turn, the eye almost touches the image, and extents may
    // grow.
    EXPECT_LE(own.high - own.low, 4 - gap + 2e-5L) << where;
  }
}

void checkAll(const ExtentScene& scene, const PartExtents& extents, const std::vector<ExtentAxis>& axes,
              const View& view, const Vec3d& reference, Random& random, const std::string& where) {
  for (std::uint32_t part = 0; part < scene.store.parts(); ++part) {
    const std::vector<Exact> from_reference = exactPoints(scene, part, reference);
    const bool one_hull = scene.store.hullsOf(part).size() == 1;
    const std::size_t vertices = from_reference.size();
    // Vertices first, of a single hull then points between them.
    const std::vector<Exact> from_eye = exactPoints(scene, part, view.eye, one_hull ? &random : nullptr);
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const std::string here = where + ", part " + std::to_string(part) + ", axis " + std::to_string(a);
      const Interval own = extents.table().at(a, part);
      const Exact direction = unitExact(inWorld(axes[a].direction, axes[a].frame, view));
      if (axes[a].kind == Kind::kSpatial) {
        checkHeights(own, axes[a].frame == Frame::kCamera ? from_eye : from_reference, direction, here);
      } else if (!view.orthographic) {
        const Exact zero = unitExact(inWorld(axes[a].zero, axes[a].frame, view));
        if (one_hull) {
          checkAngles(own, from_eye, vertices, zero, direction, here);
        } else {
          for (const Exact& p : from_eye) {
            EXPECT_TRUE(holdsAngle(own, exactPseudoAngle(p, zero, direction))) << here;
          }
        }
      }
    }
  }
}

ExtentScene someShapes(Random& random, double scale) {
  ExtentScene scene;
  using namespace shapes;
  scene.addPart(scaled(toothpick(0.7), scale));
  scene.addPart(scaled(shapes::cube(), scale));
  scene.addPart(scaled(randomBall(random, 60), scale));
  scene.addPart(scaled(randomGrid(random, 40, 3), 0.3 * scale));
  scene.addPart(scaled(randomFlatGrid(random, 30, 3, 2), 0.1 * scale));
  scene.addPart(scaled(flatPolygon(50), scale));
  scene.addPart(scaled(prism(30, 1.0, 3.0), scale));
  scene.addPart(scaled(segment({0, 0, 0}, {1, 2, 3}), scale));
  scene.addPart(scaled(point({0.5, 0, 0}), scale));
  const std::uint32_t two[] = {0, 1};
  scene.addPart(two, {});
  return scene;
}

TEST(PartExtents, HoldTheExactBoundsTightlyWhileThingsMove) {
  const std::vector<ExtentAxis> axes = allKinds();
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const double scale = std::pow(10.0, random.whole(-6, 6));
    const Vec3d middle = random.direction() * (scale * (seed % 3 == 0 ? 1e4 : 0.0));
    ExtentScene scene = someShapes(random, scale);
    PartExtents extents(axes);
    const Vec3d reference = middle + random.direction() * scale;
    Vec3d eye = reference;
    for (int frame = 0; frame < 6; ++frame) {
      for (std::uint32_t part = 0; part < scene.store.parts(); ++part) {
        if (frame == 0 || random.below(3) != 0) {
          scene.place(
              part, randomPlacement(random, middle + random.direction() * (scale * random.number(0, 8)), 1));
        }
      }
      const View view = randomView(random, eye, false);
      extents.update(view, scene.store, scene.moved, scene.used);
      checkAll(scene, extents, axes, view, reference, random,
               "seed " + std::to_string(seed) + ", frame " + std::to_string(frame));
      scene.rest();
      eye = middle + random.direction() * (scale * std::pow(10.0, random.number(-3, 2)));
    }
  }
}

TEST(PartExtents, FollowSmallSteps) {
  const std::vector<ExtentAxis> axes = allKinds();
  Random random(5);
  ExtentScene scene;
  const std::uint32_t hull = scene.addHull(shapes::toothpick(0.7));
  for (int i = 0; i < 10; ++i) {
    scene.addPart(std::span(&hull, 1), randomPlacement(random, random.direction() * 3.0, 1));
  }
  PartExtents extents(axes);
  Vec3d eye{0, 0, 4};
  for (int frame = 0; frame < 100; ++frame) {
    for (std::uint32_t part = 0; part < 10; ++part) {
      Placement p = scene.store.placements[part];
      p.origin += random.direction() * 0.05;
      const double c = std::cos(0.03 * part), s = std::sin(0.03 * part);
      scene.place(part, {p.x * c + p.y * s, p.y * c - p.x * s, p.z, p.origin});
    }
    View view = straightView(eye);
    setOrientation(view, {std::sin(0.1 * frame), 0.1, -std::cos(0.1 * frame)}, {0, 1, 0});
    extents.update(view, scene.store, scene.moved, scene.used);
    checkAll(scene, extents, axes, view, {0, 0, 4}, random, "frame " + std::to_string(frame));
    eye += random.direction() * 0.1;
  }
}

TEST(PartExtents, HullsOfAPartHaveTheExtentsOfPartsOfTheirOwn) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    ExtentScene alone = someShapes(random, 1.0), together = alone;
    const std::uint32_t count = static_cast<std::uint32_t>(alone.points.size());
    std::vector<std::uint32_t> hulls(count);
    std::iota(hulls.begin(), hulls.end(), 0u);
    const std::uint32_t part = together.addPart(hulls, {});
    PartExtents of_alone(allKinds()), of_together(allKinds());
    for (int frame = 0; frame < 3; ++frame) {
      const Placement placement = randomPlacement(random, random.direction() * random.number(0, 8), 1);
      for (std::uint32_t i = 0; i < alone.store.parts(); ++i) {
        alone.place(i, placement);
      }
      together.place(part, placement);
      const View view = randomView(random, {}, seed % 3 == 0);
      of_alone.update(view, alone.store, alone.moved, alone.used);
      of_together.update(view, together.store, together.moved, together.used);
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t instance = together.store.first_hull[part] + i;
        EXPECT_EQ(extentOf(of_together.hulls(), instance), extentOf(of_alone.table(), i)) << "seed " << seed;
        EXPECT_EQ(of_together.queryOfHull(instance), of_alone.query(i)) << "seed " << seed;
      }
    }
  }
}

// A hull on the eye's own axis behind the eye, whose image is on both sides of the branch cut.
TEST(PartExtents, PassTheBranchCut) {
  ExtentScene scene;
  const std::uint32_t behind = scene.addPart(shapes::cube({0, 0, 5}, 1.0));
  const std::uint32_t front = scene.addPart(shapes::cube({0, 0, -5}, 1.0));
  PartExtents extents(cameraExtents());
  extents.update(straightView({}), scene.store, scene.moved, scene.used);
  // The near face's corners are at (1, 4), at a pseudo-angle of 1 / 5 from the axis.
  const Interval back = extents.table().at(0, behind);
  EXPECT_NEAR(back.low, 1.8, 1e-5);
  EXPECT_NEAR(back.high, 2.2, 1e-5);
  EXPECT_NEAR(extents.table().at(0, front).low, -0.2, 1e-5);
  EXPECT_NEAR(extents.table().at(0, front).high, 0.2, 1e-5);
}

TEST(PartExtents, OverlapAcrossTheBranchCut) {
  // One part from 170 to 280 degrees, seen from above, and others at single angles. Angle 0 is ahead (-z),
  // and a quarter turn is to the right.
  const auto at = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    return Vec3d{3 * std::sin(angle), 0, -3 * std::cos(angle)};
  };
  ExtentScene scene;
  scene.addPart(shapes::segment(at(170), at(280)));
  const std::vector<std::pair<double, bool>> others = {
      {-80, true},  {-79, false}, {-100, true}, {260, true}, {-180, true}, {180, true},    {170, true},
      {169, false}, {171, true},  {-170, true}, {0, false},  {90, false},  {-189.5, true}, {281, false}};
  for (const auto& [degrees, hit] : others) {
    scene.addPart(shapes::point(at(degrees)));
  }
  PartExtents extents({cameraExtents()[0]});
  extents.update(straightView({}), scene.store, scene.moved, scene.used);
  for (std::uint32_t i = 0; i < others.size(); ++i) {
    EXPECT_EQ(overlaps(extents.table(), extents.query(i + 1), 0), others[i].second) << others[i].first;
    EXPECT_EQ(overlaps(extents.table(), extents.query(0), i + 1), others[i].second) << others[i].first;
  }
}

TEST(PartExtents, AreTheFullCycleAroundAnEyeInTheImage) {
  ExtentScene scene;
  scene.addPart(shapes::cube());
  scene.addPart(shapes::moved(shapes::toothpick(2.0), {5, 0, 0}));
  scene.addPart(shapes::segment({-1, 0, 0}, {1, 0, 0}));  // contains the eye
  scene.addPart(shapes::point({0, 0, 0}));                // is at the eye
  scene.addPart(shapes::point({7, 0, 0}));                // has the eye's image in the second plane
  PartExtents extents(cameraExtents());
  extents.update(straightView({}), scene.store, scene.moved, scene.used);
  const Interval full{-2, 2};
  EXPECT_EQ(extents.table().at(0, 0), full);
  EXPECT_EQ(extents.table().at(1, 0), full);
  EXPECT_LT(extents.table().at(0, 1).high - extents.table().at(0, 1).low, 1.0f);
  EXPECT_EQ(extents.table().at(1, 1), full);
  EXPECT_EQ(extents.table().at(0, 2), full);
  EXPECT_EQ(extents.table().at(0, 3), full);
  EXPECT_EQ(extents.table().at(1, 3), full);
  EXPECT_NEAR(extents.table().at(0, 4).low, 1.0, 1e-5);
  EXPECT_EQ(extents.table().at(1, 4), full);
}

TEST(PartExtents, FixedToTheWorldAreTakenAnewForMovedPartsAlone) {
  Random random(3);
  ExtentScene scene = someShapes(random, 1.0);
  const std::size_t n = scene.store.parts();
  PartExtents world(worldExtents()), camera(cameraExtents());
  View view = straightView({1, 2, 3});
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 3 * n);
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 3 * n);
  scene.rest();
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 0u);
  view.eye.x += 1;
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 0u);
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 3 * n);
  scene.place(4, randomPlacement(random, {1, 1, 1}, 1));
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 3u);
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 3u);
  scene.rest();
  scene.addPart(shapes::cube());
  scene.rest();
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 3u);
  checkAll(scene, world, worldExtents(), view, {1, 2, 3}, random, "at the end");
}

TEST(PartExtents, OfPartsThatAreNotUsedAreTakenWhenTheyAre) {
  Random random(4);
  ExtentScene scene = someShapes(random, 1.0);
  const std::size_t n = scene.store.parts();
  PartExtents world(worldExtents()), camera(cameraExtents());
  View view = straightView({1, 2, 30});
  scene.used[2] = scene.used[5] = 0;
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 3 * (n - 2));
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 3 * (n - 2));
  scene.rest();
  scene.place(5, randomPlacement(random, {1, 1, 1}, 1));
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 0u);
  scene.rest();
  view.eye.x += 1;
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 3 * (n - 2));
  scene.used[2] = scene.used[5] = 1;
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 6u);
  EXPECT_EQ(camera.update(view, scene.store, scene.moved, scene.used), 6u);
  EXPECT_EQ(world.update(view, scene.store, scene.moved, scene.used), 0u);
  checkAll(scene, world, worldExtents(), view, {1, 2, 30}, random, "world");
  checkAll(scene, camera, cameraExtents(), view, view.eye, random, "camera");
}

TEST(PartExtents, KeepDetailsFarFromTheOrigin) {
  ExtentScene scene;
  const Vec3d far{1e6, -2e6, 3e6};
  scene.addPart(shapes::cube({}, 1e-3), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, far});
  for (const std::vector<ExtentAxis>& axes : {cameraExtents(), worldExtents()}) {
    PartExtents extents(axes);
    extents.update(straightView(far + Vec3d{0, 0, 1}), scene.store, scene.moved, scene.used);
    for (std::size_t a = 0; a < 3; ++a) {
      const Interval own = extents.table().at(a, 0);
      EXPECT_NEAR(own.high - own.low, 2e-3, 2e-5) << a;
    }
  }
}

TEST(PartExtents, OfPartsThatAreNotFiniteOverlapEverything) {
  ExtentScene scene;
  scene.addPart(shapes::cube(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {std::nan(""), 0, 0}});
  scene.addPart(shapes::cube({0, 0, 100}));
  for (const bool orthographic : {false, true}) {
    PartExtents extents(allKinds());
    const View view = straightView({0.5, 3, 7}, orthographic);
    extents.update(view, scene.store, scene.moved, scene.used);
    EXPECT_TRUE(overlaps(extents.table(), extents.query(0u), 1));
    EXPECT_TRUE(overlaps(extents.table(), extents.query(1u), 0));
    EXPECT_EQ(extents.table().at(2, 0), (Interval{-kFloatInfinity, kFloatInfinity}));
    EXPECT_EQ(extents.distanceAlong(2, 0), std::numeric_limits<double>::infinity());
  }
  PartExtents extents(allKinds());
  View nowhere = straightView({std::nan(""), 0, 0});
  extents.update(nowhere, scene.store, scene.moved, scene.used);
  EXPECT_TRUE(overlaps(extents.table(), extents.query(1u), 1));
}

TEST(PartExtents, PaddingOverlapsNothing) {
  ExtentScene scene;
  scene.addPart(shapes::cube(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {std::nan(""), 0, 0}});
  PartExtents extents(allKinds());
  extents.update(straightView({}), scene.store, scene.moved, scene.used);
  for (std::size_t axis = 0; axis < extents.table().axes(); ++axis) {
    ASSERT_EQ(extents.table().lows[axis].size(), ExtentTable::kPadding);
    ASSERT_EQ(extents.table().highs[axis].size(), ExtentTable::kPadding);
  }
  for (std::uint32_t i = 1; i < ExtentTable::kPadding; ++i) {
    EXPECT_FALSE(overlaps(extents.table(), extents.query(0u), i));
  }
}

TEST(PartExtents, AQueryReachesTheEye) {
  ExtentScene scene;
  scene.addPart(shapes::cube({0, 0, -10}));
  scene.addPart(shapes::cube({0, 0, 20}));
  PartExtents extents(worldExtents());
  extents.update(straightView({0, 0, 3}), scene.store, scene.moved,
                 scene.used);  // heights are measured above the first eye
  EXPECT_NEAR(extents.query(0u)[2].high, 0.0, 1e-6);
  EXPECT_NEAR(extents.query(1u)[2].low, 0.0, 1e-6);
  EXPECT_NEAR(extents.query(1u)[2].high, 18.0, 1e-4);
  EXPECT_NEAR(extents.distanceAlong(2, 0), 13.0, 1e-5);
  extents.update(straightView({0, 0, 8}), scene.store, scene.moved, scene.used);
  EXPECT_NEAR(extents.query(0u)[2].high, 5.0, 1e-5);
  EXPECT_NEAR(extents.distanceAlong(2, 0), 18.0, 1e-5);
  EXPECT_NEAR(extents.distanceAlong(2, 1), 12.0, 1e-5);
  extents.update(straightView({0, 0, 8}, true), scene.store, scene.moved, scene.used);
  EXPECT_EQ(extents.query(0u)[2].high, kFloatInfinity);
  EXPECT_NEAR(extents.query(0u)[2].low, -14.0, 1e-5);
  EXPECT_EQ(extents.query(0u)[0], extents.table().at(0, 0));  // the axis is across the rays
  EXPECT_LT(extents.distanceAlong(2, 1), extents.distanceAlong(2, 0));
}

// A point of the back hull, the eye, and a point of the front hull between them.
class NeverMisses : public testing::TestWithParam<bool> {};

TEST_P(NeverMisses, AnOccluder) {
  const bool orthographic = GetParam();
  const std::vector<ExtentAxis> axes = allKinds();
  Random of_shapes(1);
  ExtentScene scene = someShapes(of_shapes, 1.0);
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    const double scale = std::pow(10.0, random.whole(-6, 6));
    const auto n = static_cast<std::uint32_t>(scene.store.parts());
    const Vec3d eye = random.direction() * (scale * std::pow(10.0, random.number(-2, 2)));
    const bool straight = random.below(4) == 0;
    const View view = straight ? straightView(eye, orthographic) : randomView(random, eye, orthographic);
    for (std::uint32_t part = 0; part < n; ++part) {
      scene.place(part, randomPlacement(random, random.direction() * (scale * random.number(0, 8)), scale));
    }
    PartExtents extents(axes);
    extents.update(randomView(random, random.direction() * scale, false), scene.store, scene.moved,
                   scene.used);
    const std::uint32_t back = random.below(n), front = random.below(n);
    if (front == back) {
      continue;
    }
    const std::vector<Exact> back_points = exactPoints(scene, back, {}, &random);
    const std::vector<Exact> front_points = exactPoints(scene, front, {}, &random);
    const Vec3d far(back_points[random.below(static_cast<std::uint32_t>(back_points.size()))]);
    const Vec3d own(front_points[random.below(static_cast<std::uint32_t>(front_points.size()))]);
    const double along = random.below(4) == 0 ? 1.0 : random.number(0, 1);  // 1.0: the hulls touch
    const Vec3d near =
        orthographic ? far - view.forward * (scale * (1 - along) * 50) : eye + (far - eye) * along;
    Placement placement = scene.store.placements[front];
    placement.origin += near - own;
    scene.rest();
    scene.place(front, placement);
    extents.update(view, scene.store, scene.moved, scene.used);
    EXPECT_TRUE(overlaps(extents.table(), extents.query(back), front)) << "seed " << seed;
    const std::uint32_t third = random.below(n);
    const std::uint32_t group[] = {third, back};
    EXPECT_TRUE(overlaps(extents.table(), extents.query(group), front)) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(PartExtents, NeverMisses, testing::Bool());

TEST(PartExtents, OfAnOrthographicViewArePositionsAcrossIt) {
  ExtentScene scene;
  scene.addPart(shapes::cube({4, 2, -10}));
  PartExtents extents(cameraExtents());
  extents.update(straightView({1, 1, 0}, true), scene.store, scene.moved, scene.used);
  EXPECT_FALSE(extents.table().angular(0));
  EXPECT_NEAR(extents.table().at(0, 0).low, 2.0, 1e-5);
  EXPECT_NEAR(extents.table().at(0, 0).high, 4.0, 1e-5);
  EXPECT_EQ(extents.query(0u)[0], extents.table().at(0, 0));
  EXPECT_NEAR(extents.table().at(1, 0).high, 2.0, 1e-5);
  EXPECT_EQ(extents.query(0u)[2].low, -kFloatInfinity);
  EXPECT_NEAR(extents.query(0u)[2].high, 11.0, 1e-5);
  extents.update(straightView({1, 1, 0}), scene.store, scene.moved, scene.used);
  EXPECT_TRUE(extents.table().angular(0));
  EXPECT_NEAR(extents.table().at(0, 0).high, 4.0 / 13.0, 1e-5);
}

// Searches begin at the last farthest vertices, also if those were of another view and of a hull with more
// vertices.
TEST(PartExtents, AnglesDoNotDependOnWhereTheSearchBegins) {
  Random random(11);
  ExtentScene toothpick, ball;
  toothpick.addPart(shapes::toothpick(0.7));
  ball.addPart(shapes::randomBall(random, 80));
  const std::vector<ExtentAxis> axes = allKinds();
  PartExtents warm(axes);
  for (int i = 0; i < 400; ++i) {
    const ExtentScene& scene = random.below(2) == 0 ? toothpick : ball;
    const View view = randomView(random, random.direction() * random.number(0, 4), false);
    warm.replaceHull(0, scene.store);
    warm.update(view, scene.store, scene.moved, scene.used);
    PartExtents fresh(axes);
    fresh.update(view, scene.store, scene.moved, scene.used);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (axes[axis].kind == Kind::kAngular) {
        EXPECT_NEAR(warm.table().at(axis, 0).low, fresh.table().at(axis, 0).low, 1e-6) << i;
        EXPECT_NEAR(warm.table().at(axis, 0).high, fresh.table().at(axis, 0).high, 1e-6) << i;
      }
    }
  }
}

TEST(PartExtents, OfAxesThatAreNotFiniteRuleNothingOut) {
  ExtentScene scene;
  scene.addPart(shapes::cube({0, 0, -10}));
  scene.addPart(shapes::cube({0, 0, 20}));
  const double nan = std::nan("");
  PartExtents extents({{Kind::kSpatial, Frame::kWorld, {nan, 0, 0}, {}},
                       {Kind::kSpatial, Frame::kCamera, {0, 0, 0}, {}},
                       {Kind::kAngular, Frame::kWorld, {1, 0, 0}, {0, nan, 0}},
                       {Kind::kAngular, Frame::kWorld, {0, 0, 0}, {0, 0, 1}}});
  extents.update(straightView({1, 2, 3}), scene.store, scene.moved, scene.used);
  extents.update(straightView({1e308, 2, -1e308}), scene.store, scene.moved, scene.used);
  EXPECT_TRUE(overlaps(extents.table(), extents.query(0u), 1));
  EXPECT_TRUE(overlaps(extents.table(), extents.query(1u), 0));
}

TEST(PartExtents, OfSeveralPartsHoldEachOne) {
  Random of_shapes(1);
  ExtentScene scene = someShapes(of_shapes, 1.0);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const auto n = static_cast<std::uint32_t>(scene.store.parts());
    for (std::uint32_t part = 0; part < n; ++part) {
      scene.place(part, randomPlacement(random, random.direction() * random.number(2, 8), 1));
    }
    PartExtents extents(allKinds());
    extents.update(randomView(random, {}, false), scene.store, scene.moved, scene.used);
    std::vector<std::uint32_t> group;
    for (std::uint32_t i = 0; i < 1 + random.below(4); ++i) {
      group.push_back(random.below(n));
    }
    const Extent all = extents.query(group);
    for (const std::uint32_t member : group) {
      const Extent own = extents.query(member);
      for (std::size_t a = 0; a < extents.table().axes(); ++a) {
        if (extents.table().angular(a)) {
          EXPECT_TRUE(holdsAngle(all[a], own[a].low)) << "seed " << seed;
          EXPECT_TRUE(holdsAngle(all[a], own[a].high)) << "seed " << seed;
        } else {
          EXPECT_LE(all[a].low, own[a].low) << "seed " << seed;
          EXPECT_GE(all[a].high, own[a].high) << "seed " << seed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline::layers::extent_tests
