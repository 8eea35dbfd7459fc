// Conformed triangles against brute force in rational numbers, and what they are for: touching surfaces whose
// edges cancel.

#include "src/occluders/conform/conform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "src/occluders/conform/bend_triangles.h"
#include "src/occluders/edge_vertices.h"
#include "tests/occluders/conform_judge.h"
#include "tests/support/cut_work.h"
#include "tests/support/rounds.h"

namespace sightline::occluders {
namespace {

using test::boundaryEdges;
using test::ConformJudge;
using test::greedyVoxels;
using test::Soup;
using Random = test::SoupRandom;

ConformedMesh judged(const Soup& soup) {
  const ConformedMesh mesh = conform(soup.input());
  ConformJudge(soup, mesh).judge();
  return mesh;
}

// Families of triangle soups, most of them full of ties.
using Family = Soup (*)(unsigned seed);

Soup smallWholeNumbers(unsigned seed) {
  Random random(seed);
  Soup soup;
  const auto point = [&] {
    const double x = random.below(4), y = random.below(4), z = random.below(3);
    return Vec3d{x, y, z};
  };
  for (int i = 0; i < 9; ++i) {
    const Vec3d a = point(), b = point(), c = point();
    soup.add(a, b, c);
  }
  return soup;
}

Soup anywhere(unsigned seed) {
  Random random(seed);
  Soup soup;
  const auto point = [&] {
    const double x = random.in(-1, 1), y = random.in(-1, 1), z = random.in(-1, 1);
    return Vec3d{x, y, z};
  };
  for (int i = 0; i < 8; ++i) {
    const Vec3d a = point(), b = point(), c = point();
    soup.add(a, b, c);
  }
  return soup;
}

// In a plane that is parallel to no axis, and some across it.
Soup inOnePlane(unsigned seed) {
  Random random(seed);
  Soup soup;
  const auto point = [&] {
    const double u = random.below(6), v = random.below(6);
    return Vec3d{u + 2.0 * v, 3.0 * u - v, u + v};
  };
  for (int i = 0; i < 6; ++i) {
    const Vec3d a = point(), b = point(), c = point();
    soup.add(a, b, c);
  }
  for (int i = 0; i < 2; ++i) {
    const Vec3d a = point(), b = point();
    soup.add(a, b, Vec3d{double(random.below(9)), double(random.below(9)), double(random.below(9))});
  }
  return soup;
}

// Fans and slits: long thin triangles with common corners, of coordinates far from the origin.
Soup slivers(unsigned seed) {
  Random random(seed);
  Soup soup;
  const Vec3d far{1e5, -3e4, 2e3};
  const auto point = [&](double size) {
    const double x = random.in(-size, size), y = random.in(-size, size), z = random.in(-size, size);
    return Vec3d(Vec3f(far + Vec3d{x, y, z}));
  };
  const Vec3d hub = point(1.0);
  for (int i = 0; i < 7; ++i) {
    const Vec3d a = point(3.0);
    const Vec3d b(Vec3f(a + Vec3d{0.02, 0.01, -0.02}));
    soup.add(i % 2 == 0 ? hub : point(3.0), a, b);
  }
  return soup;
}

struct NamedFamily {
  const char* name;
  Family make;
};
constexpr NamedFamily kFamilies[] = {{"small whole numbers", smallWholeNumbers},
                                     {"anywhere", anywhere},
                                     {"in one plane", inOnePlane},
                                     {"slivers", slivers}};

TEST(Conform, PiecesTileTheirTrianglesAndMeetInCommonEdgesOnly) {
  ContactCounts all;
  for (const NamedFamily& family : kFamilies) {
    for (unsigned seed = 0; seed < test::rounds(8u); ++seed) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(seed));
      const ConformedMesh mesh = judged(family.make(seed));
      all.points += mesh.contacts.points;
      all.edges_on_edges += mesh.contacts.edges_on_edges;
      all.edges_in_faces += mesh.contacts.edges_in_faces;
      all.penetrations += mesh.contacts.penetrations;
      all.overlaps += mesh.contacts.overlaps;
      if (HasFailure()) {
        return;
      }
    }
  }
  EXPECT_GT(all.points, test::rounds(10u));
  EXPECT_GT(all.edges_on_edges, test::rounds(3u));
  EXPECT_GT(all.edges_in_faces, test::rounds(30u));
  EXPECT_GT(all.penetrations, test::rounds(70u));
  EXPECT_GT(all.overlaps, test::rounds(35u));
}

