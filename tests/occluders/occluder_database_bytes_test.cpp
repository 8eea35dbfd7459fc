// Saving and loading an occluder database, with valid and with malformed bytes.

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "sightline/occluders/occluder_database.h"
#include "tests/occluders/database_bytes.h"
#include "tests/support/cut_work.h"

namespace sightline {

// Names for what both databases have: a place is what lists are made for.
inline std::uint32_t placeCount(const OccluderDatabase& database) {
  return database.cellCount();
}
inline std::uint32_t placeOf(const OccluderDatabase& database, const Vec3d& viewpoint) {
  return database.cellOf(viewpoint);
}
inline void expectSamePlace(const OccluderDatabase& a, const OccluderDatabase& b, std::uint32_t place) {
  EXPECT_EQ(a.cellRegion(place), b.cellRegion(place));
}
inline void expectSameMeasures(const OccluderDatabase& a, const OccluderDatabase& b) {
  EXPECT_EQ(a.coveringAngleRad(), b.coveringAngleRad());
}

namespace {

using namespace database_bytes;

constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();

OccluderDatabase cellsOf(const Model& model, const OccluderDatabaseSettings& settings,
                         const ParallelFor& parallel_for = serialFor) {
  return OccluderDatabase::build(model.kd_tree, model.set, settings, parallel_for);
}

const OccluderDatabaseSettings kFewCells{.directions = 6, .occluder_count = 5, .max_bytes = 8000};

// Cells: x < 4; x >= 4 and y < 2; the rest.
Layout threeCells() {
  Layout layout;
  layout.letters = "occd";
  layout.places = 3;
  layout.box = {0, 0, 0, 8, 8, 8};
  layout.nodes = {{0, 4.0f, 1}, {}, {1, 2.0f, 3}, {}, {}};
  layout.lists.which = {0, 1, 2, 1, 0, 2};
  return layout;
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

TEST(OccluderDatabaseBytes, HoldTheEmptyDatabaseForAnySet) {
  expectToComeBack(OccluderDatabase(), city());
  expectToComeBack(OccluderDatabase(), Model());
}

TEST(OccluderDatabaseBytes, AreTheSameWithAnyThreads) {
  EXPECT_EQ(cellsOf(city(), kFewCells).save(), cellsOf(city(), kFewCells, backwardsBy(3)).save());
}

TEST(OccluderDatabaseBytes, AreRefusedForAnotherNumberOfOccluders) {
  expectRefusedForOtherSets(cellsOf(city(), kFewCells), city().occluders());
}

TEST(OccluderDatabaseBytes, AreRefusedWhereverTheyAreCutOff) {
  expectAllTruncationsRefused(cellsOf(building(), kFewCells), building(), "occluder database");
  expectAllTruncationsRefused(OccluderDatabase(), building(), "occluder database");
}

TEST(OccluderDatabaseBytes, DoNoHarmWhenDamaged) {
  const OccluderDatabase cells =
      cellsOf(building(), {.directions = 3, .occluder_count = 5, .max_bytes = 3000, .view_angle_deg = 60.0});
  EXPECT_GT(cells.cellCount(), 4u);
  expectDamageDoesNoHarm(cells, building().occluders());
}

TEST(OccluderDatabaseBytes, MeanWhatIsDocumented) {
  const auto loaded = OccluderDatabase::load(threeCells().bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->cellCount(), 3u);
  EXPECT_EQ(loaded->directionCount(), 2u);
  EXPECT_EQ(loaded->cellOf({3.9, 7, 1}), 0u);
  EXPECT_EQ(loaded->cellOf({4.0, 1.9, 1}), 1u);
  EXPECT_EQ(loaded->cellOf({4.1, 2.0, 1}), 2u);
  EXPECT_EQ(loaded->cellRegion(0), (Box{{0, 0, 0}, {4, 8, 8}}));
  EXPECT_EQ(loaded->cellRegion(1), (Box{{4, 0, 0}, {8, 2, 8}}));
  EXPECT_EQ(loaded->cellRegion(2), (Box{{4, 2, 0}, {8, 8, 8}}));
  const Ids two = idsOf({9, 0}), one = idsOf({5});
  const Ids expected[] = {{}, two, one, two, {}, one};
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(listOf(*loaded, i / 2, i % 2), expected[i]) << "list " << i;
  }
  EXPECT_EQ(loaded->save(), threeCells().bytes());
}

TEST(OccluderDatabaseBytes, AreRefusedWithFaults) {
  expectRefused<OccluderDatabase>(threeCells(), faultsOfBoth());
  const std::string no_tree = "not a tree of finite boxes", no_split = "not divided into two";
  constexpr float kInfFloat = std::numeric_limits<float>::infinity();
  const std::vector<Fault> faults{
      {"has 0 cells", [](Layout& l) { l.places = 0; }},
      {no_tree, [](Layout& l) { l.box[0] = kNanFloat; }},
      {no_tree, [](Layout& l) { l.box[5] = kInfFloat; }},
      {no_tree, [](Layout& l) { l.box[4] = -1.0f; }},
      {no_tree,
       [](Layout& l) {
         l.nodes[1] = {4, 1.0f, 3};
       }},
      {no_tree, [](Layout& l) { l.nodes[0] = {}; }},       // the others have no parent
      {no_split, [](Layout& l) { l.nodes[0].link = 0; }},  // its own child
      {no_split, [](Layout& l) { l.nodes[2].link = 2; }},  // the same
      {no_split, [](Layout& l) { l.nodes[2].link = 0; }},  // a cycle
      {no_split, [](Layout& l) { l.nodes[2].link = 1; }},  // a cycle, and two parents
      {no_split,
       [](Layout& l) {
         l.nodes[1] = {1, 2.0f, 2};
       }},  // two parents
      // Numbers that all rise, each with a parent, two with two of them; one cell less than
      // there should be.
      {no_split,
       [](Layout& l) {
         l.nodes = {{0, 4.0f, 1}, {1, 4.0f, 2}, {2, 4.0f, 3}, {}, {}};
       }},
      {no_split, [](Layout& l) { l.nodes[2].link = 4; }},  // one child is beyond the end
      {no_split, [](Layout& l) { l.nodes[2].link = 5; }},  // both are
      {no_split, [](Layout& l) { l.nodes[2].link = 0xffffffffu; }},
      {no_split, [](Layout& l) { l.nodes[2].plane = kNanFloat; }},
      {no_split, [](Layout& l) { l.nodes[2].plane = 0.0f; }},  // in the border of its cell
      {no_split,
       [](Layout& l) {
         l.nodes[2] = {0, 3.0f, 3};
       }},  // in the neighbour's cell
      {no_split, [](Layout& l) { l.nodes[0].plane = kInfFloat; }},
  };
  expectRefused<OccluderDatabase>(threeCells(), faults);
}

}  // namespace
}  // namespace sightline
