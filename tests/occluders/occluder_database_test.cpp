#include "sightline/occluders/occluder_database.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numbers>
#include <set>

#include "scenes/procedural.h"
#include "tests/occluders/flat_mesh.h"
#include "tests/support/cut_work.h"
#include "tests/support/object_arrays.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace flat_mesh;

constexpr AreaAngleDirection kAreaAngles[] = {AreaAngleDirection::kView, AreaAngleDirection::kOccluder};
constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Model {
  OccluderSet set;
  std::vector<Box> bounds;  // by object
  Hierarchy kd_tree;

  void buildTree() { kd_tree = buildHierarchy(bounds, {}, {.kind = HierarchyKind::kKdTree}); }
};

Model modelOf(const Scene& scene) {
  Model model;
  model.set = findOccluders(scene.view());
  model.bounds = test::boxesOf(scene.objects);
  model.buildTree();
  return model;
}

// Makes rectangles of all sizes, one per object; some are duplicated, so that scores tie.
Model crowd(Random& random, std::uint32_t count, double extent = 30.0) {
  std::vector<std::vector<Vec3f>> polygons;
  std::vector<OccluderPolygon> input;
  Model model;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Placement place = anyPlacement(random, extent);
    const double w = random.in(0.1, 5.0), h = random.in(0.1, 5.0);
    std::vector<Vec3f> corners;
    for (const Point2& p : {Point2{0, 0}, Point2{w, 0}, Point2{w, h}, Point2{0, h}}) {
      corners.push_back(place(p));
    }
    polygons.push_back(corners);
    if (random.below(8) == 0) {
      polygons.push_back(corners);
    }
  }
  for (const std::vector<Vec3f>& corners : polygons) {
    input.push_back({corners, random.below(2) == 0, ObjectId(input.size())});
    Box& box = model.bounds.emplace_back();
    for (const Vec3f& corner : corners) {
      box.extend(corner);
    }
  }
  model.set = makeOccluders(input);
  model.buildTree();
  return model;
}

const Model& smallCity() {
  static const Model kCity = modelOf(makeCity({.copies = 1}));
  return kCity;
}

const Model& smallBuilding() {
  static const Model kBuilding = modelOf(makeBuilding({.floors = 2, .plants = 3}));
  return kBuilding;
}

double angleBetween(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

std::vector<Vec3d> cornersOf(const Box& box) {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                         i & 4 ? box.max.z : box.min.z);
  }
  return corners;
}

Vec3d pointIn(const Box& box, Random& random) {
  Vec3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = random.in(box.min[axis], box.max[axis]);
  }
  return point;
}

// Computes the score from its definition in the documentation; 0: not in the cone, or not visible.
double scoreOf(const OccluderSet& set, const Occluder& occluder, const OccluderDatabase& database,
               const Box& cell, const Vec3d& direction, const OccluderDatabaseSettings& settings) {
  const Vec3d centroid(occluder.centroid), middle = center(cell), to_polygon = centroid - middle;
  double radius = 0.5 * length(Vec3d(cell.max) - Vec3d(cell.min)), polygon_radius = 0.0;
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    polygon_radius = std::max(polygon_radius, length(Vec3d(vertex) - centroid));
  }
  radius += polygon_radius;
  const double w = database.coveringAngleRad();
  if (radius < length(to_polygon) &&
      angleBetween(to_polygon, direction) >
          settings.view_angle_deg * kPi / 360.0 + w + std::asin(radius / length(to_polygon))) {
    return 0.0;
  }
  const Vec3d nearest = max(Vec3d(cell.min), min(Vec3d(cell.max), centroid));
  const double r0 = length(nearest - centroid);
  double best = 0.0;
  for (const double side : {1.0, -1.0}) {
    double in_front = -kInf, h0 = -kInf;
    for (const Vec3d& corner : cornersOf(cell)) {
      in_front = std::max(in_front, side * occluder.plane.evaluate(corner));
      h0 = std::max(h0, side * dot(occluder.plane.normal, corner - centroid));
    }
    if (in_front <= 0.0 || (side < 0.0 && !occluder.double_sided)) {
      continue;
    }
    const double to_normal = angleBetween(direction, -side * occluder.plane.normal);
    const double cosine = settings.area_angle_direction == AreaAngleDirection::kView
                              ? std::cos(std::max(0.0, to_normal - w))
                              : std::min(1.0, h0 / r0);
    if (cosine > 0.0) {
      best = std::max(best, std::min(2.0 * kPi, cosine * occluder.area / (r0 * r0)));
    }
  }
  return best;
}

