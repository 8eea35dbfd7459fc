#include "src/comparison/occluders/minimum_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "tests/occluders/flat_mesh.h"

namespace sightline::comparison {
namespace {

using flat_mesh::Random;
using Members = std::vector<std::uint32_t>;

constexpr SearchLimits kEverything{1000, 1u << 24};

CombinationTable tableOf(const std::vector<Members>& slots) {
  CombinationTable table;
  for (const Members& slot : slots) {
    table.add(slot);
  }
  table.finish();
  return table;
}

std::vector<Members> slotsOf(const CombinationTable& table) {
  std::vector<Members> slots;
  for (std::uint32_t s = 0; s < table.slotCount(); ++s) {
    slots.emplace_back(table.slot(s).begin(), table.slot(s).end());
  }
  return slots;
}

std::vector<Members> setsOf(const std::vector<Members>& slots, const std::vector<double>& costs,
                            const SearchLimits& limits = kEverything) {
  MinimumSetSearch search;
  std::vector<Members> sets;
  for (const MinimumSet& set : search.find(tableOf(slots), costs, limits)) {
    sets.push_back(set.members);
  }
  return sets;
}

// Finds the set, as bits of a number, by trying all subsets.
struct Exhaustive {
  std::vector<std::uint32_t> slots;  // bits
  std::vector<std::uint32_t> minimal;

  Exhaustive(const std::vector<Members>& table, std::uint32_t member_count) {
    for (const Members& members : table) {
      slots.push_back(bitsOf(members));
    }
    for (std::uint32_t set = 1; set < 1u << member_count; ++set) {
      if (isMinimal(set)) {
        minimal.push_back(set);
      }
    }
  }
  static std::uint32_t bitsOf(std::span<const std::uint32_t> members) {
    std::uint32_t bits = 0;
    for (const std::uint32_t member : members) {
      bits |= 1u << member;
    }
    return bits;
  }
  bool hitsAll(std::uint32_t set) const {
    return std::all_of(slots.begin(), slots.end(), [set](std::uint32_t slot) { return (slot & set) != 0; });
  }
  bool isMinimal(std::uint32_t set) const {
    if (!hitsAll(set)) {
      return false;
    }
    for (std::uint32_t rest = set; rest != 0; rest &= rest - 1) {
      if (hitsAll(set ^ (rest & -rest))) {
        return false;
      }
    }
    return true;
  }
};

struct RandomTable {
  std::uint32_t member_count = 0;
  std::vector<Members> slots;
  std::vector<double> costs;  // small whole numbers, so that sums are exact and tie

