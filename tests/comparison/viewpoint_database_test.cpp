#include "sightline/comparison/viewpoint_database.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <thread>

#include "scenes/procedural.h"
#include "tests/comparison/picture_scenes.h"
#include "tests/support/object_arrays.h"

namespace sightline {
namespace {

using namespace picture_scenes;
using Ids = std::vector<OccluderId>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr OccluderCriterion kCriteria[] = {OccluderCriterion::kProjectedSize, OccluderCriterion::kFirstHit,
                                           OccluderCriterion::kMinimumSets};

struct CityModel {
  Scene scene = makeCity({.copies = 1});
  OccluderSet set = findOccluders(scene.view());
  Hierarchy hierarchy;
  std::vector<Vec3d> walk;  // some frames' eyes

  CityModel() {
    const test::ObjectArrays objects(scene);
    hierarchy = buildHierarchy(objects.boxes, objects.triangles);
    for (std::size_t f = 0; f < scene.paths[0].frames.size(); f += 8) {
      walk.push_back(scene.paths[0].view(f, scene.origin).eye);
    }
  }
};

const CityModel& smallCity() {
  static const CityModel kCity;
  return kCity;
}

Ids listOf(const ViewpointDatabase& database, std::uint32_t point, std::uint32_t direction) {
  const auto list = database.list(point, direction);
  return {list.begin(), list.end()};
}

Ids found(const ViewpointDatabase& database, const Vec3d& viewpoint, const Vec3d& direction) {
  const auto list = database.find(viewpoint, direction);
  return {list.begin(), list.end()};
}

bool sameLists(const ViewpointDatabase& a, const ViewpointDatabase& b) {
  if (a.pointCount() != b.pointCount() || a.directionCount() != b.directionCount()) {
    return false;
  }
  for (std::uint32_t p = 0; p < a.pointCount(); ++p) {
    for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
      if (!std::ranges::equal(a.list(p, d), b.list(p, d))) {
        return false;
      }
    }
  }
  return true;
}

OccluderId occluderAt(const OccluderSet& set, double x, double z) {
  for (std::uint32_t o = 0; o < set.occluders.size(); ++o) {
    if (std::abs(set.occluders[o].centroid.x - x) < 1e-3 &&
        std::abs(set.occluders[o].centroid.z - z) < 1e-3) {
      return OccluderId(o);
    }
  }
  ADD_FAILURE() << "no occluder at " << x << ", " << z;
  return {};
}

// Seen from the origin along -z: the largest image is that of a wall with nothing behind it but another wall;
// two walls hide the only occludee, and a poster before one of them is in nobody's set.
struct Criteria {
  Model model;
  OccluderId useless, behind, left, right, poster;