bool closeTo(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

// Compares a list with sorting all occluders. Scores may differ by rounding, and so may the order of near
// ties. Occluders with the largest possible score tie exactly and must be in the order of their ids.
::testing::AssertionResult holdsTheBest(const Model& model, const OccluderDatabase& database,
                                        std::uint32_t cell, std::uint32_t direction,
                                        const OccluderDatabaseSettings& settings) {
  std::vector<double> score_of, sorted;
  std::vector<OccluderId> capped;
  for (const Occluder& occluder : model.set.occluders) {
    const double score = scoreOf(model.set, occluder, database, database.cellRegion(cell),
                                 database.direction(direction), settings);
    if (score == 2.0 * kPi) {
      capped.push_back(OccluderId(score_of.size()));
    }
    score_of.push_back(score);
    if (score > 0.0) {
      sorted.push_back(score);
    }
  }
  std::sort(sorted.rbegin(), sorted.rend());
  const std::span<const OccluderId> list = database.list(cell, direction);
  const std::size_t expected = std::min<std::size_t>(sorted.size(), settings.occluder_count);
  if (list.size() != expected) {
    return ::testing::AssertionFailure() << list.size() << " entries instead of " << expected;
  }
  std::set<OccluderId> different;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double score = score_of[list[i].value];
    if (!closeTo(score, sorted[i])) {
      return ::testing::AssertionFailure()
             << "entry " << i << " has score " << score << " instead of " << sorted[i];
    }
    if (i < capped.size() && list[i] != capped[i]) {
      return ::testing::AssertionFailure() << "entry " << i << " should be the next of those that tie";
    }
    different.insert(list[i]);
  }
  if (different.size() != list.size()) {
    return ::testing::AssertionFailure() << "entries twice";
  }
  return ::testing::AssertionSuccess();
}

bool sameDatabase(const OccluderDatabase& a, const OccluderDatabase& b) {
  if (a.cellCount() != b.cellCount() || a.directionCount() != b.directionCount() || a.bytes() != b.bytes()) {
    return false;
  }
  for (std::uint32_t cell = 0; cell < a.cellCount(); ++cell) {
    if (a.cellRegion(cell) != b.cellRegion(cell)) {
      return false;
    }
    for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
      const auto left = a.list(cell, d), right = b.list(cell, d);
      if (!std::equal(left.begin(), left.end(), right.begin(), right.end())) {
        return false;
      }
    }
  }
  return true;
}

TEST(OccluderDatabase, ListsHoldTheBestOfAllOccluders) {
  std::size_t full = 0, partly = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    Random random(seed);
    const Model model = crowd(random, 20 + random.below(250), seed % 3 == 0 ? 200.0 : 30.0);
    for (const AreaAngleDirection area_angle : kAreaAngles) {
      const OccluderDatabaseSettings settings{
          .directions = 1 + random.below(40),
          .occluder_count = 1 + random.below(40),
          .max_bytes = std::size_t{1} << (10 + random.below(10)),
          .view_angle_deg = random.in(1.0, seed % 4 == 0 ? 360.0 : 120.0),
          .area_angle_direction = area_angle,
      };
      const OccluderDatabase database = OccluderDatabase::build(model.kd_tree, model.set, settings);
      for (std::uint32_t i = 0; i < 60; ++i) {
        const std::uint32_t cell = random.below(database.cellCount());
        const std::uint32_t direction = random.below(database.directionCount());
        EXPECT_TRUE(holdsTheBest(model, database, cell, direction, settings))
            << "seed " << seed << " cell " << cell << " direction " << direction;
        const bool is_full = database.list(cell, direction).size() == settings.occluder_count;
        full += is_full ? 1 : 0;
        partly += is_full ? 0 : 1;
      }
    }
  }
  EXPECT_GT(full, 100u);
  EXPECT_GT(partly, 100u);
}

