#include "sightline/occluders/choose_occluders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/occluders/flat_mesh.h"
#include "tests/support/square_view.h"

namespace sightline {
namespace {

using namespace flat_mesh;

constexpr AreaAngleDirection kDirections[] = {AreaAngleDirection::kView, AreaAngleDirection::kOccluder};

View frontView() {
  return test::squareView(0.1, 100.0);
}

// A square facing +z.
std::vector<Vec3f> square(const Vec3d& middle, double size) {
  const double h = 0.5 * size;
  std::vector<Vec3f> corners;
  for (const Vec3d& d : {Vec3d(-h, -h, 0), Vec3d(h, -h, 0), Vec3d(h, h, 0), Vec3d(-h, h, 0)}) {
    corners.push_back(Vec3f(middle + d));
  }
  return corners;
}

OccluderSet setOf(const std::vector<std::vector<Vec3f>>& polygons, bool double_sided = false) {
  std::vector<OccluderPolygon> input;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    input.push_back({polygons[i], double_sided, ObjectId(i)});
  }
  return makeOccluders(input);
}

TEST(AreaAngle, IsTheAreaTimesTheCosineOverTheSquaredDistance) {
  const OccluderSet set = setOf({square({3, 0, -4}, 2.0)});
  const View view = frontView();
  EXPECT_NEAR(areaAngle(set.occluders[0], view, AreaAngleDirection::kView), 4.0 / 25.0, 1e-6);
  EXPECT_NEAR(areaAngle(set.occluders[0], view, AreaAngleDirection::kOccluder), 4.0 * 0.8 / 25.0, 1e-6);
}

TEST(AreaAngle, TowardsTheOccluderIsTheSolidAngleOfASmallOne) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const Placement place = anyPlacement(random, 20.0);
    std::vector<Vec3f> triangle;
    for (const Point2& p : {Point2{0, 0}, Point2{0.2, 0}, Point2{0.1, 0.2}}) {
      triangle.push_back(place(p));
    }
    const OccluderSet set = setOf({triangle}, true);
    View view = frontView();
    view.eye = random.point(5.0);
    Vec3d d[3];
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = Vec3d(triangle[i]) - view.eye;
    }
    // Van Oosterom and Strackee 1983.
    const double a = length(d[0]), b = length(d[1]), c = length(d[2]);
    const double solid =
        2.0 * std::atan2(std::abs(dot(d[0], cross(d[1], d[2]))),
                         a * b * c + dot(d[0], d[1]) * c + dot(d[1], d[2]) * a + dot(d[2], d[0]) * b);
    if (length(d[0]) > 4.0) {
      EXPECT_NEAR(areaAngle(set.occluders[0], view, AreaAngleDirection::kOccluder), solid,
                  0.05 * solid + 1e-6)
          << "seed " << seed;
    }
  }
}

TEST(AreaAngle, OfABackIsNoneUnlessBothSidesHide) {
  const std::vector<Vec3f> front = square({1, 1, -5}, 2.0);
  const std::vector<Vec3f> back(front.rbegin(), front.rend());
  for (const bool orthographic : {false, true}) {
    View view = frontView();
    view.orthographic = orthographic;
    for (const AreaAngleDirection direction : kDirections) {
      const double seen = areaAngle(setOf({front}).occluders[0], view, direction);
      EXPECT_GT(seen, 0.0);
      EXPECT_EQ(areaAngle(setOf({back}).occluders[0], view, direction), 0.0);
      EXPECT_EQ(areaAngle(setOf({back}, true).occluders[0], view, direction), seen);
      EXPECT_EQ(areaAngle(setOf({front}, true).occluders[0], view, direction), seen);
    }
  }
}

TEST(AreaAngle, DoesNotDependOnTheLengthOfAxes) {
  const OccluderSet set = setOf({square({1, 1, -5}, 2.0)});
  for (const bool orthographic : {false, true}) {
    View view = frontView();
    view.orthographic = orthographic;
    for (const AreaAngleDirection direction : kDirections) {
      View scaled = view;
      scaled.forward = view.forward * 3.0;
      EXPECT_EQ(areaAngle(set.occluders[0], scaled, direction), areaAngle(set.occluders[0], view, direction));
    }
  }
}

TEST(AreaAngle, WithTheEyeInThePlaneIsNone) {
  const std::vector<Vec3f> edge_on{{-1, 0, -2}, {1, 0, -2}, {1, 0, -9}, {-1, 0, -9}};
  for (const AreaAngleDirection direction : kDirections) {
    EXPECT_EQ(areaAngle(setOf({edge_on}, true).occluders[0], frontView(), direction), 0.0);
    EXPECT_EQ(areaAngle(setOf({square({0, 0, 0}, 2.0)}, true).occluders[0], frontView(), direction), 0.0);
  }
}

