// What the two occluder databases save and load, and that no bytes do harm.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scenes/procedural.h"
#include "tests/occluders/database_bytes.h"

namespace sightline {
namespace {

using namespace database_bytes;

struct Model {
  OccluderSet set;
  Hierarchy kd_tree;
  Box bounds;
  std::uint32_t occluders() const { return static_cast<std::uint32_t>(set.occluders.size()); }
};

Model modelOf(const Scene& scene) {
  Model model;
  model.set = findOccluders(scene.view());
  std::vector<Box> bounds;
  for (const Object& object : scene.objects) {
    bounds.push_back(object.bounds);
    model.bounds.extend(object.bounds);
  }
  model.kd_tree = buildHierarchy(bounds, {}, {.kind = HierarchyKind::kKdTree});
  return model;
}

const Model& city() {
  static const Model kCity = modelOf(makeCity({.copies = 1}));
  return kCity;
}

const Model& building() {
  static const Model kBuilding = modelOf(makeBuilding({.floors = 2, .plants = 3}));
  return kBuilding;
}

OccluderDatabase cellsOf(const Model& model, const OccluderDatabaseSettings& settings,
                         const ParallelFor& parallel_for = serialFor) {
  return OccluderDatabase::build(model.kd_tree, model.set, settings, parallel_for);
}

ViewpointDatabase pointsOf(const Model& model, const ViewpointDatabaseSettings& settings,
                           const ParallelFor& parallel_for = serialFor) {
  return ViewpointDatabase::build(model.kd_tree, model.set, {}, settings, parallel_for);
}

const OccluderDatabaseSettings kFewCells{.directions = 6, .occluder_count = 5, .max_bytes = 8000};
const ViewpointDatabaseSettings kFewPoints{
    .max_points = 5, .directions = 6, .occluder_count = 5, .resolution = 32};

// Pieces of three, the last one first.
void backwards(std::uint32_t count, const RangeBody& body) {
  for (std::uint32_t piece = (count + 2) / 3; piece-- > 0;) {
    body(piece * 3, std::min(count, piece * 3 + 3));
  }
}

template <typename Database>
void expectSame(const Database& a, const Database& b, const Box& box) {
  ASSERT_EQ(placeCount(a), placeCount(b));
  ASSERT_EQ(a.directionCount(), b.directionCount());
  EXPECT_EQ(a.bytes(), b.bytes());
  expectSameMeasures(a, b);
  for (std::uint32_t place = 0; place < placeCount(a); ++place) {
    expectSamePlace(a, b, place);
    for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
      ASSERT_EQ(listOf(a, place, d), listOf(b, place, d)) << "place " << place << ", direction " << d;
    }
  }
  for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
    EXPECT_EQ(a.direction(d), b.direction(d));
  }
  Random random(7);
  for (const Vec3d& viewpoint : viewpoints(box, random)) {
    EXPECT_EQ(placeOf(a, viewpoint), placeOf(b, viewpoint));
    const Vec3d direction = random.point(1.0);
    EXPECT_EQ(a.nearestDirection(direction), b.nearestDirection(direction));
    EXPECT_TRUE(std::ranges::equal(a.find(viewpoint, direction), b.find(viewpoint, direction)));
  }
}

template <typename Database>
void expectToComeBack(const Database& database, const Model& model) {
  const Bytes bytes = database.save();
  const auto loaded = Database::load(bytes, model.occluders());
  ASSERT_TRUE(loaded) << loaded.error().message;
  expectSame(database, *loaded, model.bounds);
  EXPECT_EQ(loaded->save(), bytes);
}

TEST(OccluderDatabaseBytes, GiveTheSameDatabaseBack) {
  for (const Model* model : {&city(), &building()}) {
    for (const bool turned_away : {false, true}) {
      const OccluderDatabase database = cellsOf(
          *model, {.directions = 12, .occluder_count = 20, .max_bytes = 200000, .turned_away = turned_away});
      EXPECT_GT(database.cellCount(), 20u);
      expectToComeBack(database, *model);
    }
  }
}