  Criteria() {
    model.addRectangle(-15.0, -3.5, -12.0, 12.0, -12.0);  // useless
    model.addRectangle(-16.0, -4.5, -12.0, 12.0, -13.0);  // behind it, unseen
    model.addRectangle(-2.5, 1.0, -4.0, 4.0, -10.0);      // left
    model.addRectangle(0.5, 3.0, -4.0, 4.0, -11.0);       // right
    model.addRectangle(-1.0, 0.0, -0.5, 0.5, -9.0);       // poster
    model.addBox({-3, -2, -22}, {3, 2, -20}, 200);
    model.addBox({40, -2, -22}, {44, 2, -20}, 200);  // to be seen
    model.finish();
    useless = occluderAt(model.set, -9.25, -12);
    behind = occluderAt(model.set, -10.25, -13);
    left = occluderAt(model.set, -0.75, -10);
    right = occluderAt(model.set, 1.75, -11);
    poster = occluderAt(model.set, -0.5, -9);
  }
  // From the origin, in the stored direction nearest to -z.
  Ids list(OccluderCriterion criterion, ViewpointDatabaseSettings settings = {}) const {
    settings.criterion = criterion;
    settings.directions = 300;
    const Vec3d origin[] = {{0, 0, 0}};
    return found(ViewpointDatabase::build(model.hierarchy, model.set, origin, settings), {0, 0, 0},
                 {0, 0, -1});
  }
};

TEST(ViewpointDatabase, ProjectedSizePutsTheLargestImagesFirstWhetherTheyHideOrNot) {
  const Criteria scene;
  EXPECT_EQ(scene.list(OccluderCriterion::kProjectedSize, {.view_angle_deg = 120.0}),
            (Ids{scene.useless, scene.behind, scene.left, scene.right, scene.poster}));
}

TEST(ViewpointDatabase, FirstHitHasWhatIsSeenByItsPixels) {
  const Criteria scene;
  const Ids list = scene.list(OccluderCriterion::kFirstHit, {.view_angle_deg = 120.0});
  ASSERT_GE(list.size(), 4u);
  EXPECT_EQ(Ids(list.begin(), list.begin() + 4), (Ids{scene.useless, scene.left, scene.right, scene.poster}));
  for (std::size_t i = 4; i < list.size(); ++i) {
    EXPECT_EQ(list[i], scene.behind);  // if a column of it shows at the side
  }
}

TEST(ViewpointDatabase, MinimumSetsHaveNothingButWhatHidesSomething) {
  const Criteria scene;
  const Ids list = scene.list(OccluderCriterion::kMinimumSets, {.view_angle_deg = 120.0});
  EXPECT_EQ(std::set<OccluderId>(list.begin(), list.end()), (std::set<OccluderId>{scene.left, scene.right}));
  EXPECT_EQ(list.size(), 2u);
}

TEST(ViewpointDatabase, MinimumSetsGoOnByFirstHitIfAsked) {
  const Criteria scene;
  Ids expected = scene.list(OccluderCriterion::kMinimumSets, {.view_angle_deg = 120.0});
  const Ids sets = expected;
  for (const OccluderId id : scene.list(OccluderCriterion::kFirstHit, {.view_angle_deg = 120.0})) {
    if (std::find(sets.begin(), sets.end(), id) == sets.end()) {
      expected.push_back(id);
    }
  }
  ASSERT_GT(expected.size(), sets.size());
  EXPECT_EQ(
      scene.list(OccluderCriterion::kMinimumSets, {.view_angle_deg = 120.0, .first_hit_after_sets = true}),
      expected);
  EXPECT_EQ(scene.list(OccluderCriterion::kMinimumSets,
                       {.occluder_count = 3, .view_angle_deg = 120.0, .first_hit_after_sets = true}),
            Ids(expected.begin(), expected.begin() + 3));
}

TEST(ViewpointDatabase, MinimumSetsLeaveOutOccludeesWithFewTriangles) {
  const Criteria scene;
  EXPECT_TRUE(scene.list(OccluderCriterion::kMinimumSets, {.min_triangles = 200}).empty());
  EXPECT_FALSE(scene.list(OccluderCriterion::kMinimumSets, {.min_triangles = 199}).empty());
}

TEST(ViewpointDatabase, ListsAreCutAtTheCount) {
  const Criteria scene;
  for (const OccluderCriterion criterion : kCriteria) {
    const Ids whole = scene.list(criterion);
    ASSERT_FALSE(whole.empty());
    EXPECT_EQ(scene.list(criterion, {.occluder_count = 1}), Ids(1, whole[0]));
    EXPECT_TRUE(scene.list(criterion, {.occluder_count = 0}).empty());
  }
}

TEST(ViewpointDatabase, BacksAndSmallOccludersAreLeftOut) {
  Model model;
  model.addRectangle(-2.0, 2.0, -2.0, 2.0, 10.0);  // faces away from the origin
  model.addRectangle(-2.0, 2.0, -2.0, 2.0, -10.0);
  model.addRectangle(3.0, 3.5, 0.0, 0.5, -10.0);
  model.finish();
  const Vec3d origin[] = {{0, 0, 0}};
  std::set<OccluderId> all, large;
  for (const double pixels : {0.0, 100.0}) {
    ViewpointDatabaseSettings settings{.criterion = OccluderCriterion::kFirstHit,
                                       .min_occluder_pixels = pixels};
    const auto database = ViewpointDatabase::build(model.hierarchy, model.set, origin, settings);
    for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
      const Ids list = listOf(database, 0, d);
      (pixels > 0.0 ? large : all).insert(list.begin(), list.end());
    }
  }
  const OccluderId wall = occluderAt(model.set, 0, -10);
  EXPECT_EQ(all, (std::set<OccluderId>{wall, occluderAt(model.set, 3.25, -10)}));
  EXPECT_EQ(large, (std::set<OccluderId>{wall}));
}

