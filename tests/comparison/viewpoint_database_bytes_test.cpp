// What a viewpoint database saves and loads, and that no bytes do harm.

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "sightline/comparison/viewpoint_database.h"
#include "sightline/occluders/occluder_database.h"
#include "tests/occluders/database_bytes.h"
#include "tests/support/cut_work.h"

namespace sightline {

// Names for what both databases have: a place is what lists are made for.
inline std::uint32_t placeCount(const ViewpointDatabase& database) {
  return database.pointCount();
}
inline std::uint32_t placeOf(const ViewpointDatabase& database, const Vec3d& viewpoint) {
  return database.nearestPoint(viewpoint);
}
inline void expectSamePlace(const ViewpointDatabase& a, const ViewpointDatabase& b, std::uint32_t place) {
  EXPECT_EQ(a.point(place), b.point(place));
}
inline void expectSameMeasures(const ViewpointDatabase& a, const ViewpointDatabase& b) {
  EXPECT_EQ(a.spacing(), b.spacing());
}

namespace {

using namespace database_bytes;

ViewpointDatabase pointsOf(const Model& model, const ViewpointDatabaseSettings& settings,
                           const ParallelFor& parallel_for = serialFor) {
  return ViewpointDatabase::build(model.kd_tree, model.set, {}, settings, parallel_for);
}

const ViewpointDatabaseSettings kFewPoints{
    .max_points = 5, .directions = 6, .occluder_count = 5, .resolution = 32};

Layout twoPoints() {
  Layout layout;
  layout.letters = "vptd";
  layout.places = 2;
  layout.grid = {2.5, 1, 2, 3, 4, 5, 6};
  layout.lists.which = {0, 1, 2, 1};
  return layout;
}

TEST(ViewpointDatabaseBytes, GiveTheSameDatabaseBack) {
  for (const Model* model : {&city(), &building()}) {
    for (const OccluderCriterion criterion :
         {OccluderCriterion::kProjectedSize, OccluderCriterion::kMinimumSets}) {
      const ViewpointDatabase database =
          pointsOf(*model, {.criterion = criterion, .max_points = 30, .directions = 12, .resolution = 32});
      EXPECT_GT(database.pointCount(), 8u);
      expectToComeBack(database, *model);
    }
  }
}

TEST(ViewpointDatabaseBytes, HoldADatabaseOfOnePoint) {
  const ViewpointDatabase one = pointsOf(building(), {.max_points = 1, .directions = 1, .resolution = 32});
  EXPECT_EQ(one.pointCount(), 1u);
  expectToComeBack(one, building());
  const Model nothing;
  expectToComeBack(pointsOf(nothing, {.directions = 2, .resolution = 8}), nothing);
}

TEST(ViewpointDatabaseBytes, HoldTheEmptyDatabaseForAnySet) {
  expectToComeBack(ViewpointDatabase(), city());
  expectToComeBack(ViewpointDatabase(), Model());
}

TEST(ViewpointDatabaseBytes, AreTheSameWithAnyThreads) {
  EXPECT_EQ(pointsOf(city(), kFewPoints).save(), pointsOf(city(), kFewPoints, backwardsBy(3)).save());
}

TEST(ViewpointDatabaseBytes, AreRefusedForAnotherNumberOfOccluders) {
  expectRefusedForOtherSets(pointsOf(city(), kFewPoints), city().occluders());
}

TEST(ViewpointDatabaseBytes, OfOneKindAreNotTheOthers) {
  const OccluderDatabase cells = OccluderDatabase::build(
      city().kd_tree, city().set, {.directions = 6, .occluder_count = 5, .max_bytes = 8000});
  EXPECT_TRUE(has(errorOf<ViewpointDatabase>(cells.save(), city().occluders()),
                  "the viewpoint database begins with the letters of something else"));
  EXPECT_TRUE(has(errorOf<OccluderDatabase>(ViewpointDatabase().save(), 0),
                  "the occluder database begins with the letters of something else"));
}

TEST(ViewpointDatabaseBytes, AreRefusedWhereverTheyAreCutOff) {
  expectAllTruncationsRefused(pointsOf(building(), kFewPoints), building(), "viewpoint database");
  expectAllTruncationsRefused(ViewpointDatabase(), building(), "viewpoint database");
}

TEST(ViewpointDatabaseBytes, DoNoHarmWhenDamaged) {
  const ViewpointDatabase points = pointsOf(building(), {.criterion = OccluderCriterion::kFirstHit,
                                                         .max_points = 7,
                                                         .directions = 3,
                                                         .occluder_count = 5,
                                                         .resolution = 32});
  EXPECT_GT(points.pointCount(), 4u);
  expectDamageDoesNoHarm(points, building().occluders());
}

TEST(ViewpointDatabaseBytes, MeanWhatIsDocumented) {
  const auto loaded = ViewpointDatabase::load(twoPoints().bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->pointCount(), 2u);
  EXPECT_EQ(loaded->directionCount(), 2u);
  EXPECT_EQ(loaded->spacing(), 2.5);
  EXPECT_EQ(loaded->point(0), Vec3d(1, 2, 3));
  EXPECT_EQ(loaded->point(1), Vec3d(4, 5, 6));
  EXPECT_EQ(loaded->nearestPoint({5, 5, 5}), 1u);
  EXPECT_EQ(listOf(*loaded, 0, 0), Ids());
  EXPECT_EQ(listOf(*loaded, 0, 1), idsOf({9, 0}));
  EXPECT_EQ(listOf(*loaded, 1, 0), idsOf({5}));
  EXPECT_EQ(listOf(*loaded, 1, 1), idsOf({9, 0}));
  EXPECT_EQ(loaded->save(), twoPoints().bytes());
}

TEST(ViewpointDatabaseBytes, AreRefusedWithFaults) {
  expectRefused<ViewpointDatabase>(twoPoints(), faultsOfBoth());
  const std::string no_spacing = "has no spacing", no_point = "has a point that is not finite";
  const std::vector<Fault> faults{
      {"has 0 points", [](Layout& l) { l.places = 0; }}, {no_spacing, [](Layout& l) { l.grid[0] = 0.0; }},
      {no_spacing, [](Layout& l) { l.grid[0] = -1.0; }}, {no_spacing, [](Layout& l) { l.grid[0] = kNan; }},
      {no_spacing, [](Layout& l) { l.grid[0] = kInf; }}, {no_point, [](Layout& l) { l.grid[1] = kNan; }},
      {no_point, [](Layout& l) { l.grid[6] = -kInf; }},
  };
  expectRefused<ViewpointDatabase>(twoPoints(), faults);
}

// Points at the largest numbers: their differences are not finite.
TEST(ViewpointDatabaseBytes, MayHoldPointsAtTheEndOfNumbers) {
  constexpr double kMax = std::numeric_limits<double>::max();
  Layout layout = twoPoints();
  layout.grid = {kMax, -kMax, -kMax, -kMax, kMax, kMax, kMax};
  const auto loaded = ViewpointDatabase::load(layout.bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  Random random(1);
  askEverything(*loaded, 10, random);
}

// More than it builds.
TEST(ViewpointDatabaseBytes, AreRefusedWithTooManyPoints) {
  Layout layout = twoPoints();
  layout.directions = 1;
  layout.places = 65537;
  layout.grid.assign(1 + 3 * 65537, 1.0);
  layout.lists.which.assign(65537, 1);
  layout.lists.which.back() = 2;
  EXPECT_EQ(errorOf<ViewpointDatabase>(layout.bytes(), 10), "the viewpoint database has 65537 points");
  layout.places = 65536;
  layout.grid.resize(layout.grid.size() - 3);
  layout.lists.which.erase(layout.lists.which.begin());
  EXPECT_EQ(errorOf<ViewpointDatabase>(layout.bytes(), 10), "none");
}

}  // namespace
}  // namespace sightline
