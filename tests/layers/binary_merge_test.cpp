#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "sightline/layers/compositing.h"

namespace sightline {
namespace {

using Arcs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

struct OwnedOrder {
  std::vector<PartId> parts;
  std::vector<std::uint32_t> first_of{0};
  std::vector<LayerArc> arcs;

  void addGroup(const std::vector<std::uint32_t>& members) {
    for (const std::uint32_t m : members) {
      parts.push_back(PartId(m));
    }
    first_of.push_back(static_cast<std::uint32_t>(parts.size()));
  }
  void addArcs(const Arcs& pairs) {
    for (const auto& [front, back] : pairs) {
      arcs.push_back({PartId(front), PartId(back)});
    }
    std::sort(arcs.begin(), arcs.end());
  }
  LayerOrder view() const { return {.parts = parts, .first_of = first_of, .arcs = arcs}; }
};

std::vector<std::vector<std::uint32_t>> layersOf(const FrameLayers& frame) {
  std::vector<std::vector<std::uint32_t>> layers;
  for (std::uint32_t i = 0; i < frame.layers(); ++i) {
    layers.emplace_back();
    for (const PartId part : frame.partsOf(LayerId(i))) {
      layers.back().push_back(part.value);
    }
  }
  return layers;
}

using Blocks = std::set<std::set<std::uint32_t>>;

bool occludes(const std::set<std::uint32_t>& a, const std::set<std::uint32_t>& b, const Arcs& arcs) {
  return std::any_of(arcs.begin(), arcs.end(),
                     [&](const auto& arc) { return a.contains(arc.first) && b.contains(arc.second); });
}

// Merges one pair of blocks that occlude each other after the other, until there is none.
Blocks mergedByBruteForce(const std::vector<std::uint32_t>& parts, const Arcs& arcs) {
  Blocks blocks;
  for (const std::uint32_t p : parts) {
    blocks.insert({p});
  }
  const auto mergeOne = [&] {
    for (auto a = blocks.begin(); a != blocks.end(); ++a) {
      for (auto b = std::next(a); b != blocks.end(); ++b) {
        if (occludes(*a, *b, arcs) && occludes(*b, *a, arcs)) {
          std::set<std::uint32_t> both = *a;
          both.insert(b->begin(), b->end());
          blocks.erase(b);
          blocks.erase(a);
          blocks.insert(both);
          return true;
        }
      }
    }
    return false;
  };
  while (mergeOne()) {
  }
  return blocks;
}

TEST(LayerMerger, MakesNothingOfAnEmptyOrder) {
  LayerMerger merger;
  const FrameLayers& frame = merger.merge({});
  EXPECT_EQ(frame.layers(), 0u);
  EXPECT_EQ(frame.groups(), 0u);
  EXPECT_TRUE(frame.parts.empty());
}

TEST(LayerMerger, KeepsSinglePartsAsLayersInTheirOrder) {
  OwnedOrder order;
  order.addGroup({7});
  order.addGroup({2});
  order.addGroup({5});
  LayerMerger merger;
  const FrameLayers& frame = merger.merge(order.view());
  EXPECT_EQ(layersOf(frame), (std::vector<std::vector<std::uint32_t>>{{7}, {2}, {5}}));
  EXPECT_EQ(frame.first_layer, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_TRUE(frame.occlusions.empty());
}

TEST(LayerMerger, KeepsACycleOfThreeAsThreeLayers) {
  OwnedOrder order;
  order.addGroup({4, 1, 9});
  order.addArcs({{4, 1}, {1, 9}, {9, 4}});
  LayerMerger merger;
  const FrameLayers& frame = merger.merge(order.view());
  EXPECT_EQ(layersOf(frame), (std::vector<std::vector<std::uint32_t>>{{4}, {1}, {9}}));
  const std::vector<LayerOcclusion> expected{
      {LayerId(0u), LayerId(1u)}, {LayerId(1u), LayerId(2u)}, {LayerId(2u), LayerId(0u)}};
  EXPECT_EQ(frame.occlusions, expected);
}

TEST(LayerMerger, MergesAgainWhereMergingMadeANewPair) {
  // 0 and 2 occlude each other. Merged, they and 1 occlude each other; merged with 1, they and 3 do.
  OwnedOrder order;
  order.addGroup({3, 0, 1, 2});
  order.addArcs({{0, 2}, {2, 0}, {0, 1}, {1, 2}, {1, 3}, {3, 0}});
  LayerMerger merger;
  EXPECT_EQ(layersOf(merger.merge(order.view())), (std::vector<std::vector<std::uint32_t>>{{3, 0, 1, 2}}));
}

TEST(LayerMerger, DoesNotLookAtArcsBetweenGroups) {
  OwnedOrder order;
  order.addGroup({0, 1});
  order.addGroup({2});
  order.addArcs({{0, 1}, {1, 0}, {0, 2}, {1, 2}});
  LayerMerger merger;
  const FrameLayers& frame = merger.merge(order.view());
  EXPECT_EQ(layersOf(frame), (std::vector<std::vector<std::uint32_t>>{{0, 1}, {2}}));
  EXPECT_EQ(frame.first_layer, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(frame.occlusions.empty());
}

// A frame of up to four groups of up to nine parts.
struct RandomFrame {
  OwnedOrder order;
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<Arcs> arcs;

  explicit RandomFrame(unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> ids(60);
    for (std::uint32_t i = 0; i < ids.size(); ++i) {
      ids[i] = i;
    }
    std::shuffle(ids.begin(), ids.end(), random);
    const std::size_t count = random() % 5;
    for (std::size_t g = 0, next = 0; g < count; ++g) {
      const std::size_t size = 1 + random() % 9;
      groups.emplace_back(ids.begin() + next, ids.begin() + next + size);
      next += size;
      order.addGroup(groups.back());
      const auto density = 1 + random() % 5;
      arcs.emplace_back();
      for (const std::uint32_t a : groups.back()) {
        for (const std::uint32_t b : groups.back()) {
          if (a != b && random() % 12 < density) {
            arcs.back().push_back({a, b});
          }
        }
      }
      order.addArcs(arcs.back());
    }
  }
};

TEST(LayerMerger, MergesNoMoreAndNoLessThanPairByPair) {
  LayerMerger merger;
  std::size_t merged = 0, kept = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    const RandomFrame scene(seed);
    const FrameLayers& frame = merger.merge(scene.order.view());
    ASSERT_EQ(frame.groups(), scene.groups.size());
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
      Blocks blocks;
      for (std::uint32_t i = frame.first_layer[g]; i < frame.first_layer[g + 1]; ++i) {
        const auto parts = frame.partsOf(LayerId(i));
        std::set<std::uint32_t> block;
        for (const PartId part : parts) {
          block.insert(part.value);
        }
        ASSERT_EQ(block.size(), parts.size());
        blocks.insert(block);
      }
      ASSERT_EQ(blocks, mergedByBruteForce(scene.groups[g], scene.arcs[g]));
      merged += blocks.size() < scene.groups[g].size();
      kept += blocks.size() > 2;
    }
  }
  EXPECT_GT(merged, 100u);
  EXPECT_GT(kept, 100u);
}

TEST(LayerMerger, ListsEachOcclusionOfLayersOnceAndNoneBothWays) {
  LayerMerger merger;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    const RandomFrame scene(seed);
    const FrameLayers& frame = merger.merge(scene.order.view());
    std::vector<LayerOcclusion> expected;
    for (std::uint32_t a = 0; a < frame.layers(); ++a) {
      for (std::uint32_t b = 0; b < frame.layers(); ++b) {
        const auto any = std::any_of(scene.order.arcs.begin(), scene.order.arcs.end(), [&](LayerArc arc) {
          const auto in = [&](std::uint32_t layer, PartId part) {
            const auto parts = frame.partsOf(LayerId(layer));
            return std::find(parts.begin(), parts.end(), part) != parts.end();
          };
          return in(a, arc.front) && in(b, arc.back);
        });
        if (a != b && any) {
          expected.push_back({LayerId(a), LayerId(b)});
        }
      }
    }
    ASSERT_EQ(frame.occlusions, expected);
    for (const LayerOcclusion& o : frame.occlusions) {
      ASSERT_FALSE(std::binary_search(frame.occlusions.begin(), frame.occlusions.end(),
                                      LayerOcclusion{o.back, o.front}));
    }
  }
}

TEST(LayerMerger, KeepsTheOrderOfPartsInLayersAndOfLayersByTheirFirstParts) {
  LayerMerger merger;
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    const RandomFrame scene(seed);
    const FrameLayers& frame = merger.merge(scene.order.view());
    const auto placeOf = [&](PartId part) {
      return std::find(scene.order.parts.begin(), scene.order.parts.end(), part) - scene.order.parts.begin();
    };
    std::ptrdiff_t last_first = -1;
    for (std::uint32_t i = 0; i < frame.layers(); ++i) {
      const auto parts = frame.partsOf(LayerId(i));
      ASSERT_LT(last_first, placeOf(parts[0]));
      last_first = placeOf(parts[0]);
      for (std::size_t j = 1; j < parts.size(); ++j) {
        ASSERT_LT(placeOf(parts[j - 1]), placeOf(parts[j]));
      }
    }
  }
}

}  // namespace
}  // namespace sightline