TEST(AreaAngle, AlongTheViewCountsWallsBesideTheViewerForNothing) {
  const std::vector<Vec3f> beside{{-2, -1, 5}, {-2, -1, -5}, {-2, 1, -5}, {-2, 1, 5}};
  const OccluderSet set = setOf({beside}, true);
  EXPECT_NEAR(areaAngle(set.occluders[0], frontView(), AreaAngleDirection::kView), 0.0, 1e-12);
  EXPECT_NEAR(areaAngle(set.occluders[0], frontView(), AreaAngleDirection::kOccluder), 20.0 / 4.0, 1e-6);
}

TEST(AreaAngle, OfAnOrthographicViewIsTheProjectedArea) {
  View view = frontView();
  view.orthographic = true;
  for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Placement turned{{4, 3, -9}, {std::cos(angle), 0, -std::sin(angle)}, {0, 1, 0}};
    std::vector<Vec3f> corners;
    for (const Point2& p : {Point2{0, 0}, Point2{3, 0}, Point2{3, 2}, Point2{0, 2}}) {
      corners.push_back(turned(p));
    }
    for (const AreaAngleDirection direction : kDirections) {
      EXPECT_NEAR(areaAngle(setOf({corners}).occluders[0], view, direction), 6.0 * std::cos(angle), 1e-5);
    }
  }
}

struct Crowd {
  OccluderSet set;
  std::vector<Box> bounds;      // by object
  std::vector<ObjectId> asked;  // some of the objects
};

Crowd crowd(Random& random) {
  std::vector<std::vector<Vec3f>> polygons;
  std::vector<OccluderPolygon> input;
  Crowd result;
  const std::uint32_t objects = 40 + random.below(100);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Placement place = anyPlacement(random, 30.0);
    std::vector<Vec3f>& corners = polygons.emplace_back();
    const double w = random.in(0.2, 6.0), h = random.in(0.2, 6.0);
    for (const Point2& p : {Point2{0, 0}, Point2{w, 0}, Point2{w, h}, Point2{0, h}}) {
      corners.push_back(place(p));
    }
  }
  result.bounds.resize(objects);
  for (const std::vector<Vec3f>& corners : polygons) {
    const std::uint32_t object = random.below(objects);
    input.push_back({corners, random.below(2) == 0, ObjectId(object)});
    for (const Vec3f& corner : corners) {
      result.bounds[object].extend(corner);
    }
  }
  for (std::uint32_t i = 0; i < objects; ++i) {
    if (random.below(4) != 0) {
      result.asked.push_back(ObjectId(i));
    }
  }
  result.set = makeOccluders(input);
  return result;
}

double distanceTo(const Box& box, const Vec3d& p) {
  Vec3d d;
  for (int axis = 0; axis < 3; ++axis) {
    d[axis] = std::max({static_cast<double>(box.min[axis]) - p[axis], 0.0, p[axis] - box.max[axis]});
  }
  return length(d);
}

bool whollyOutside(const OccluderSet& set, const Occluder& occluder, const View& view) {
  for (const Plane& plane : frustumOf(view).planes) {
    const std::span<const Vec3f> corners = set.verticesOf(occluder);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](const Vec3f& corner) { return plane.evaluate(Vec3d(corner)) <= 0.0; })) {
      return true;
    }
  }
  return false;
}

std::vector<OccluderId> chosenBySorting(const Crowd& crowd, const View& view,
                                        const ChoiceSettings& settings) {
  std::vector<std::pair<double, std::uint32_t>> all;  // negated, so that the best come first
  for (std::uint32_t i = 0; i < crowd.set.occluders.size(); ++i) {
    const Occluder& occluder = crowd.set.occluders[i];
    const double score = areaAngle(occluder, view, settings.direction);
    const bool asked = std::binary_search(crowd.asked.begin(), crowd.asked.end(), occluder.object);
    const bool near = settings.max_distance == 0.0 ||
                      distanceTo(crowd.bounds[occluder.object.value], view.eye) <= settings.max_distance;
    if (asked && near && score > 0.0 && !whollyOutside(crowd.set, occluder, view)) {
      all.emplace_back(-score, i);
    }
  }
  std::sort(all.begin(), all.end());
  std::vector<OccluderId> ids;
  for (std::size_t i = 0; i < all.size() && i < settings.count; ++i) {
    ids.push_back(OccluderId(all[i].second));
  }
  return ids;
}

View crowdView(Random& random, std::uint64_t seed) {
  View view;
  view.eye = random.point(20.0);
  setOrientation(view, random.point(1.0), {0, 1, 0});
  view.orthographic = seed % 4 == 0;
  view.ortho_height = 30.0;
  return view;
}