TEST(OccluderDatabase, ListsHoldTheBestOfAllOccludersOfDemoScenes) {
  for (const Model* model : {&smallCity(), &smallBuilding()}) {
    for (const AreaAngleDirection area_angle : kAreaAngles) {
      const OccluderDatabaseSettings settings{
          .occluder_count = 48, .max_bytes = 1u << 20, .area_angle_direction = area_angle};
      const OccluderDatabase database = OccluderDatabase::build(model->kd_tree, model->set, settings);
      ASSERT_GT(database.cellCount(), 50u);
      Random random(7);
      for (std::uint32_t i = 0; i < test::rounds(150u); ++i) {
        const std::uint32_t cell = random.below(database.cellCount());
        const std::uint32_t direction = random.below(database.directionCount());
        EXPECT_TRUE(holdsTheBest(*model, database, cell, direction, settings))
            << "cell " << cell << " direction " << direction;
      }
    }
  }
}

TEST(OccluderDatabase, GivesListsToBeRanked) {
  const OccluderDatabase database = OccluderDatabase::build(
      smallCity().kd_tree, smallCity().set, {.directions = 8, .occluder_count = 4, .max_bytes = 10000});
  const OccluderLists& lists = database;
  EXPECT_FALSE(lists.inOrder());
  const Vec3d eye(1.0, 2.0, 3.0), direction(1.0, 0.0, 0.5);
  EXPECT_TRUE(std::ranges::equal(lists.find(eye, direction),
                                 database.list(database.cellOf(eye), database.nearestDirection(direction))));
}

// Whether a corner or the centroid of the polygon is in the cone.
bool surelyInCone(const Model& model, const Occluder& occluder, const View& view, double half_angle) {
  const std::span<const Vec3f> corners = model.set.verticesOf(occluder);
  return angleBetween(Vec3d(occluder.centroid) - view.eye, view.forward) <= half_angle ||
         std::any_of(corners.begin(), corners.end(), [&](const Vec3f& corner) {
           return angleBetween(Vec3d(corner) - view.eye, view.forward) <= half_angle;
         });
}

TEST(OccluderDatabase, LosesNoneThatIsWorthMoreFromSomeViewpointThanTheLastEntry) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(30u); ++seed) {
    Random random(seed);
    const Model any = crowd(random, 300);
    const Model& model = seed % 3 == 0 ? smallCity() : seed % 3 == 1 ? smallBuilding() : any;
    for (const AreaAngleDirection area_angle : kAreaAngles) {
      const OccluderDatabaseSettings settings{.directions = 1 + random.below(60),
                                              .occluder_count = 20 + random.below(60),
                                              .max_bytes = 1u << 20,
                                              .area_angle_direction = area_angle};
      const OccluderDatabase database = OccluderDatabase::build(model.kd_tree, model.set, settings);
      for (std::uint32_t i = 0; i < 30; ++i) {
        const std::uint32_t cell = random.below(database.cellCount());
        const Box region = database.cellRegion(cell);
        View view;
        view.eye = i % 3 == 0 ? cornersOf(region)[random.below(8)] : pointIn(region, random);
        setOrientation(view, random.point(1.0), {0, 1, 0});
        const std::uint32_t direction = database.nearestDirection(view.forward);
        const std::span<const OccluderId> list = database.list(cell, direction);
        const double last = list.size() < settings.occluder_count
                                ? 0.0
                                : scoreOf(model.set, model.set[list.back()], database, region,
                                          database.direction(direction), settings);
        for (std::size_t o = 0; o < model.set.occluders.size(); ++o) {
          const Occluder& occluder = model.set.occluders[o];
          const double worth = std::min(2.0 * kPi, areaAngle(occluder, view, area_angle));
          if (worth > last * (1.0 + 1e-9) + 1e-12 &&
              surelyInCone(model, occluder, view, settings.view_angle_deg * kPi / 360.0)) {
            ++checked;
            EXPECT_TRUE(std::find(list.begin(), list.end(), OccluderId(o)) != list.end())
                << "seed " << seed << " view " << i << " occluder " << o;
          }
        }
      }
    }
  }
  EXPECT_GT(checked, test::rounds(2000u));
}

