// Components found by depth-first search are those of the transitive closure, each after what it reaches.

#include "src/base/strong_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/rounds.h"
#include "tests/support/strong_components.h"

namespace sightline {
namespace {

using Heads = std::vector<std::vector<std::uint32_t>>;
using Components = std::vector<std::vector<std::uint32_t>>;

Components componentsOf(base::StrongComponents& components, const Heads& heads,
                        const std::vector<std::uint32_t>& nodes, const std::vector<bool>& among) {
  Components found;
  components.setNodeCount(heads.size());
  components.find(
      nodes, [&](std::uint32_t node) { return among[node]; },
      [&](std::uint32_t node) { return std::span<const std::uint32_t>(heads[node]); },
      [&](std::span<const std::uint32_t> component) {
        found.emplace_back(component.begin(), component.end());
      });
  return found;
}

TEST(StrongComponents, AreThoseOfTheTransitiveClosureAndComeAfterWhatTheyReach) {
  base::StrongComponents components;  // of all rounds, so that nothing is left over from the last
  for (unsigned seed = 0; seed < test::rounds(400u); ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t bound) { return static_cast<std::uint32_t>(random() % bound); };
    const std::uint32_t count = 1 + below(24), arc_count = below(2 * count);
    std::vector<bool> among(count);
    for (std::uint32_t node = 0; node < count; ++node) {
      among[node] = below(8) != 0;
    }
    Heads heads(count);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;  // among those nodes
    for (std::uint32_t arc = 0; arc < arc_count; ++arc) {
      const std::uint32_t from = below(count), to = below(count);
      heads[from].push_back(to);
      if (among[from] && among[to]) {
        arcs.emplace_back(from, to);
      }
    }
    std::vector<std::uint32_t> nodes(count);
    std::iota(nodes.begin(), nodes.end(), 0u);
    std::shuffle(nodes.begin(), nodes.end(), random);
    const std::vector<std::uint32_t> expected = test::strongComponents(count, arcs);
    constexpr std::size_t kNowhere = 1000;
    std::vector<std::size_t> found_in(count, kNowhere);
    const Components found = componentsOf(components, heads, nodes, among);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::uint32_t node : found[i]) {
        EXPECT_EQ(found_in[node], kNowhere) << "seed " << seed;
        found_in[node] = i;
      }
    }
    for (std::uint32_t a = 0; a < count; ++a) {
      EXPECT_EQ(found_in[a] != kNowhere, among[a]) << "seed " << seed;
      for (std::uint32_t b = 0; b < count; ++b) {
        if (among[a] && among[b]) {
          EXPECT_EQ(found_in[a] == found_in[b], expected[a] == expected[b]) << "seed " << seed;
        }
      }
    }
    for (const auto& [from, to] : arcs) {
      EXPECT_LE(found_in[to], found_in[from]) << "seed " << seed;
    }
  }
}

TEST(StrongComponents, OfALongCycleNeedNoDeepStack) {
  constexpr std::uint32_t kNodes = 300000;
  Heads heads(kNodes);
  std::vector<std::uint32_t> nodes(kNodes);
  for (std::uint32_t node = 0; node < kNodes; ++node) {
    nodes[node] = node;
    heads[node] = {(node + 1) % kNodes};
  }
  base::StrongComponents components;
  const Components found = componentsOf(components, heads, nodes, std::vector<bool>(kNodes, true));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], nodes) << "in the order of the visits";
}

}  // namespace
}  // namespace sightline