TEST(ViewpointDatabase, IsTheSameWithAnyThreads) {
  const CityModel& city = smallCity();
  const auto threads = [](std::uint32_t count, const RangeBody& body) {
    std::vector<std::thread> running;
    for (std::uint32_t begin = 0; begin < count; begin += 23) {
      running.emplace_back(body, begin, std::min(count, begin + 23));
      if (running.size() == 4) {
        for (std::thread& thread : running) {
          thread.join();
        }
        running.clear();
      }
    }
    for (std::thread& thread : running) {
      thread.join();
    }
  };
  for (const OccluderCriterion criterion : kCriteria) {
    const ViewpointDatabaseSettings settings{
        .criterion = criterion, .max_points = 9, .directions = 20, .resolution = 64};
    const auto alone = ViewpointDatabase::build(city.hierarchy, city.set, city.walk, settings);
    EXPECT_TRUE(
        sameLists(alone, ViewpointDatabase::build(city.hierarchy, city.set, city.walk, settings, threads)));
    EXPECT_GT(alone.pointCount(), 1u);
  }
}

TEST(ViewpointDatabase, ReportsItsProgressInOrder) {
  const Criteria scene;
  double last = 0.0;
  std::uint32_t calls = 0;
  const Vec3d points[] = {{0, 0, 0}, {1, 0, 0}};
  ViewpointDatabase::build(scene.model.hierarchy, scene.model.set, points, {.spacing = 1.0, .directions = 10},
                           serialFor, [&](double fraction) {
                             EXPECT_GT(fraction, last);
                             last = fraction;
                             ++calls;
                           });
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(calls, 20u);
}

TEST(ViewpointDatabase, NeedsFewerOccludersInACityThanFirstHit) {
  const CityModel& city = smallCity();
  std::size_t entries[3] = {};
  for (const OccluderCriterion criterion : kCriteria) {
    const auto database = ViewpointDatabase::build(
        city.hierarchy, city.set, city.walk, {.criterion = criterion, .max_points = 6, .resolution = 64});
    for (std::uint32_t p = 0; p < database.pointCount(); ++p) {
      for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
        const Ids list = listOf(database, p, d);
        EXPECT_EQ(std::set<OccluderId>(list.begin(), list.end()).size(), list.size());
        entries[static_cast<int>(criterion)] += list.size();
      }
    }
  }
  EXPECT_GT(entries[2], 0u);
  EXPECT_LT(entries[2], entries[1]);  // what is seen is a superset of what is needed
  EXPECT_LT(entries[1], entries[0]);
}

TEST(ViewpointDatabase, HasPointsAtEyeHeightNearAPath) {
  const CityModel& city = smallCity();
  const auto database =
      ViewpointDatabase::build(city.hierarchy, city.set, city.walk,
                               {.criterion = OccluderCriterion::kFirstHit, .directions = 1, .resolution = 8});
  EXPECT_LE(database.pointCount(), 48u);
  EXPECT_GT(database.pointCount(), 4u);
  for (const Vec3d& eye : city.walk) {
    const Vec3d point = database.point(database.nearestPoint(eye));
    EXPECT_LE(std::abs(point.y - eye.y), database.spacing() / 8.0);
    EXPECT_LE(std::hypot(point.x - eye.x, point.z - eye.z), database.spacing() * 0.7072);
  }
}

TEST(ViewpointDatabase, TheChosenSpacingIsTheSmallestThatNeedsFewPoints) {
  std::vector<Vec3d> line;
  for (int i = 0; i < 1000; ++i) {
    line.emplace_back(i, 1.7, 0.0);
  }
  const ViewpointDatabaseSettings coarse{.directions = 1, .resolution = 8};
  const auto database = ViewpointDatabase::build({}, {}, line, coarse);
  EXPECT_LE(database.pointCount(), 48u);
  EXPECT_GT(database.pointCount(), 30u);  // one step of the series finer would be too many
  EXPECT_NEAR(database.spacing(), 999.0 / 1024.0 * 16.0 * std::sqrt(2.0), 1e-9);  // n = 9: 46 points
  const auto few = ViewpointDatabase::build({}, {}, line, {.max_points = 5, .directions = 1});
  EXPECT_LE(few.pointCount(), 5u);
}