TEST(OccluderDatabase, LeavesOutWhatIsSeenFromBehindOrNotInTheCone) {
  // A wall before the only cell, facing it or not, hiding on both sides or not.
  const std::vector<Vec3f> facing{{-4, -4, -20}, {4, -4, -20}, {4, 4, -20}, {-4, 4, -20}};
  const std::vector<Vec3f> averted(facing.rbegin(), facing.rend());
  const Hierarchy tree =
      buildHierarchy(std::vector<Box>{{{-1, -1, -1}, {1, 1, 1}}}, {}, {.kind = HierarchyKind::kKdTree});
  const auto countOf = [&](const std::vector<Vec3f>& wall, bool double_sided, const Vec3d& direction) {
    const OccluderPolygon polygon{wall, double_sided, ObjectId(0u)};
    const OccluderDatabaseSettings settings{.directions = 200, .view_angle_deg = 60.0};
    const OccluderSet set = makeOccluders(std::span(&polygon, 1));
    return OccluderDatabase::build(tree, set, settings).find({0, 0, 0}, direction).size();
  };
  EXPECT_EQ(countOf(facing, false, {0, 0, -1}), 1u);
  EXPECT_EQ(countOf(averted, false, {0, 0, -1}), 0u);
  EXPECT_EQ(countOf(facing, true, {0, 0, -1}), 1u);
  EXPECT_EQ(countOf(averted, true, {0, 0, -1}), 1u);
  // 30 degrees of the cone, 17 that the wall and the cell take up, and twice the directions' distance.
  EXPECT_EQ(countOf(facing, true, {1, 0, -1}), 1u);
  EXPECT_EQ(countOf(facing, true, {1, 0, 0}), 0u);
  EXPECT_EQ(countOf(facing, true, {0, 0, 1}), 0u);
}

// Databases without occluders, of which only the directions are tested.
OccluderDatabase onlyDirections(std::uint32_t count) {
  return OccluderDatabase::build({}, {}, {.directions = count});
}

TEST(OccluderDatabaseDirections, NearestIsWhatTryingAllOfThemFinds) {
  for (const std::uint32_t count : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 12u, 32u, 33u, 100u, 1000u, 4096u}) {
    const OccluderDatabase database = onlyDirections(count);
    ASSERT_EQ(database.directionCount(), count);
    Random random(count);
    std::vector<Vec3d> directions;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      directions.push_back(random.point(1.0) * std::pow(10.0, random.in(-12.0, 12.0)));
      // Between two, where the nearest changes, and along edges and diagonals of a cube.
      const Vec3d a = database.direction(random.below(count)), b = database.direction(random.below(count));
      directions.push_back(a + b + random.point(1e-7));
      directions.emplace_back(random.below(3) - 1.0, random.below(3) - 1.0, random.below(3) - 1.0);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      directions.push_back(database.direction(i));
      EXPECT_NEAR(length(database.direction(i)), 1.0, 1e-14);
      EXPECT_EQ(database.nearestDirection(database.direction(i)), i);
    }
    for (const Vec3d& direction : directions) {
      if (maxComponent(abs(direction)) == 0.0) {
        continue;
      }
      const Vec3d unit = normalized(direction);
      double best = -2.0;
      std::uint32_t first_best = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const double cosine = dot(database.direction(i), unit);
        if (cosine > best) {
          best = cosine;
          first_best = i;
        }
      }
      const std::uint32_t found = database.nearestDirection(direction);
      const double cosine = dot(database.direction(found), unit);
      EXPECT_TRUE(found == first_best || cosine > best - 4e-16)
          << count << " directions: " << found << " instead of " << first_best;
    }
  }
}

TEST(OccluderDatabaseDirections, AreEvenlySpread) {
  for (const std::uint32_t count : {8u, 16u, 32u, 64u, 100u, 500u, 2000u}) {
    const OccluderDatabase database = onlyDirections(count);
    double smallest = kPi, largest = 0.0;
    Vec3d sum;
    for (std::uint32_t i = 0; i < count; ++i) {
      double nearest = kPi;
      for (std::uint32_t j = 0; j < count; ++j) {
        nearest =
            i == j ? nearest : std::min(nearest, angleBetween(database.direction(i), database.direction(j)));
      }
      smallest = std::min(smallest, nearest);
      largest = std::max(largest, nearest);
      sum += database.direction(i);
    }
    EXPECT_LT(largest / smallest, 1.6) << count;  // of the distances to the nearest
    EXPECT_LT(length(sum) / count, 0.1) << count;
    // A hexagonal grid of as many points, the most even one, has about 1.9 / sqrt(count).
    EXPECT_LT(database.coveringAngleRad(), 3.3 / std::sqrt(count)) << count;
  }
}