// Every triangle as the positions of its corners, the least first, and its source; in order.
using Listed = std::vector<std::pair<std::array<double, 9>, std::array<double, 9>>>;

Listed listed(const Soup& soup, const ConformedMesh& mesh) {
  const auto corners = [](std::span<const Vec3d> vertices, std::span<const std::uint32_t> triangles,
                          std::size_t t) {
    std::array<double, 9> turned[3];
    for (std::size_t turn = 0; turn < 3; ++turn) {
      for (std::size_t k = 0; k < 9; ++k) {
        turned[turn][k] = vertices[triangles[3 * t + (turn + k / 3) % 3]][static_cast<int>(k % 3)];
      }
    }
    return *std::min_element(turned, turned + 3);
  };
  Listed list;
  for (std::size_t i = 0; i < mesh.source.size(); ++i) {
    list.emplace_back(corners(mesh.vertices, mesh.triangles, i),
                      corners(soup.vertices, soup.triangles, mesh.source[i]));
  }
  std::sort(list.begin(), list.end());
  return list;
}

TEST(Conform, ThreadsChangeNothing) {
  for (const NamedFamily& family : kFamilies) {
    Soup soup;
    for (unsigned seed = 0; seed < 40; ++seed) {  // far apart, several parts of the search
      const Soup one = family.make(seed);
      const Vec3d at{64.0 * seed, 0.0, 0.0};
      for (std::size_t i = 0; i < one.triangles.size(); i += 3) {
        soup.add(one.vertices[one.triangles[i]] + at, one.vertices[one.triangles[i + 1]] + at,
                 one.vertices[one.triangles[i + 2]] + at);
      }
    }
    const ConformedMesh one = conform(soup.input()), two = conform(soup.input(), {}, onThreads(3));
    EXPECT_EQ(one.vertices, two.vertices) << family.name;
    EXPECT_EQ(one.triangles, two.triangles) << family.name;
    EXPECT_EQ(one.source, two.source) << family.name;
    EXPECT_EQ(one.slack, two.slack) << family.name;
  }
}

TEST(Conform, TheOrderOfTheInputChangesNothingButTheOrder) {
  for (const NamedFamily& family : kFamilies) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(seed));
      const Soup soup = family.make(seed);
      std::vector<std::uint32_t> order(soup.count());
      for (std::uint32_t i = 0; i < order.size(); ++i) {
        order[i] = i;
      }
      std::mt19937 random(seed);
      std::shuffle(order.begin(), order.end(), random);
      Soup shuffled;
      for (const std::uint32_t t : order) {
        const std::uint32_t turn = t % 3;
        shuffled.add(soup.vertices[soup.triangles[3 * t + turn]],
                     soup.vertices[soup.triangles[3 * t + (turn + 1) % 3]],
                     soup.vertices[soup.triangles[3 * t + (turn + 2) % 3]]);
      }
      const ConformedMesh a = conform(soup.input()), b = conform(shuffled.input());
      EXPECT_EQ(listed(soup, a), listed(shuffled, b));
      EXPECT_EQ(a.slack, b.slack);
    }
  }
}

TEST(Conform, TrianglesThatShareTheirEdgesArePassedOn) {
  Soup soup;
  soup.addBox({0, 0, 0}, {1, 2, 3});
  soup.addBox({1, 2, 3}, {4, 5, 6});  // at one corner
  const ConformedMesh mesh = judged(soup);
  EXPECT_EQ(mesh.triangles, soup.triangles);
  EXPECT_EQ(mesh.vertices, soup.vertices);
  EXPECT_EQ(mesh.divided, 0u);
  EXPECT_EQ(mesh.slack, 0.0);
}