TEST(ViewpointDatabase, WithoutViewpointsItsPointsFillTheBox) {
  Model model;
  model.addBox({0, 0, 0}, {40, 10, 20});
  model.finish();
  const ViewpointDatabaseSettings settings{.spacing = 10.0, .directions = 1, .resolution = 8};
  const auto database = ViewpointDatabase::build(model.hierarchy, {}, {}, settings);
  ASSERT_EQ(database.pointCount(), 8u);
  std::set<std::pair<double, double>> places;
  for (std::uint32_t p = 0; p < 8; ++p) {
    EXPECT_NEAR(database.point(p).y, 5.0, 1e-9);
    places.emplace(std::round(database.point(p).x), std::round(database.point(p).z));
  }
  std::set<std::pair<double, double>> expected;
  for (const double x : {5.0, 15.0, 25.0, 35.0}) {
    expected.insert({{x, 5.0}, {x, 15.0}});
  }
  EXPECT_EQ(places, expected);
  for (const std::uint32_t max : {1u, 3u, 7u, 100u, 1000u}) {
    const auto chosen = ViewpointDatabase::build(model.hierarchy, {}, {},
                                                 {.max_points = max, .directions = 1, .resolution = 8});
    EXPECT_LE(chosen.pointCount(), max);
    EXPECT_GE(chosen.pointCount(), (max + 3) / 4);
  }
}

TEST(ViewpointDatabase, FindsTheNearestPoint) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Vec3d> viewpoints;
    for (int i = 0; i < 60; ++i) {
      viewpoints.push_back(random.point(20.0));
    }
    const auto database = ViewpointDatabase::build(
        {}, {}, viewpoints, {.spacing = random.in(1.0, 9.0), .directions = 1, .resolution = 8});
    for (int i = 0; i < 50; ++i) {
      const Vec3d place = random.point(40.0);
      const std::uint32_t nearest = database.nearestPoint(place);
      for (std::uint32_t p = 0; p < database.pointCount(); ++p) {
        EXPECT_LE(length(database.point(nearest) - place), length(database.point(p) - place) + 1e-12);
      }
    }
    // One in a point, or as near to two: the first.
    for (std::uint32_t p = 0; p < database.pointCount(); ++p) {
      EXPECT_EQ(database.nearestPoint(database.point(p)), p);
    }
  }
}

TEST(ViewpointDatabase, GivesListsInTheirOrder) {
  const auto database = ViewpointDatabase::build(smallCity().hierarchy, smallCity().set, {},
                                                 {.max_points = 4, .directions = 4, .resolution = 32});
  const OccluderLists& lists = database;
  EXPECT_TRUE(lists.inOrder());
  const Vec3d eye(1.0, 2.0, 3.0), direction(1.0, 0.0, 0.5);
  EXPECT_TRUE(
      std::ranges::equal(lists.find(eye, direction),
                         database.list(database.nearestPoint(eye), database.nearestDirection(direction))));
}

TEST(ViewpointDatabase, AnyViewpointAndDirectionHasAList) {
  const Criteria scene;
  const Vec3d points[] = {{kNan, 0, 0}, {0, 0, 0}, {3, 0, kInf}, {1e300, 0, 0}, {2, 0, 0}};
  const auto database =
      ViewpointDatabase::build(scene.model.hierarchy, scene.model.set, points, {.spacing = 1.0});
  EXPECT_EQ(database.pointCount(), 2u);
  for (const Vec3d& viewpoint : {Vec3d(kNan, 0, 0), Vec3d(kInf, kInf, -kInf), Vec3d(0, 1e308, 0)}) {
    EXPECT_EQ(database.nearestPoint(viewpoint), 0u);
    EXPECT_EQ(found(database, viewpoint, {0, 0, -1}), found(database, {0, 0, 0}, {0, 0, -1}));
  }
  for (const Vec3d& direction : {Vec3d(0, 0, 0), Vec3d(kNan, 0, 0), Vec3d(kInf, 0, 0)}) {
    EXPECT_EQ(found(database, {0, 0, 0}, direction), listOf(database, 0, 0));
  }
  const Vec3d nowhere[] = {{kNan, kNan, kNan}};
  EXPECT_EQ(ViewpointDatabase::build(scene.model.hierarchy, scene.model.set, nowhere).pointCount(), 1u);
}