TEST(OccluderDatabaseDirections, NoneIsFartherFromItsNearestThanTheCoveringAngle) {
  for (const std::uint32_t count : {1u, 2u, 3u, 4u, 5u, 7u, 32u, 100u, 1000u}) {
    const OccluderDatabase database = onlyDirections(count);
    Random random(count);
    double largest = 0.0;
    for (std::uint32_t i = 0; i < 200'000; ++i) {
      const Vec3d direction = random.point(1.0);
      largest = std::max(largest,
                         angleBetween(direction, database.direction(database.nearestDirection(direction))));
    }
    EXPECT_LE(largest, database.coveringAngleRad()) << count;
    EXPECT_GT(largest, database.coveringAngleRad() - 0.1 / std::sqrt(count)) << count;
  }
}

TEST(OccluderDatabaseDirections, WhatIsNoneHasTheFirst) {
  const OccluderDatabase database = onlyDirections(32);
  EXPECT_EQ(database.nearestDirection({0, 0, 0}), 0u);
  for (const double bad : {kNan, kInf, -kInf}) {
    EXPECT_EQ(database.nearestDirection({bad, 0, 0}), 0u);
    EXPECT_EQ(database.nearestDirection({1, bad, 1}), 0u);
    EXPECT_EQ(database.nearestDirection({bad, bad, bad}), 0u);
  }
  const Vec3d direction(0.3, -0.8, 0.1);
  EXPECT_EQ(database.nearestDirection(direction * 1e300), database.nearestDirection(direction));
  EXPECT_EQ(database.nearestDirection(direction * 1e-300), database.nearestDirection(direction));
  EXPECT_EQ(onlyDirections(0).directionCount(), 1u);
  EXPECT_EQ(onlyDirections(4'294'967'295u).directionCount(), 4096u);
}

// A cell contains its lower borders but not its upper ones, except for those of the whole space.
bool holds(const Box& region, const Box& whole, const Vec3d& point) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool at_end = region.max[axis] == whole.max[axis] && point[axis] == whole.max[axis];
    if (!(point[axis] >= region.min[axis] && (point[axis] < region.max[axis] || at_end))) {
      return false;
    }
  }
  return true;
}

Box wholeOf(const OccluderDatabase& database) {
  Box whole;
  for (std::uint32_t cell = 0; cell < database.cellCount(); ++cell) {
    whole.extend(database.cellRegion(cell));
  }
  return whole;
}

std::vector<const Model*> severalModels() {
  static std::vector<Model> models;
  if (models.empty()) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      Random random(seed);
      models.push_back(crowd(random, 5 + random.below(200), seed % 2 == 0 ? 100.0 : 5.0));
    }
  }
  std::vector<const Model*> all{&smallCity(), &smallBuilding()};
  for (const Model& model : models) {
    all.push_back(&model);
  }
  return all;
}

TEST(OccluderDatabaseCells, TileTheScene) {
  Random random(3);
  for (const Model* model : severalModels()) {
    for (const std::size_t bytes : {std::size_t{1} << 14, std::size_t{1} << 30}) {
      const OccluderDatabase database = OccluderDatabase::build(
          model->kd_tree, model->set, {.directions = 2, .occluder_count = 4, .max_bytes = bytes});
      const Box whole = wholeOf(database);
      EXPECT_TRUE(contains(whole, model->kd_tree.nodes[0].bounds));
      double volume = 0.0;
      std::vector<Vec3d> points;
      for (std::uint32_t cell = 0; cell < database.cellCount(); ++cell) {
        const Box region = database.cellRegion(cell);
        const Vec3d extent = Vec3d(region.max) - Vec3d(region.min);
        volume += extent.x * extent.y * extent.z;
        if (cell % 16 == 0) {
          for (const Vec3d& corner : cornersOf(region)) {
            points.push_back(corner);  // on split planes, or on the border
          }
          points.push_back(pointIn(region, random));
        }
      }
      const Vec3d extent = Vec3d(whole.max) - Vec3d(whole.min);
      EXPECT_TRUE(std::abs(volume / (extent.x * extent.y * extent.z) - 1.0) < 1e-9);
      for (const Vec3d& point : points) {
        for (std::uint32_t cell = 0; cell < database.cellCount(); ++cell) {
          ASSERT_EQ(holds(database.cellRegion(cell), whole, point), cell == database.cellOf(point));
        }
      }
    }
  }
}

