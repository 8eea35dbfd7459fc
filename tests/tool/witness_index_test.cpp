// Tests where the witnesses of a claim are found.

#include "tools/sightline/cull/witness_index.h"

#include <gtest/gtest.h>

namespace sightline::tool_test {
namespace {

using tool::CellPart;
using tool::FoundWitnesses;
using tool::WitnessIndex;
using tool::WitnessPlace;
using tool::WitnessUse;

constexpr std::uint64_t kCell = 8 + 3;  // child 3 of the root

HidingWitness hides(std::uint64_t cell, std::uint32_t begin, std::uint32_t end,
                    WitnessPart part = WitnessPart::kWhole) {
  HidingWitness witness;
  witness.cell = cell;
  witness.part = part;
  witness.hidden = {{begin, end}};
  return witness;
}

struct Found {
  std::vector<WitnessUse> uses;
  std::vector<FoundWitnesses> found;
};
Found find(const std::vector<HidingWitness>& witnesses, std::vector<std::uint32_t> positions,
           CellPart part = CellPart::kWhole, std::uint64_t empty = 0) {
  Found result;
  WitnessIndex(witnesses).find(
      kCell, part, positions, [empty](std::uint64_t cell) { return cell == empty; }, result.uses,
      result.found);
  return result;
}

// Each of the cells below but one hides positions 5 and 6, that one position 5 alone.
std::vector<HidingWitness> ofCellsBelow() {
  std::vector<HidingWitness> witnesses;
  for (std::uint64_t i = 0; i < 8; ++i) {
    witnesses.push_back(hides(8 * kCell + i, 5, i == 2 ? 6 : 7));
  }
  return witnesses;
}

TEST(WitnessIndex, AClaimOfAMergedCellNeedsAWitnessOfEachCellBelow) {
  const Found found = find(ofCellsBelow(), {5, 6});
  EXPECT_EQ(found.found[0].place, WitnessPlace::kBelow);
  EXPECT_EQ(found.found[0].use_count, 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(found.uses[found.found[0].first_use + i], (WitnessUse{5, static_cast<std::uint32_t>(i)}));
  }
  EXPECT_EQ(found.found[1].place, WitnessPlace::kNone);
  EXPECT_EQ(found.uses.size(), 8u);
}

TEST(WitnessIndex, ACellBelowWithoutEyesNeedsNone) {
  const Found found = find(ofCellsBelow(), {5, 6}, CellPart::kWhole, 8 * kCell + 2);
  for (const FoundWitnesses& one : found.found) {
    EXPECT_EQ(one.place, WitnessPlace::kBelow);
    EXPECT_EQ(one.use_count, 7u);
  }
}

TEST(WitnessIndex, TheCellsBelowACellBelowMayStandForIt) {
  std::vector<HidingWitness> witnesses = ofCellsBelow();
  for (std::uint64_t i = 0; i < 8; ++i) {
    witnesses.push_back(hides(8 * (8 * kCell + 2) + i, 6, 7));
  }
  const Found found = find(witnesses, {6});
  EXPECT_EQ(found.found[0].place, WitnessPlace::kBelow);
  EXPECT_EQ(found.found[0].use_count, 15u);
}

TEST(WitnessIndex, TheCellItselfIsAskedFirstThenThoseAroundIt) {
  std::vector<HidingWitness> witnesses = ofCellsBelow();
  witnesses.push_back(hides(1, 4, 6));
  EXPECT_EQ(find(witnesses, {5}).found[0].place, WitnessPlace::kAround);
  witnesses.push_back(hides(kCell, 5, 6));
  EXPECT_EQ(find(witnesses, {5}).found[0].place, WitnessPlace::kHere);
  EXPECT_EQ(find(witnesses, {4, 5}).found[0].place, WitnessPlace::kAround);
}

TEST(WitnessIndex, AWitnessOfASideServesClaimsOfThatSideAlone) {
  const std::vector<HidingWitness> front{hides(kCell, 5, 6, WitnessPart::kFront)};
  EXPECT_EQ(find(front, {5}, CellPart::kFront).found[0].place, WitnessPlace::kHere);
  EXPECT_EQ(find(front, {5}, CellPart::kBack).found[0].place, WitnessPlace::kNone);
  EXPECT_EQ(find(front, {5}, CellPart::kWhole).found[0].place, WitnessPlace::kNone);
  const std::vector<HidingWitness> around{hides(1, 5, 6, WitnessPart::kFront)};
  EXPECT_EQ(find(around, {5}, CellPart::kFront).found[0].place, WitnessPlace::kNone);
}

}  // namespace
}  // namespace sightline::tool_test