TEST(Conform, AVertexOnAnEdgeDividesIt) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  soup.add({2, 2, 0}, {4, 0, 0}, {4, 4, 1});
  soup.add({0, 4, 0}, {2, 2, 0}, {0, 4, 7});
  EXPECT_EQ(boundaryEdges(soup.triangles), 9u);
  const ConformedMesh mesh = judged(soup);
  EXPECT_EQ(mesh.source, (std::vector<std::uint32_t>{0, 0, 1, 2}));
  EXPECT_EQ(boundaryEdges(mesh.triangles), 6u);
  EXPECT_EQ(mesh.slack, 0.0);
}

TEST(Conform, AVertexBesideAnEdgeByOneUnitIsACrack) {
  for (const float gap : {std::nextafterf(2.0f, 3.0f) - 2.0f, 0.001f}) {
    Soup soup;
    soup.addQuad({0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0});
    const double y = 2.0 + double{gap};
    soup.addQuad({0, 2, 0}, {2, y, 0}, {2, 4, 0}, {0, 4, 0});
    soup.addQuad({2, y, 0}, {4, 2, 0}, {4, 4, 0}, {2, 4, 0});
    const ConformedMesh mesh = judged(soup);
    EXPECT_EQ(mesh.triangles, soup.triangles);
    EXPECT_EQ(mesh.divided, 0u);
  }
}

TEST(Conform, GreedilyMergedVoxelsBecomeWatertight) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Soup soup = greedyVoxels(seed, 4);
    EXPECT_GT(boundaryEdges(soup.triangles), 0u);
    const ConformedMesh mesh = judged(soup);
    EXPECT_EQ(boundaryEdges(mesh.triangles), 0u);
    EXPECT_EQ(mesh.slack, 0.0);
  }
  const Soup large = greedyVoxels(9, 16);
  EXPECT_GT(boundaryEdges(large.triangles), 0u);
  EXPECT_EQ(boundaryEdges(conform(large.input()).triangles), 0u);
}

TEST(Conform, BoxesPushedIntoEachOtherStayClosed) {
  for (unsigned seed = 0; seed < 3 * test::rounds(2u); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Soup soup;
    for (int i = 0; i < 4; ++i) {
      Vec3d low, high;
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = seed % 2 == 0 ? random.below(4) : random.in(0.0, 4.0);
        high[axis] = low[axis] + (seed % 2 == 0 ? 1 + random.below(4) : random.in(1.0, 4.0));
      }
      soup.addBox(low, high);
    }
    if (seed % 3 == 2) {
      soup.move([](const Vec3d& p) {  // about a slanted axis; rounding only bends faces
        return Vec3d(Vec3f(Vec3d{0.36, 0.48, -0.8} * p.x + Vec3d{-0.8, 0.6, 0.0} * p.y +
                           Vec3d{0.48, 0.64, 0.6} * p.z));
      });
    }
    const ConformedMesh mesh = judged(soup);
    EXPECT_EQ(boundaryEdges(mesh.triangles), 0u);
    EXPECT_GT(mesh.divided, 0u);
  }
}

// Tetrahedra of small whole numbers: corners on edges, edges that cross, faces in common.
Soup tetrahedra(unsigned seed, int count) {
  Random random(seed);
  Soup soup;
  for (int i = 0; i < count; ++i) {
    Vec3d p[4];
    for (Vec3d& corner : p) {
      corner = {double(random.below(4)), double(random.below(4)), double(random.below(4))};
    }
    const bool turned = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) > 0.0;
    for (const auto& face : {std::array{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}) {
      soup.add(p[face[0]], p[face[turned ? 2 : 1]], p[face[turned ? 1 : 2]]);
    }
  }
  return soup;
}