TEST(OccluderDatabaseCells, AreTheLeavesWhenMemoryIsPlenty) {
  for (const Model* model : severalModels()) {
    const Hierarchy& tree = model->kd_tree;
    const OccluderDatabase database = OccluderDatabase::build(
        tree, model->set, {.directions = 1, .occluder_count = 1, .max_bytes = std::size_t{1} << 30});
    std::vector<Box> regions;
    for (std::uint32_t cell = 0; cell < database.cellCount(); ++cell) {
      regions.push_back(database.cellRegion(cell));
    }
    std::size_t leaves = 0;
    for (const HierarchyNode& node : tree.nodes) {
      if (node.leaf()) {
        ++leaves;
        EXPECT_TRUE(std::any_of(regions.begin(), regions.end(),
                                [&](const Box& region) { return contains(region, node.bounds); }));
      }
    }
    EXPECT_EQ(database.cellCount(), leaves);
  }
}

TEST(OccluderDatabaseCells, GoOnToInfinityAndHaveAnAnswerForNan) {
  for (const Model* model : severalModels()) {
    const OccluderDatabase database =
        OccluderDatabase::build(model->kd_tree, model->set, {.max_bytes = 1u << 18});
    const Box whole = wholeOf(database);
    Random random(5);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const Vec3d point = random.point(1.0) * std::pow(10.0, random.in(0.0, 30.0));
      const Vec3d inside = max(Vec3d(whole.min), min(Vec3d(whole.max), point));
      EXPECT_EQ(database.cellOf(point), database.cellOf(inside));
      const std::span<const OccluderId> list = database.find(point, {1, 0, 0});
      EXPECT_EQ(list.data(),
                database.list(database.cellOf(inside), database.nearestDirection({1, 0, 0})).data());
    }
    for (const double bad : {kNan, kInf, -kInf}) {
      EXPECT_LT(database.cellOf({bad, bad, bad}), database.cellCount());
      EXPECT_LT(database.cellOf({0, bad, 0}), database.cellCount());
    }
  }
}