TEST(ViewpointDatabase, EmptyScenesHaveEmptyLists) {
  const Criteria scene;
  const ViewpointDatabase none;
  EXPECT_TRUE(none.find({0, 0, 0}, {0, 0, -1}).empty());
  EXPECT_EQ(none.pointCount() * none.directionCount(), 1u);
  for (const OccluderCriterion criterion : kCriteria) {
    const ViewpointDatabaseSettings settings{.criterion = criterion, .max_points = 8, .resolution = 16};
    const auto empty = ViewpointDatabase::build({}, {}, {}, settings);
    EXPECT_EQ(empty.pointCount(), 1u);
    EXPECT_TRUE(empty.find({1, 2, 3}, {0, 0, -1}).empty());
    EXPECT_TRUE(ViewpointDatabase::build(scene.model.hierarchy, {}, {}, settings)
                    .find({0, 0, 0}, {0, 0, -1})
                    .empty());
    const auto no_nodes = ViewpointDatabase::build({}, scene.model.set, {}, settings);
    EXPECT_EQ(no_nodes.find({0, 0, 0}, {0, 0, -1}).empty(), criterion == OccluderCriterion::kMinimumSets);
  }
}

TEST(ViewpointDatabase, BrokenBoxesAndPolygonsDoNoHarm) {
  Criteria scene;
  scene.model.boxes.push_back({{0, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 1, 1}});
  scene.model.triangles.push_back(100);
  scene.model.boxes.push_back({});
  scene.model.triangles.push_back(100);
  scene.model.boxes.push_back({{-3e38f, -3e38f, -3e38f}, {3e38f, 3e38f, 3e38f}});
  scene.model.triangles.push_back(100);
  scene.model.finish();
  Occluder& broken = scene.model.set.occluders[scene.useless.value];
  scene.model.set.vertices[broken.first_vertex].x = std::numeric_limits<float>::quiet_NaN();
  for (const OccluderCriterion criterion : kCriteria) {
    const Ids list = scene.list(criterion);
    EXPECT_EQ(std::count(list.begin(), list.end(), scene.useless), 0);
  }
}

TEST(ViewpointDatabase, SettingsOutOfRangeAreTakenAsTheNearestInRange) {
  const Criteria scene;
  const std::uint32_t huge = std::numeric_limits<std::uint32_t>::max();
  const Vec3d origin[] = {{0, 0, 0}};
  for (const OccluderCriterion criterion : kCriteria) {
    for (const double wild : {kNan, kInf, -kInf, 0.0, -5.0, 1e308, 1e-308}) {
      const ViewpointDatabaseSettings settings{.criterion = criterion,
                                               .spacing = wild,
                                               .max_points = huge,
                                               .directions = 0,
                                               .occluder_count = huge,
                                               .resolution = 0,
                                               .view_angle_deg = wild,
                                               .min_triangles = huge,
                                               .max_triangles = 0,
                                               .min_occluder_pixels = wild,
                                               .sets_per_occludee = huge,
                                               .search_limit = huge,
                                               .weights = {wild, wild, wild}};
      const auto database =
          ViewpointDatabase::build(scene.model.hierarchy, scene.model.set, origin, settings);
      EXPECT_EQ(database.pointCount(), 1u) << wild;
      EXPECT_EQ(database.directionCount(), 1u) << wild;
    }
  }
  // Weights that are zero leave the order to the ties, but the sets stay.
  EXPECT_EQ(scene.list(OccluderCriterion::kMinimumSets, {.weights = {0.0, 0.0, 0.0}}).size(), 2u);
  EXPECT_TRUE(scene.list(OccluderCriterion::kMinimumSets, {.sets_per_occludee = 0}).empty());
  EXPECT_TRUE(scene.list(OccluderCriterion::kMinimumSets, {.search_limit = 0}).empty());
}

TEST(ViewpointDatabase, StoresEqualListsOnce) {
  const Criteria scene;
  const Vec3d origin[] = {{0, 0, 0}};
  // Neighbouring directions have the same two occluders: their lists lie in the same place.
  const auto database = ViewpointDatabase::build(scene.model.hierarchy, scene.model.set, origin,
                                                 {.directions = 1000, .resolution = 32});
  std::set<const OccluderId*> places;
  std::size_t lists = 0;
  for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
    const auto list = database.list(0, d);
    if (!list.empty()) {
      places.insert(list.data());
      ++lists;
    }
  }
  EXPECT_GT(lists, 40u);
  EXPECT_LE(places.size(), 6u);
}

}  // namespace
}  // namespace sightline