TEST(Conform, SolidsStayClosedWhetherPenetrationsAreDividedOrNot) {
  std::uint64_t spared = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Soup soup = tetrahedra(seed, 5);
    const ConformedMesh whole = conform(soup.input(), {.divide = Divide::kFaces}),
                        divided = conform(soup.input());
    ConformJudge(soup, whole).judgeTiling();
    EXPECT_EQ(boundaryEdges(whole.triangles), 0u);
    EXPECT_EQ(boundaryEdges(divided.triangles), 0u);
    EXPECT_LE(whole.source.size(), divided.source.size());
    spared += divided.source.size() - whole.source.size();
    if (seed < 6) {
      ConformJudge(soup, divided).judge();
    }
  }
  EXPECT_GT(spared, 1000u);
}

TEST(Conform, EdgesAloneAreDividedAtVerticesThatAreThere) {
  for (const NamedFamily& family : kFamilies) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(seed));
      const Soup soup = family.make(seed);
      const ConformedMesh mesh = conform(soup.input(), {.divide = Divide::kEdges});
      EXPECT_TRUE(mesh.names.empty());
      EXPECT_EQ(mesh.slack, 0.0);
      ConformJudge(soup, mesh).judgeTiling();
      ConformJudge(soup, mesh).judgeBorders();
    }
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Soup soup = tetrahedra(seed, 5), voxels = greedyVoxels(seed, 6);
    EXPECT_EQ(boundaryEdges(conform(soup.input(), {.divide = Divide::kEdges}).triangles), 0u);
    EXPECT_EQ(boundaryEdges(conform(voxels.input(), {.divide = Divide::kEdges}).triangles), 0u);
  }
}

// Divides triangles at the vertices that lie on their edges, and returns what conform() would. open: by
// triangle, bit k if the edge from corner k to the next may be divided.
ConformedMesh joined(const Soup& soup, std::span<const std::uint8_t> open) {
  std::set<MeshEdge> open_edges;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const std::uint32_t a = soup.triangles[i], b = soup.triangles[i % 3 == 2 ? i - 2 : i + 1];
    if (a != b && (open[i / 3] >> (i % 3) & 1) != 0) {
      open_edges.insert(meshEdge(a, b));
    }
  }
  const std::vector<MeshEdge> edges(open_edges.begin(), open_edges.end());
  std::vector<Vec3f> vertices;
  for (const Vec3d& v : soup.vertices) {
    vertices.emplace_back(v);
    EXPECT_EQ(Vec3d(vertices.back()), v);
  }
  const base::Rows<std::uint32_t> through = verticesOnEdges(vertices, edges);
  BentTriangles pieces;
  TriangleBender bender(edges, through, pieces);
  for (std::uint32_t t = 0; t < soup.count(); ++t) {
    bender.add({soup.triangles[3 * t], soup.triangles[3 * t + 1], soup.triangles[3 * t + 2]}, t);
  }
  ConformedMesh mesh;
  mesh.vertices = soup.vertices;
  mesh.triangles = std::move(pieces.triangles);
  mesh.source = std::move(pieces.source);
  return mesh;
}

TEST(JoinEdges, LeavesNoVertexWithinAnEdge) {
  for (const NamedFamily& family : kFamilies) {
    for (unsigned seed = 0; seed < test::rounds(40u); ++seed) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(seed));
      const Soup soup = family.make(seed);
      const ConformedMesh mesh = joined(soup, std::vector<std::uint8_t>(soup.count(), 0b111));
      ConformJudge(soup, mesh).judgeTiling();
      ConformJudge(soup, mesh).judgeBorders();
    }
  }
  for (unsigned seed = 0; seed < test::rounds(20u); ++seed) {
    const Soup voxels = greedyVoxels(seed, 6);
    EXPECT_GT(boundaryEdges(voxels.triangles), 0u);
    EXPECT_EQ(boundaryEdges(joined(voxels, std::vector<std::uint8_t>(voxels.count(), 0b111)).triangles), 0u);
  }
}

