#include "sightline/layers/arc_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/strong_components.h"

namespace sightline {
namespace {

// An order of sorted parts alone, each a group of its own.
struct FlatOrder {
  explicit FlatOrder(std::uint32_t count) {
    for (std::uint32_t part = 0; part < count; ++part) {
      parts.emplace_back(part);
      first_of.push_back(part);
    }
    first_of.push_back(count);
    order.parts = parts;
    order.first_of = first_of;
    order.sorted_end = count;
  }

  std::vector<PartId> parts;
  std::vector<std::uint32_t> first_of;
  LayerOrder order;
};

LayerArc arcOf(std::uint32_t front, std::uint32_t back) {
  return {PartId(front), PartId(back)};
}

std::vector<std::uint32_t> groupOf(const LayerOrder& order) {
  std::vector<std::uint32_t> group(order.parts.size());
  for (std::uint32_t i = 0; i < order.groups(); ++i) {
    for (const PartId part : order.group(i)) {
      group[part.value] = i;
    }
  }
  return group;
}

TEST(ArcSorter, GroupsAreTheStrongComponentsOfTheArcsAndComeFrontToBack) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t count = 30;
    FlatOrder flat(count);
    std::vector<LayerArc> arcs;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < 10 + seed; ++i) {
      const auto front = static_cast<std::uint32_t>(random() % count);
      const auto back = static_cast<std::uint32_t>(random() % count);
      arcs.push_back(arcOf(front, back));
      pairs.emplace_back(front, back);
    }
    const std::vector<std::uint32_t> component = test::strongComponents(count, pairs);
    ArcSorter sorter;
    const LayerOrder& order = sorter.sort(flat.order, arcs);
    ASSERT_EQ(order.parts.size(), count);
    const std::vector<std::uint32_t> group = groupOf(order);
    for (std::uint32_t a = 0; a < count; ++a) {
      for (std::uint32_t b = 0; b < count; ++b) {
        ASSERT_EQ(group[a] == group[b], component[a] == component[b]) << "seed " << seed;
      }
    }
    for (const LayerArc& arc : arcs) {
      ASSERT_LE(group[arc.front.value], group[arc.back.value]) << "seed " << seed;
    }
  }
}

TEST(ArcSorter, WithoutArcsTheOrderStays) {
  FlatOrder flat(5);
  std::reverse(flat.parts.begin(), flat.parts.end());
  ArcSorter sorter;
  const LayerOrder& order = sorter.sort(flat.order, {});
  EXPECT_TRUE(std::equal(order.parts.begin(), order.parts.end(), flat.parts.begin(), flat.parts.end()));
  EXPECT_EQ(order.groups(), 5u);
}

TEST(ArcSorter, OverlaysAndBackdropsStayWhateverTheArcsSay) {
  FlatOrder flat(5);  // 0 is an overlay, 4 a backdrop
  flat.order.first_sorted = 1;
  flat.order.sorted_end = 4;
  ArcSorter sorter;
  const std::vector<LayerArc> arcs{arcOf(4, 0), arcOf(3, 0), arcOf(3, 1),
                                   arcOf(1, 2), arcOf(2, 3), arcOf(9, 1)};
  const LayerOrder& order = sorter.sort(flat.order, arcs);
  ASSERT_EQ(order.groups(), 3u);
  EXPECT_EQ(order.group(0).front(), PartId(0u));
  EXPECT_EQ(order.group(1).size(), 3u);
  EXPECT_EQ(order.group(2).front(), PartId(4u));
  EXPECT_EQ(order.first_sorted, 1u);
  EXPECT_EQ(order.sorted_end, 2u);
}

// The last result's storage must outlast what is written instead: more groups than before move the backdrops.
TEST(ArcSorter, SortsItsOwnLastResult) {
  constexpr std::uint32_t kSorted = 60, kCount = 100;
  FlatOrder flat(kCount);  // the last 40 are backdrops
  flat.order.sorted_end = kSorted;
  std::vector<LayerArc> ring;
  for (std::uint32_t part = 0; part < kSorted; ++part) {
    ring.push_back(arcOf(part, (part + 1) % kSorted));
  }
  ArcSorter sorter;
  const LayerOrder& grouped = sorter.sort(flat.order, ring);
  ASSERT_EQ(grouped.groups(), 1 + kCount - kSorted);
  const LayerOrder& again = sorter.sort(grouped, grouped.arcs);
  ASSERT_EQ(again.groups(), 1 + kCount - kSorted);
  std::sort(ring.begin(), ring.end());
  EXPECT_TRUE(std::equal(again.arcs.begin(), again.arcs.end(), ring.begin(), ring.end()));
  const LayerOrder& parted = sorter.sort(again, {});
  ASSERT_EQ(parted.groups(), kCount);
  EXPECT_EQ(parted.sorted_end, kSorted);
  for (std::uint32_t i = kSorted; i < kCount; ++i) {
    ASSERT_EQ(parted.group(i).size(), 1u);
    EXPECT_EQ(parted.group(i).front(), PartId(i));
  }
}

}  // namespace
}  // namespace sightline