TEST(OccluderDatabaseCells, DoNotMindObjectsWithBrokenBoxes) {
  Random random(11);
  Model model = crowd(random, 100);
  const OccluderDatabase good = OccluderDatabase::build(model.kd_tree, model.set);
  EXPECT_GT(good.cellCount(), 20u);
  const float inf = std::numeric_limits<float>::infinity();
  model.bounds.push_back({});
  model.bounds.push_back({{-inf, 0, 0}, {inf, 1, 1}});
  model.buildTree();
  EXPECT_TRUE(sameDatabase(good, OccluderDatabase::build(model.kd_tree, model.set)));
  // Nor does it matter how many there are.
  model.bounds.resize(model.bounds.size() + 70'000);
  model.buildTree();
  EXPECT_TRUE(sameDatabase(good, OccluderDatabase::build(model.kd_tree, model.set)));
}

TEST(OccluderDatabaseCells, AreOneWhereNothingSeparatesTheObjects) {
  const std::vector<Box> same(70'000, Box{{-1, -1, -1}, {1, 1, 1}});
  const Hierarchy tree = buildHierarchy(same, {}, {.kind = HierarchyKind::kKdTree});
  Random random(13);
  const Model model = crowd(random, 50);
  EXPECT_EQ(OccluderDatabase::build(tree, model.set).cellCount(), 1u);
}

TEST(OccluderDatabase, KeepsToItsSizeLimit) {
  for (const Model* model : severalModels()) {
    std::uint32_t fewer = 0;
    for (std::size_t bytes = 0; bytes <= 16u << 20; bytes = bytes == 0 ? 1000 : bytes * 3) {
      const OccluderDatabaseSettings settings{.directions = 16, .occluder_count = 20, .max_bytes = bytes};
      const OccluderDatabase database = OccluderDatabase::build(model->kd_tree, model->set, settings);
      EXPECT_GE(database.cellCount(), std::max(fewer, 1u));
      fewer = database.cellCount();
      EXPECT_EQ(database.directionCount(), settings.directions);
      if (database.cellCount() > 1) {
        EXPECT_LE(database.bytes(), bytes);
      }
      // The limit is used: of the leaves, no more are missing than need be.
      const std::size_t leaves = (model->kd_tree.nodes.size() + 1) / 2;
      const std::size_t a_cell = settings.directions * (settings.occluder_count * 4 + 16) + 64;
      EXPECT_TRUE(database.cellCount() == leaves || (database.cellCount() + 1) * a_cell + 10'000 > bytes);
    }
  }
}

TEST(OccluderDatabase, IsTheSameForAllThreadsAndCuts) {
  const Model& model = smallCity();
  for (const AreaAngleDirection area_angle : kAreaAngles) {
    const OccluderDatabaseSettings settings{
        .occluder_count = 32, .max_bytes = 1u << 20, .area_angle_direction = area_angle};
    const OccluderDatabase serial = OccluderDatabase::build(model.kd_tree, model.set, settings);
    const auto sameWith = [&](const ParallelFor& parallel_for) {
      double last = 0.0;
      std::atomic<int> inside{0};
      const Progress progress = [&](double fraction) {
        EXPECT_EQ(++inside, 1);
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1.0);
        last = fraction;
        --inside;
      };
      const bool same = sameDatabase(
          serial, OccluderDatabase::build(model.kd_tree, model.set, settings, parallel_for, progress));
      EXPECT_EQ(last, 1.0);
      return same;
    };
    EXPECT_TRUE(sameWith(serialFor));
    for (const std::uint32_t step : {1u, 7u, 100u}) {
      EXPECT_TRUE(sameWith(backwardsBy(step))) << "step " << step;
    }
    EXPECT_TRUE(sameWith(onThreads(4)));
  }
}

TEST(OccluderDatabase, AnswersWithoutObjectsOrOccluders) {
  const auto isEmptyEverywhere = [](const OccluderDatabase& database) {
    Random random(1);
    bool empty = true;
    for (std::uint32_t i = 0; i < 100; ++i) {
      empty &= database.find(random.point(100.0), random.point(1.0)).empty();
    }
    return empty && database.find({kNan, 0, 0}, {0, 0, 0}).empty() && database.bytes() > 0;
  };
  const OccluderDatabase none;
  EXPECT_EQ(none.cellCount(), 1u);
  EXPECT_EQ(none.directionCount(), 1u);
  EXPECT_NEAR(length(none.direction(0)), 1.0, 1e-15);
  EXPECT_TRUE(isEmptyEverywhere(none));

  double last = 0.0;
  const OccluderDatabase empty_scene =
      OccluderDatabase::build({}, {}, {}, serialFor, [&](double fraction) { last = fraction; });
  EXPECT_EQ(empty_scene.cellCount(), 1u);
  EXPECT_TRUE(isEmptyEverywhere(empty_scene));
  EXPECT_EQ(last, 1.0);

  const Model& city = smallCity();
  EXPECT_TRUE(isEmptyEverywhere(OccluderDatabase::build(city.kd_tree, {})));
  EXPECT_TRUE(isEmptyEverywhere(OccluderDatabase::build(city.kd_tree, city.set, {.occluder_count = 0})));
}

TEST(OccluderDatabase, IsOneCellForOneObjectAndForWhatIsNoKdTree) {
  Random random(2);
  const Model model = crowd(random, 80);
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Box> one{{{0, 0, 0}, {1, 2, 3}}}, point{{{1, 1, 1}, {1, 1, 1}}};
  const std::vector<Box> broken{{{-inf, -inf, -inf}, {inf, inf, inf}}, {}};
  const HierarchySettings kd{.kind = HierarchyKind::kKdTree};
  const Hierarchy bvh = buildHierarchy(model.bounds, {}, {.kind = HierarchyKind::kBvh});
  for (const Hierarchy& tree : {buildHierarchy(one, {}, kd), buildHierarchy(point, {}, kd),
                                buildHierarchy(broken, {}, kd), Hierarchy{}, bvh}) {
    const OccluderDatabaseSettings settings{.directions = 6, .occluder_count = 10};
    const OccluderDatabase database = OccluderDatabase::build(tree, model.set, settings);
    ASSERT_EQ(database.cellCount(), 1u);
    EXPECT_TRUE(database.cellRegion(0).wellFormed());
    for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
      EXPECT_TRUE(holdsTheBest(model, database, 0, d, settings));
    }
  }
}

}  // namespace
}  // namespace sightline
