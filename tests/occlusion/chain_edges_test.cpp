// Chains of surfaces in a depth buffer: their edges do not depend on what is projected with them.

#include "src/occlusion/surfaces/chain_edges.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <vector>

#include "tests/occlusion/random_views.h"
#include "tests/support/instruction_sets.h"

namespace sightline::occlusion {
namespace {

constexpr std::uint32_t kChainWidth = 320, kChainHeight = 180;

using EdgeBits = std::array<std::uint64_t, 20>;

EdgeBits bitsOf(const BoundaryEdge& e) {
  const auto bits = [](auto v) {
    if constexpr (sizeof(v) == 8) {
      return std::bit_cast<std::uint64_t>(v);
    } else {
      return std::uint64_t{std::bit_cast<std::uint32_t>(v)};
    }
  };
  const auto number = [](auto v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)); };
  return {bits(e.x),
          bits(e.slope),
          bits(e.left),
          bits(e.right),
          bits(e.reach_left),
          bits(e.reach_right),
          bits(e.doubt),
          bits(e.end_doubt),
          number(e.bottom),
          number(e.top),
          number(e.first_row),
          number(e.last_row),
          number(e.first_crossed),
          number(e.end_crossed),
          number(e.first_whole),
          number(e.end_whole),
          number(e.first_tile),
          number(e.last_tile),
          number(e.kind),
          number((e.falls ? 1 : 0) + (e.rightwards ? 2 : 0) + (e.matters ? 4 : 0))};
}

// Chains of two to five vertices before a view, some of them level or upright, some across the near plane.
SurfaceSet randomChains(test::ViewRandom& random, const View& view, std::size_t count) {
  SurfaceSet set;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t vertices = 2 + random.below(4);
    SurfaceChain chain;
    chain.first_vertex = static_cast<std::uint32_t>(set.chain_vertices.size());
    chain.vertex_count = vertices;
    const double depth =
        random.below(8) == 0 ? random.in(-2.0, 2.0) * view.z_near : random.sized(view.z_near, 300.0);
    Vec3d at = view.eye + view.forward * depth +
               (view.right * random.in(-1.0, 1.0) + view.up * random.in(-1.0, 1.0)) * std::abs(depth);
    for (std::uint32_t k = 0; k < vertices; ++k) {
      set.chain_vertices.push_back(Vec3f(at));
      Vec3d step = random.point(0.3 * std::abs(depth));
      step[static_cast<int>(random.below(3))] *= random.below(3) == 0 ? 0.0 : 1.0;
      at = at + step;
    }
    set.chains.push_back(chain);
  }
  return set;
}

// The edges of some chains as one group.
std::vector<EdgeBits> edgesOf(const SurfaceSet& set, const scene::PixelView& view, std::size_t first,
                              std::size_t count) {
  ChainEdges edges;
  edges.begin(set, view, view.near * (1.0 + 1e-6), {kChainWidth, kChainHeight});
  for (std::size_t i = first; i < first + count; ++i) {
    edges.add(static_cast<std::uint32_t>(i), 1);
  }
  std::vector<BoundaryChain> boundary;
  const std::uint32_t added = edges.endGroup(boundary).edges;
  EXPECT_EQ(added, edges.edges().size());
  std::vector<EdgeBits> bits;
  for (const BoundaryChain& chain : boundary) {
    for (std::uint32_t i = 0; i < chain.count; ++i) {
      bits.push_back(bitsOf(edges.edges()[chain.first + i]));
    }
  }
  EXPECT_EQ(bits.size(), added);
  return bits;
}

TEST(ChainEdges, AreTheSameWithEveryInstructionSetAndInAnyCompany) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2u);
  test::ViewRandom random(11);
  std::size_t edges = 0, cut = 0;
  for (int n = 0; n < 300; ++n) {
    const View given = test::randomView(random);
    const scene::PixelView view(given, kChainWidth, kChainHeight);
    if (!view.sane()) {
      continue;
    }
    constexpr std::size_t kChains = 23;
    const SurfaceSet set = randomChains(random, given, kChains);
    const std::vector<EdgeBits> all = edgesOf(set, view, 0, kChains);
    edges += all.size();
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      EXPECT_EQ(edgesOf(set, view, 0, kChains), all) << "view " << n << ", " << hwy::TargetName(target);
    }
    // Where one of them is cut, all are projected one by one.
    std::vector<EdgeBits> alone;
    std::size_t cut_before = cut;
    for (std::size_t i = 0; i < kChains; ++i) {
      const std::vector<EdgeBits> one = edgesOf(set, view, i, 1);
      alone.insert(alone.end(), one.begin(), one.end());
      for (const Vec3f& vertex : set.verticesOf(set.chains[i])) {
        cut += view.toCamera(Vec3d(vertex) - view.eye).z < view.near ? 1 : 0;
      }
    }
    EXPECT_EQ(alone, all) << "view " << n << (cut > cut_before ? ", with cut edges" : "");
  }
  EXPECT_GT(edges, 5'000u);
  EXPECT_GT(cut, 500u);
}

TEST(ChainEdges, NothingBeforeTheClipDepthHasAnEdge) {
  SurfaceSet set;
  set.chain_vertices = {Vec3f(-1, 0, -0.5f), Vec3f(1, 0, -0.5f)};
  set.chains = {SurfaceChain{.first_vertex = 0, .vertex_count = 2}};
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.z_near = 1.0;
  EXPECT_TRUE(edgesOf(set, scene::PixelView(view, kChainWidth, kChainHeight), 0, 1).empty());
  view.z_near = 0.25;
  EXPECT_EQ(edgesOf(set, scene::PixelView(view, kChainWidth, kChainHeight), 0, 1).size(), 1u);
}

}  // namespace
}  // namespace sightline::occlusion