// A unit in the last place beside an edge is beside it, at any scale.
TEST(JoinEdges, ACornerBesideAnEdgeIsNotOnIt) {
  for (const double scale : {0x1p-100, 1.0, 0x1p40}) {
    for (const int ulps : {-1, 0, 1}) {
      Soup soup;
      const Vec3d a = Vec3d{1001, 2003, 3007} * scale, b = a * 3.0;
      Vec3d on = a * 2.0;
      on.y = ulps == 0 ? on.y : std::nextafterf(static_cast<float>(on.y), ulps < 0 ? 0.0f : 1e30f);
      soup.add(a, b, Vec3d{0, 0, 50000} * scale);
      soup.add(on, Vec3d{40000, 0, 0} * scale, Vec3d{50000, 10000, 0} * scale);
      const std::vector<std::uint8_t> open(soup.count(), 0b111);
      EXPECT_EQ(joined(soup, open).source.size(), ulps == 0 ? 3u : 2u) << scale << " " << ulps;
    }
  }
}

TEST(JoinEdges, EdgesThatMayNotBeDividedStayWhole) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  soup.add({2, 0, 0}, {1, -3, 0}, {3, -3, 0});  // a corner on edge 0 of the first
  soup.add({0, 2, 0}, {-3, 3, 0}, {-3, 1, 0});  // a corner on edge 2 of the first
  using Corners = std::set<std::uint32_t>;
  const auto piecesOfFirst = [&](std::uint8_t bits) {
    const std::uint8_t edges[3] = {bits, 0b111, 0b111};
    const ConformedMesh mesh = joined(soup, edges);
    ConformJudge(soup, mesh).judgeTiling();
    std::set<Corners> pieces;
    for (std::size_t i = 0; i < mesh.source.size(); ++i) {
      if (mesh.source[i] == 0) {
        pieces.insert({mesh.triangles[3 * i], mesh.triangles[3 * i + 1], mesh.triangles[3 * i + 2]});
      }
    }
    EXPECT_EQ(mesh.source.size(), pieces.size() + 2);  // the others are whole
    return pieces;
  };
  const std::uint32_t on_edge_0 = soup.triangles[3], on_edge_2 = soup.triangles[6];
  EXPECT_EQ(piecesOfFirst(0b000), (std::set<Corners>{{0, 1, 2}}));
  EXPECT_EQ(piecesOfFirst(0b001), (std::set<Corners>{{0, on_edge_0, 2}, {on_edge_0, 1, 2}}));
  EXPECT_EQ(piecesOfFirst(0b100), (std::set<Corners>{{0, 1, on_edge_2}, {on_edge_2, 1, 2}}));
  EXPECT_EQ(piecesOfFirst(0b101).size(), 3u);
}

// What stands on a slab, without a floor of its own, has its lowest edges in common with pieces of the slab.
TEST(Conform, WallsThatStandOnASlabShareTheirEdgesWithIt) {
  Soup soup;
  soup.addBox({0, 0, 0}, {16, 1, 16});
  Random random(3);
  for (int i = 0; i < 5; ++i) {
    const double x0 = 1 + random.below(6), z0 = 1 + random.below(6), x1 = x0 + 2 + random.below(6),
                 z1 = z0 + 1;
    soup.addQuad({x0, 1, z0}, {x0, 3, z0}, {x1, 3, z1}, {x1, 1, z1});
  }
  const ConformedMesh mesh = judged(soup);
  EXPECT_GT(mesh.contacts.edges_in_faces, 0u);
  // Every edge of a wall at the slab's height belongs to two pieces of the slab as well.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> of_slab;
  for (std::size_t i = 0; i < mesh.source.size(); ++i) {
    for (std::size_t k = 0; k < 3 && mesh.source[i] < 12; ++k) {
      ++of_slab[std::minmax(mesh.triangles[3 * i + k], mesh.triangles[3 * i + (k + 1) % 3])];
    }
  }
  int found = 0;
  for (std::size_t i = 0; i < mesh.source.size(); ++i) {
    for (std::size_t k = 0; k < 3 && mesh.source[i] >= 12; ++k) {
      const std::uint32_t a = mesh.triangles[3 * i + k], b = mesh.triangles[3 * i + (k + 1) % 3];
      if (mesh.vertices[a].y == 1.0 && mesh.vertices[b].y == 1.0) {
        EXPECT_EQ(of_slab[std::minmax(a, b)], 2);
        ++found;
      }
    }
  }
  EXPECT_GE(found, 5);
}

