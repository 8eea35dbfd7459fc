// Chains of surfaces in a depth buffer: their edges do not depend on what is projected with them.

#include "src/occlusion/surfaces/chain_edges.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <span>
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

// Closed chains of three to six vertices before a view, some of their edges level or upright, some across the
// near plane. The surface of each is the fan of triangles from its first vertex.
SurfaceSet randomChains(test::ViewRandom& random, const View& view, std::size_t count) {
  SurfaceSet set;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t vertices = 3 + random.below(4);
    SurfaceChain chain;
    chain.first_vertex = static_cast<std::uint32_t>(set.chain_vertices.size());
    chain.vertex_count = vertices + 1;
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
    set.chain_vertices.push_back(set.chain_vertices[chain.first_vertex]);
    set.chains.push_back(chain);
  }
  set.vertices = set.chain_vertices;
  return set;
}

// Adds a chain and the lines along which the fan within it is cut.
void addClosed(const SurfaceSet& set, std::size_t number, std::int32_t value, ChainEdges& edges) {
  edges.add(static_cast<std::uint32_t>(number), value);
  const SurfaceChain& chain = set.chains[number];
  for (std::uint32_t i = 1; i + 2 < chain.vertex_count; ++i) {
    const std::uint32_t first = chain.first_vertex;
    edges.addCut(std::array{first, first + i, first + i + 1}, value);
  }
}

// The edges of some chains as one group.
std::vector<EdgeBits> edgesOf(const SurfaceSet& set, const scene::PixelView& view, std::size_t first,
                              std::size_t count) {
  ChainEdges edges;
  edges.begin(set, view, view.near * (1.0 + 1e-6), {kChainWidth, kChainHeight});
  for (std::size_t i = first; i < first + count; ++i) {
    addClosed(set, i, 1, edges);
  }
  std::vector<BoundaryChain> boundary;
  const std::uint32_t added = edges.endGroup(boundary);
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
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
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

// The view's clip plane is at the depth 0.1, and the surfaces lie below the eye.
class CutChains : public ::testing::Test {
 protected:
  CutChains() {
    setOrientation(view_, {0, 0, -1}, {0, 1, 0});
    view_.z_near = 0.1;
  }
  // The number of edges of a group of the set's chain and of triangles, three numbers of vertices each.
  std::size_t edgesWith(const SurfaceSet& set, std::int32_t value, std::span<const std::uint32_t> triangles) {
    const scene::PixelView view(view_, kChainWidth, kChainHeight);
    ChainEdges edges;
    edges.begin(set, view, view.near, {kChainWidth, kChainHeight});
    edges.add(0, value);
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      edges.addCut(triangles.subspan(i).first<3>(), value);
    }
    std::vector<BoundaryChain> boundary;
    const std::size_t count = edges.endGroup(boundary);
    EXPECT_EQ(boundary.empty(), count == 0);
    return count;
  }
  static SurfaceSet setOf(std::initializer_list<Vec3f> vertices, std::initializer_list<Vec3f> chain) {
    SurfaceSet set;
    set.vertices.assign(vertices.begin(), vertices.end());
    set.chain_vertices.assign(chain.begin(), chain.end());
    set.chains = {SurfaceChain{.first_vertex = 0, .vertex_count = static_cast<std::uint32_t>(chain.size())}};
    return set;
  }

  View view_;
};

TEST_F(CutChains, BoundNothingWhereTheyStayOpen) {
  const Vec3f a(-0.05f, -0.02f, 0), b(0.05f, -0.02f, -2), c(-0.05f, -0.02f, -2);
  const SurfaceSet set = setOf({a, b, c}, {a, b, c, a});
  const std::array<std::uint32_t, 3> triangle{0, 1, 2};
  for (const std::int32_t value : {1, 2, -3}) {
    EXPECT_GT(edgesWith(set, value, triangle), 0u);
    EXPECT_EQ(edgesWith(set, value, {}), 0u);
  }
}

// The chain has one edge from p0 to p4. Its triangles divide it at p1, and it is cut beyond that.
TEST_F(CutChains, AreClosedWhereTrianglesDivideTheirEdges) {
  const Vec3f p0(0, -0.02f, 0), p1(0, -0.02f, -0.078125f), p4(0, -0.02f, -0.25f),
      left(-0.05f, -0.02f, -0.125f);
  const SurfaceSet set = setOf({p0, p1, p4, left}, {p0, p4, left, p0});
  const std::array<std::uint32_t, 6> triangles{0, 1, 3, 1, 2, 3};
  for (const std::int32_t value : {1, 2, -3}) {
    EXPECT_GT(edgesWith(set, value, triangles), 0u);
    EXPECT_EQ(edgesWith(set, value, std::span(triangles).first(3)), 0u);
  }
}

// The line from p0 to p4 is the border of two surfaces, which divide it at different points. So no chain has
// it, and neither surface's edge at the cut is a part of the other's.
TEST_F(CutChains, AreClosedWhereNeighboursDivideALineElsewhere) {
  const Vec3f p0(0, -0.02f, 0), p1(0, -0.02f, -0.078125f), p2(0, -0.02f, -0.109375f), p4(0, -0.02f, -0.25f),
      left(-0.05f, -0.02f, -0.125f), right(0.05f, -0.02f, -0.125f);
  const SurfaceSet set = setOf({p0, p1, p2, p4, left, right}, {p0, right, p4, left, p0});
  const std::array<std::uint32_t, 12> triangles{0, 1, 4, 1, 3, 4, 3, 2, 5, 2, 0, 5};
  EXPECT_GT(edgesWith(set, 1, triangles), 0u);
}

}  // namespace
}  // namespace sightline::occlusion
