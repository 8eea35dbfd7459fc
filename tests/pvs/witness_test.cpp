#include "sightline/pvs/format/witness.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace sightline {
namespace {

Witnesses someWitnesses() {
  HidingWitness one;
  one.cell = 9;
  one.kind = WitnessKind::kSurfaces;
  one.to = {1, 2, 3};
  one.hidden = {{0, 2}, {2, 5}, {9, 10}};
  return {.scene = {.hash = 7, .objects = 10, .triangles = 20}, .root_max = {1, 1, 1}, .all = {one}};
}

bool isRead(const std::function<void(HidingWitness&)>& change) {
  Witnesses witnesses = someWitnesses();
  change(witnesses.all.front());
  return readWitnesses(witnessBytes(witnesses), "w").has_value();
}

TEST(Witness, IsReadAsWritten) {
  const Result<Witnesses> read = readWitnesses(witnessBytes(someWitnesses()), "w");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->all, someWitnesses().all);
  EXPECT_EQ(read->scene, someWitnesses().scene);
}

TEST(Witness, CellsOfTheDeepestLevelHaveNumbers) {
  OctreeCell cell;
  std::uint64_t number = 1;
  for (std::uint32_t i = 0; i < kMaxOctreeDepth; ++i) {
    cell = cell.child(i % 8);
    number = 8 * number + i % 8;
  }
  EXPECT_EQ(cellNumber(cell), number);
  EXPECT_EQ(cellOfNumber(number).at, cell.at);
  EXPECT_TRUE(isRead([&](HidingWitness& w) { w.cell = number; }));
  EXPECT_FALSE(isRead([&](HidingWitness& w) { w.cell = 8 * number; }));
}

TEST(Witness, OutOfRangeIsRefused) {
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.cell = 0; }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.cell = 2; }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.kind = static_cast<WitnessKind>(kWitnessKinds); }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.part = static_cast<WitnessPart>(kWitnessParts); }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.hidden = {}; }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.hidden = {{3, 3}}; }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.hidden = {{0, 3}, {2, 4}}; }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.from.x = std::numeric_limits<double>::infinity(); }));
  EXPECT_FALSE(isRead([](HidingWitness& w) { w.to.z = std::numeric_limits<double>::quiet_NaN(); }));
}

TEST(Witness, CutOffAnywhereIsRefused) {
  const std::vector<std::byte> bytes = witnessBytes(someWitnesses());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(readWitnesses(std::span(bytes).first(size), "w")) << size;
  }
}

}  // namespace
}  // namespace sightline