TEST(Conform, EqualPiecesOfCoplanarTrianglesCoincide) {
  for (unsigned seed = 100; seed < 103; ++seed) {
    Soup soup = inOnePlane(seed);
    soup.triangles.resize(18);  // those in the plane
    // The same again, facing the other way: all edges cancel.
    const std::size_t count = soup.triangles.size();
    for (std::size_t i = 0; i < count; i += 3) {
      soup.triangles.insert(soup.triangles.end(),
                            {soup.triangles[i], soup.triangles[i + 2], soup.triangles[i + 1]});
    }
    const ConformedMesh mesh = judged(soup);
    std::map<std::array<std::uint32_t, 3>, int> fronts;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      std::array<std::uint32_t, 3> corners{mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]};
      const std::array<std::uint32_t, 3> as_given = corners;
      std::sort(corners.begin(), corners.end());
      int swaps = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = a + 1; b < 3; ++b) {
          swaps += as_given[a] > as_given[b] ? 1 : 0;
        }
      }
      fronts[corners] += swaps % 2 == 0 ? 1 : -1;
    }
    for (const auto& [corners, value] : fronts) {
      EXPECT_EQ(value, 0);
    }
  }
}

TEST(Conform, DegenerateTrianglesAreLeftOutAndTheirNeighboursDivided) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  soup.add({4, 0, 0}, {2, 0, 0}, {3, -3, 0});  // below the first one's edge, as is the next
  soup.add({2, 0, 0}, {0, 0, 0}, {1, -3, 0});
  soup.add({4, 0, 0}, {0, 0, 0}, {2, 0, 0});  // in the gap that is none
  soup.add({9, 9, 9}, {9, 9, 9}, {8, 8, 8});
  const ConformedMesh mesh = judged(soup);
  EXPECT_EQ(mesh.degenerate, 2u);
  EXPECT_EQ(mesh.source, (std::vector<std::uint32_t>{0, 0, 1, 2}));
  EXPECT_EQ(boundaryEdges(mesh.triangles), 6u);
}

TEST(Conform, DuplicatesStayDuplicates) {
  Soup soup;
  for (int i = 0; i < 3; ++i) {
    soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  }
  soup.add({1, 1, -1}, {1, 1, 1}, {2, 1, 0});
  const ConformedMesh mesh = judged(soup);
  std::array<std::vector<std::array<std::uint32_t, 3>>, 3> pieces;
  for (std::size_t i = 0; i < mesh.source.size(); ++i) {
    if (mesh.source[i] < 3) {
      pieces[mesh.source[i]].push_back(
          {mesh.triangles[3 * i], mesh.triangles[3 * i + 1], mesh.triangles[3 * i + 2]});
    }
  }
  EXPECT_GT(pieces[0].size(), 1u);
  EXPECT_EQ(pieces[0], pieces[1]);
  EXPECT_EQ(pieces[0], pieces[2]);
}

TEST(Conform, WhatCannotBeComputedIsPassedOnAndDividesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  for (const double odd : {nan, infinite, -infinite, 0x1p64, 1e300, -1e300, 1e-300}) {
    soup.add({1, 1, -1}, {1, 1, 1}, {odd, 2, 0});
    soup.add({odd, odd, odd}, {odd, 0, 1}, {1, odd, 0});
  }
  const ConformedMesh mesh = conform(soup.input());
  EXPECT_EQ(mesh.triangles, soup.triangles);
  EXPECT_EQ(mesh.untouched, 14u);
  EXPECT_EQ(mesh.divided, 0u);

  soup.add({1, 1, -1}, {1, 1, 1}, {2, 2, 0});
  const ConformedMesh divided = conform(soup.input());
  EXPECT_EQ(divided.untouched, 14u);
  EXPECT_EQ(divided.divided, 2u);
  ConformJudge(soup, divided).judge();
}