TEST(ChooseOccluders, ReturnsWhatSortingAllOfThemReturns) {
  OccluderChooser chooser;  // one for all: nothing of the last view stays
  std::size_t full = 0, partly = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    Random random(seed);
    const Crowd scene = crowd(random);
    const View view = crowdView(random, seed);
    for (const AreaAngleDirection direction : kDirections) {
      for (const std::uint32_t count : {0u, 1u, 8u, 64u, 1000u}) {
        for (const double lambda : {0.0, 15.0}) {
          const ChoiceSettings settings{.count = count, .direction = direction, .max_distance = lambda};
          const std::span<const OccluderId> chosen =
              chooser.choose(view, scene.set, scene.asked, scene.bounds, settings);
          const std::vector<OccluderId> expected = chosenBySorting(scene, view, settings);
          EXPECT_TRUE(std::equal(chosen.begin(), chosen.end(), expected.begin(), expected.end()))
              << "seed " << seed << " count " << count << " lambda " << lambda;
          full += chosen.size() == count ? 1 : 0;
          partly += chosen.size() < count && !chosen.empty() ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(full, 100u);
  EXPECT_GT(partly, 100u);
}

TEST(ChooseOccluders, OfGivenOccludersReturnsWhatSortingThemReturns) {
  OccluderChooser chooser;
  std::size_t full = 0, partly = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Crowd scene = crowd(random);
    const View view = crowdView(random, seed);
    std::vector<OccluderId> given;  // in no order
    for (const ObjectId object : scene.asked) {
      const std::span<const OccluderId> of_object = scene.set.occludersOf(object);
      given.insert(random.below(2) == 0 ? given.begin() : given.end(), of_object.begin(), of_object.end());
    }
    for (const AreaAngleDirection direction : kDirections) {
      for (const std::uint32_t count : {0u, 1u, 8u, 64u, 1000u}) {
        const ChoiceSettings settings{.count = count, .direction = direction};
        const std::vector<OccluderId> expected = chosenBySorting(scene, view, settings);
        // The distance is one to objects: here it has no meaning.
        const ChoiceSettings near_only{.count = count, .direction = direction, .max_distance = 1.0};
        for (const ChoiceSettings& s : {settings, near_only}) {
          const std::span<const OccluderId> chosen = chooser.choose(view, scene.set, given, s);
          EXPECT_TRUE(std::equal(chosen.begin(), chosen.end(), expected.begin(), expected.end()))
              << "seed " << seed << " count " << count;
          full += chosen.size() == count ? 1 : 0;
          partly += chosen.size() < count && !chosen.empty() ? 1 : 0;
        }
      }
    }
    EXPECT_TRUE(chooser.choose(view, scene.set, std::span<const OccluderId>(), {}).empty());
  }
  EXPECT_GT(full, 100u);
  EXPECT_GT(partly, 100u);
}

TEST(ChooseOccluders, TiesGoToTheLowerId) {
  // Four equal squares at equal distances.
  const OccluderSet set =
      setOf({square({2, 0, -9}, 1), square({-2, 0, -9}, 1), square({0, 2, -9}, 1), square({0, -2, -9}, 1)});
  const std::vector<ObjectId> objects{ObjectId(3u), ObjectId(1u), ObjectId(0u), ObjectId(2u)};
  const std::vector<Box> bounds(4, Box{{-3, -3, -9}, {3, 3, -9}});
  OccluderChooser chooser;
  for (std::uint32_t count = 1; count <= 4; ++count) {
    const auto chosen = chooser.choose(frontView(), set, objects, bounds, {.count = count});
    ASSERT_EQ(chosen.size(), count);
    for (std::uint32_t i = 0; i < count; ++i) {
      EXPECT_EQ(chosen[i], OccluderId(i));
    }
  }
}

TEST(ChooseOccluders, PassesOverWhatLiesOutsideTheFrustum) {
  // Large and near occluders that are behind the eye, beside the view, in front of the near plane or beyond
  // the far plane, and a small one in view.
  const OccluderSet set = setOf({square({0, 0, 3}, 8), square({40, 0, -9}, 8), square({0, 0, -0.05}, 0.1),
                                 square({0, 0, -120}, 90), square({0, 0, -9}, 0.5)},
                                true);
  std::vector<ObjectId> objects;
  for (std::uint32_t i = 0; i < 5; ++i) {
    objects.push_back(ObjectId(i));
  }
  const std::vector<Box> bounds(5);
  OccluderChooser chooser;
  for (const AreaAngleDirection direction : kDirections) {
    const auto chosen =
        chooser.choose(frontView(), set, objects, bounds, {.count = 3, .direction = direction});
    ASSERT_EQ(chosen.size(), 1u);
    EXPECT_EQ(set[chosen[0]].object, ObjectId(4u));
  }
}

TEST(ChooseOccluders, LooksNoFartherThanLambdaFromTheEyeToTheObjectsBox) {
  const OccluderSet set = setOf({square({0, 0, -10}, 2)});
  const std::vector<ObjectId> objects{ObjectId(0u)};
  const std::vector<Box> bounds{Box{{-1, -1, -10}, {1, 1, -8}}};
  OccluderChooser chooser;
  EXPECT_EQ(chooser.choose(frontView(), set, objects, bounds, {.max_distance = 7.9}).size(), 0u);
  EXPECT_EQ(chooser.choose(frontView(), set, objects, bounds, {.max_distance = 8.1}).size(), 1u);
  EXPECT_EQ(chooser.choose(frontView(), set, objects, bounds, {.max_distance = 0.0}).size(), 1u);
}

}  // namespace
}  // namespace sightline