  explicit RandomTable(Random& random) {
    member_count = 1 + random.below(12);
    const std::uint32_t slot_count = 1 + random.below(12);
    for (std::uint32_t s = 0; s < slot_count; ++s) {
      Members slot;
      const std::uint32_t one_in = 1 + random.below(6);
      for (std::uint32_t m = 0; m < member_count; ++m) {
        if (random.below(one_in) == 0) {
          slot.push_back(m);
        }
      }
      if (slot.empty()) {
        slot.push_back(random.below(member_count));
      }
      std::rotate(slot.begin(), slot.begin() + random.below(static_cast<std::uint32_t>(slot.size())),
                  slot.end());
      slots.push_back(slot);
    }
    for (std::uint32_t m = 0; m < member_count; ++m) {
      costs.push_back(random.below(9));
    }
  }
  double costOf(std::uint32_t set) const {
    double cost = 0.0;
    for (std::uint32_t m = 0; m < member_count; ++m) {
      cost += (set >> m & 1u) != 0 ? costs[m] : 0.0;
    }
    return cost;
  }
};

TEST(CombinationTable, HasEachDifferentSlotOnceTheSmallestFirst) {
  EXPECT_EQ(slotsOf(tableOf({{5, 3}, {1}, {3, 5}, {7, 8, 6}, {3, 4}})),
            (std::vector<Members>{{1}, {3, 4}, {3, 5}, {6, 7, 8}}));
}

TEST(CombinationTable, DropsASlotThatContainsAnother) {
  EXPECT_EQ(slotsOf(tableOf({{1, 2, 3}, {65, 1}, {3, 1}, {9}, {2, 9}})),
            (std::vector<Members>{{9}, {1, 3}, {1, 65}}));
}

TEST(CombinationTable, TellsMembersApartThatShareASignatureBit) {
  EXPECT_EQ(slotsOf(tableOf({{1}, {65, 2}, {2, 129}})), (std::vector<Members>{{1}, {2, 65}, {2, 129}}));
}

// The combination table of the paper's Figure 3, occluders A to D as 0 to 3.
TEST(MinimumSets, FigureTwoHasTheSetsAbcAndAcdAndNoOther) {
  const std::vector<Members> figure = {{0}, {2}, {0, 1}, {2, 3}, {1, 3}, {0, 1, 3}, {1, 2, 3}};
  auto sets = setsOf(figure, {1, 1, 1, 1});
  std::sort(sets.begin(), sets.end());
  EXPECT_EQ(sets, (std::vector<Members>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MinimumSets, NeverHasAMemberThatLaterOnesMakeRedundant) {
  // 0 is tried first, as the cheapest; with 1, which {1, 2} may be hit by, it is not needed any more.
  EXPECT_EQ(setsOf({{0, 1}, {1, 2}}, {1.0, 10.0, 10.0}), (std::vector<Members>{{1}, {0, 2}}));
}

TEST(MinimumSets, AreTheCheapestOfAllThereAre) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const RandomTable table(random);
    const Exhaustive exhaustive(table.slots, table.member_count);
    std::vector<double> expected;
    for (const std::uint32_t set : exhaustive.minimal) {
      expected.push_back(table.costOf(set));
    }
    std::sort(expected.begin(), expected.end());
    const std::uint32_t kept = random.below(3) == 0 ? 1000 : 1 + random.below(5);
    expected.resize(std::min<std::size_t>(expected.size(), kept));

    MinimumSetSearch search;
    std::vector<double> found;
    std::set<std::uint32_t> different;
    for (const MinimumSet& set : search.find(tableOf(table.slots), table.costs, {kept, 1u << 24})) {
      const std::uint32_t bits = Exhaustive::bitsOf(set.members);
      EXPECT_TRUE(exhaustive.isMinimal(bits)) << bits;
      EXPECT_TRUE(different.insert(bits).second) << "twice " << bits;
      EXPECT_TRUE(std::is_sorted(set.members.begin(), set.members.end()));
      EXPECT_EQ(set.cost, table.costOf(bits));
      found.push_back(set.cost);
    }
    ASSERT_EQ(found, expected);
  }
}

TEST(MinimumSets, AreMinimalAlsoWhenTheSearchEndsEarly) {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const RandomTable table(random);
    const Exhaustive exhaustive(table.slots, table.member_count);
    for (const Members& set : setsOf(table.slots, table.costs, {4, 1 + random.below(12)})) {
      ASSERT_TRUE(exhaustive.isMinimal(Exhaustive::bitsOf(set)));
      ++found;
    }
  }
  EXPECT_GT(found, 1000u);
}

TEST(MinimumSets, FindOneWithAStepForEachOfItsMembers) {
  // One slot each: the first way down is a set.
  EXPECT_EQ(setsOf({{0, 1}, {2, 3}, {4, 5}}, std::vector<double>(6, 1.0), {8, 3}),
            (std::vector<Members>{{0, 2, 4}}));
  EXPECT_TRUE(setsOf({{0, 1}, {2, 3}, {4, 5}}, std::vector<double>(6, 1.0), {8, 2}).empty());
}

TEST(MinimumSets, HaveEveryOccluderThatIsAloneInAPixel) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    RandomTable table(random);
    const std::uint32_t alone = random.below(table.member_count);
    table.slots.push_back({alone});
    const auto sets = setsOf(table.slots, table.costs);
    ASSERT_FALSE(sets.empty());
    for (const Members& set : sets) {
      EXPECT_TRUE(std::binary_search(set.begin(), set.end(), alone));
    }
  }
}

TEST(MinimumSets, AreNoneWithoutBudgetOrWithAPixelThatNothingHides) {
  EXPECT_TRUE(setsOf({{0}}, {1.0}, {8, 0}).empty());
  EXPECT_TRUE(setsOf({{0}}, {1.0}, {0, 100}).empty());
  EXPECT_TRUE(setsOf({{0}, {}}, {1.0}).empty());
  EXPECT_TRUE(setsOf({}, {1.0}).empty());
}

TEST(MinimumSets, ComeInTheSameOrderFromASearchThatWasUsedBefore) {
  Random random(7);
  MinimumSetSearch used;
  for (int i = 0; i < 200; ++i) {
    const RandomTable table(random);
    const CombinationTable slots = tableOf(table.slots);
    MinimumSetSearch fresh;
    const auto expected = fresh.find(slots, table.costs, {5, 40});
    const auto found = used.find(slots, table.costs, {5, 40});
    ASSERT_EQ(found.size(), expected.size()) << i;
    for (std::size_t s = 0; s < found.size(); ++s) {
      EXPECT_EQ(found[s].members, expected[s].members) << i;
    }
  }
}

TEST(MinimumSets, CopeWithATableOfThousandsOfSlots) {
  std::vector<Members> slots;
  for (std::uint32_t s = 0; s < 6000; ++s) {
    slots.push_back({s, s + 6000});
  }
  // Each slot needs an occluder of its own: more than are looked for.
  EXPECT_TRUE(setsOf(slots, std::vector<double>(12000, 1.0), {1, 10000}).empty());
  slots.resize(4000);
  EXPECT_EQ(setsOf(slots, std::vector<double>(12000, 1.0), {1, 10000}).size(), 1u);
}

}  // namespace
}  // namespace sightline::comparison