TEST(Conform, LargeAndTinyCoordinatesMeetExactly) {
  for (const double scale : {0x1p-120, 0x1p-40, 1.0, 0x1p60}) {
    Soup soup;
    soup.addBox(Vec3d{0, 0, 0} * scale, Vec3d{4, 4, 4} * scale);
    soup.addBox(Vec3d{1, 1, 3} * scale, Vec3d{3, 2, 5} * scale);
    soup.add(Vec3d{-1, 0, 0} * scale, Vec3d{7, 5, 1} * scale, Vec3d{2, 7, 9} * scale);
    const ConformedMesh mesh = judged(soup);
    EXPECT_GT(mesh.divided, 10u);
    EXPECT_LE(mesh.slack, 1e-14 * scale);
    EXPECT_GT(mesh.slack, 0.0);
  }
  // A triangle of a tiny offset beside a large one: neither is rounded to the other.
  Soup soup;
  soup.add({0, 0, 0}, {0x1p20, 0, 0}, {0, 0x1p20, 0});
  soup.add({1, 1, 0x1p-140}, {2, 1, 0x1p-140}, {1, 2, 0x1p-140});
  EXPECT_EQ(judged(soup).divided, 0u);
}

// Merged voxels whose rectangles have corners of their own, a little apart, and a box pushed into them.
TEST(Conform, CracksNarrowerThanTheWidthAreClosedFirst) {
  const Soup exact = greedyVoxels(2, 5);
  Random random(2);
  Soup soup;
  for (std::size_t i = 0; i < exact.triangles.size(); i += 3) {
    Vec3d corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = exact.vertices[exact.triangles[i + k]] +
                   Vec3d{random.in(0.0, 1e-4), random.in(0.0, 1e-4), random.in(0.0, 1e-4)};
    }
    soup.add(corners[0], corners[1], corners[2]);
  }
  soup.addBox({0.5, 0.5, -2.0}, {2.25, 3.5, 7.0});
  EXPECT_GT(boundaryEdges(conform(soup.input(), {.crack_width = 1e-5}).triangles), 1000u);
  const ConformedMesh mesh = conform(soup.input(), {.crack_width = 1e-3});
  EXPECT_EQ(boundaryEdges(mesh.triangles), 0u);
  EXPECT_GE(mesh.slack, 5e-5);
  EXPECT_LE(mesh.slack, 2e-3);
  EXPECT_EQ(mesh.source.back(), soup.count() - 1);
  EXPECT_TRUE(std::is_sorted(mesh.source.begin(), mesh.source.end()));
}

// A floor in which 8 by 8 walls cross, which is as much as is allowed, or one crossing too many, or one wall.
TEST(Conform, ATriangleFullOfCrossingsIsDividedAtItsBorderOnly) {
  Soup soup;
  soup.add({-300, 0, -300}, {1500, 0, -300}, {-300, 0, 1500});
  constexpr std::size_t kWalls = 8;
  for (std::size_t i = 0; i < kWalls; ++i) {
    const double at = static_cast<double>(i) + 0.5;
    soup.add({at, -1, -400}, {at, -1, 900}, {at, 1, -350});
    soup.add({-200, -1, at}, {600, -1, at}, {-200, 3, at});
  }
  for (const std::size_t most : {kWalls * kWalls, kWalls * kWalls - 1, 2 * kWalls - 1}) {
    const ConformedMesh mesh = conform(soup.input(), {.most_contacts = most});
    const auto pieces = static_cast<std::size_t>(std::count(mesh.source.begin(), mesh.source.end(), 0u));
    if (most == kWalls * kWalls) {
      EXPECT_EQ(mesh.overfull, 0u);
      EXPECT_GT(pieces, kWalls * kWalls);
      ConformJudge(soup, mesh).judge();
    } else {
      EXPECT_EQ(mesh.overfull, 1u);
      EXPECT_EQ(pieces, kWalls + 1);  // each wall of one direction passes through one border
      ConformJudge(soup, mesh).judgeTiling();
    }
    EXPECT_GT(mesh.source.size(), kWalls * kWalls);
  }
}

TEST(Conform, NothingGivesNothing) {
  const ConformedMesh mesh = conform({});
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_EQ(mesh.slack, 0.0);
}

}  // namespace
}  // namespace sightline::occluders