TEST(OccluderDatabaseBytes, HoldADatabaseOfOneCell) {
  const OccluderDatabase one = cellsOf(building(), {.directions = 3, .occluder_count = 4, .max_bytes = 0});
  EXPECT_EQ(one.cellCount(), 1u);
  expectToComeBack(one, building());
  const Model nothing;
  expectToComeBack(cellsOf(nothing, {.directions = 1}), nothing);
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

TEST(DatabaseBytes, HoldTheEmptyDatabaseForAnySet) {
  expectToComeBack(OccluderDatabase(), city());
  expectToComeBack(ViewpointDatabase(), city());
  expectToComeBack(OccluderDatabase(), Model());
  expectToComeBack(ViewpointDatabase(), Model());
}

TEST(DatabaseBytes, AreTheSameWithAnyThreads) {
  EXPECT_EQ(cellsOf(city(), kFewCells).save(), cellsOf(city(), kFewCells, backwards).save());
  EXPECT_EQ(pointsOf(city(), kFewPoints).save(), pointsOf(city(), kFewPoints, backwards).save());
}

template <typename Database>
void expectRefusedForOtherSets(const Database& database, std::uint32_t occluders) {
  const Bytes bytes = database.save();
  for (const std::uint32_t count : {0u, occluders - 1, occluders + 1, 0xffffffffu}) {
    const std::string error = errorOf<Database>(bytes, count);
    EXPECT_TRUE(has(error, "is of " + std::to_string(occluders) + " occluders, but the scene has " +
                               std::to_string(count)))
        << error;
  }
}

TEST(DatabaseBytes, AreRefusedForAnotherNumberOfOccluders) {
  expectRefusedForOtherSets(cellsOf(city(), kFewCells), city().occluders());
  expectRefusedForOtherSets(pointsOf(city(), kFewPoints), city().occluders());
}

TEST(DatabaseBytes, OfOneKindAreNotTheOthers) {
  EXPECT_TRUE(has(errorOf<ViewpointDatabase>(cellsOf(city(), kFewCells).save(), city().occluders()),
                  "the viewpoint database begins with the letters of something else"));
  EXPECT_TRUE(has(errorOf<OccluderDatabase>(ViewpointDatabase().save(), 0),
                  "the occluder database begins with the letters of something else"));
}

template <typename Database>
void expectAllTruncationsRefused(const Database& database, const Model& model, const std::string& name) {
  const Bytes bytes = database.save();
  ASSERT_LT(bytes.size(), 20000u);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const std::string error = errorOf<Database>(part, model.occluders());
    const std::string expected = "the " + name + " is truncated at byte ";
    ASSERT_EQ(error.substr(0, expected.size()), expected) << size << " of " << bytes.size() << " bytes";
    EXPECT_LE(std::stoull(error.substr(expected.size())), size);
  }
}

TEST(DatabaseBytes, AreRefusedWhereverTheyAreCutOff) {
  expectAllTruncationsRefused(cellsOf(building(), kFewCells), building(), "occluder database");
  expectAllTruncationsRefused(pointsOf(building(), kFewPoints), building(), "viewpoint database");
  expectAllTruncationsRefused(OccluderDatabase(), building(), "occluder database");
  expectAllTruncationsRefused(ViewpointDatabase(), building(), "viewpoint database");
}

// One to four places: a bit, a byte, or a number of 32 or 64 bits that is likely to do harm.
void damage(Bytes& bytes, Random& random) {
  constexpr std::uint64_t kNumbers[] = {0,
                                        1,
                                        2,
                                        3,
                                        0x7fffffffu,
                                        0x80000000u,
                                        0xffffffffu,
                                        0x7f800000u,
                                        0x7fc00000u,
                                        0x2000000000000000u,
                                        0x7ff0000000000000u,
                                        ~std::uint64_t{0}};
  for (std::uint32_t times = 1 + random.below(4); times-- > 0;) {
    // Half of the time near the beginning, where the numbers of things are.
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const std::uint32_t at = random.below(random.below(2) == 0 ? std::min(size, 64u) : size);
    const std::uint32_t kind = random.below(4);
    if (kind == 0) {
      bytes[at] ^= static_cast<std::byte>(1u << random.below(8));
    } else if (kind == 1) {
      bytes[at] = static_cast<std::byte>(random.below(256));
    } else {
      const std::uint64_t number = kNumbers[random.below(std::size(kNumbers))];
      for (std::uint32_t i = 0; i < (kind == 2 ? 4u : 8u) && at + i < size; ++i) {
        bytes[at + i] = static_cast<std::byte>(number >> 8 * i & 0xff);
      }
    }
  }
}

// Bytes that pass are all of them part of what is answered: they are saved again as they were.
template <typename Database>
void expectDamageDoesNoHarm(const Database& database, std::uint32_t occluders) {
  const Bytes sound = database.save();
  std::uint32_t loaded_ones = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Bytes bytes = sound;
    damage(bytes, random);
    const auto loaded = Database::load(bytes, occluders);
    if (!loaded) {
      ++refused;
      EXPECT_FALSE(has(loaded.error().message, "\n"));
      continue;
    }
    ++loaded_ones;
    askEverything(*loaded, occluders, random);
    EXPECT_EQ(loaded->save(), bytes);
  }
  EXPECT_GT(loaded_ones, 100u);  // so that the queries were tried
  EXPECT_GT(refused, 1000u);
}

TEST(DatabaseBytes, DoNoHarmWhenDamaged) {
  const OccluderDatabase cells =
      cellsOf(building(), {.directions = 3, .occluder_count = 5, .max_bytes = 3000, .view_angle_deg = 60.0});
  EXPECT_GT(cells.cellCount(), 4u);
  expectDamageDoesNoHarm(cells, building().occluders());
  const ViewpointDatabase points = pointsOf(building(), {.criterion = OccluderCriterion::kFirstHit,
                                                         .max_points = 7,
                                                         .directions = 3,
                                                         .occluder_count = 5,
                                                         .resolution = 32});
  EXPECT_GT(points.pointCount(), 4u);
  expectDamageDoesNoHarm(points, building().occluders());
}

}  // namespace
}  // namespace sightline
