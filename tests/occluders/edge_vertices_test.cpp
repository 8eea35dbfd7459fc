// Vertices on edges against brute force in rational numbers.

#include "src/occluders/edge_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sightline/math/box.h"
#include "tests/occluders/conform_judge.h"
#include "tests/occluders/triangle_soup.h"
#include "tests/support/cut_work.h"
#include "tests/support/rounds.h"

namespace sightline::occluders {
namespace {

using test::Rational;
using test::RationalVec;
using test::SoupRandom;

// Points with whole coordinates, of which many lie on lines through others, and some of the edges between
// them.
struct WholePoints {
  std::vector<std::array<int, 3>> points;
  std::vector<MeshEdge> edges;  // ascending, none twice

  WholePoints(int size, std::size_t edge_count, unsigned seed) {
    SoupRandom random(seed);
    for (int i = 0; i < size * size * size; ++i) {
      if (random.below(3) != 0) {
        points.push_back({i % size, i / size % size, i / size / size});
      }
    }
    const auto any = [&] {
      return static_cast<std::uint32_t>(random.below(static_cast<int>(points.size())));
    };
    while (edges.size() < edge_count) {
      const std::uint32_t a = any(), b = any();
      if (a != b) {
        edges.push_back(meshEdge(a, b));
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  // Whether a point lies between the ends of an edge: products of small whole numbers, without rounding.
  bool liesOn(const MeshEdge& edge, std::uint32_t v) const {
    int along = 0, length = 0, to_end[3], to_point[3];
    for (std::size_t i = 0; i < 3; ++i) {
      to_end[i] = points[edge.high][i] - points[edge.low][i];
      to_point[i] = points[v][i] - points[edge.low][i];
      along += to_end[i] * to_point[i];
      length += to_end[i] * to_end[i];
    }
    bool on_line = true;
    for (int i = 0; i < 3; ++i) {
      on_line = on_line && to_end[i] * to_point[(i + 1) % 3] == to_end[(i + 1) % 3] * to_point[i];
    }
    return on_line && along > 0 && along < length;
  }
};

TEST(VerticesOnEdges, AreAllThatLieThereExactly) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const WholePoints whole(7, 300, seed);
    std::vector<bool> used(whole.points.size());
    for (const MeshEdge& edge : whole.edges) {
      used[edge.low] = used[edge.high] = true;
    }
    // Exactly the same for points that are small, large, or far away: all sums and products are exact.
    for (const auto& [scale, offset] :
         {std::pair{1.0, 0.0}, {0x1p-60, 0.0}, {0x1p20, -0x1p21}, {0.25, 0x1p20}}) {
      std::vector<Vec3f> vertices;
      for (const std::array<int, 3>& p : whole.points) {
        vertices.emplace_back(Vec3d(p[0], p[1], p[2]) * scale + Vec3d(offset, offset, offset));
      }
      const base::Rows<std::uint32_t> found = verticesOnEdges(vertices, whole.edges);
      ASSERT_EQ(found.count(), whole.edges.size());
      std::size_t all = 0;
      for (std::size_t e = 0; e < whole.edges.size(); ++e) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t v = 0; v < vertices.size(); ++v) {
          if (used[v] && whole.liesOn(whole.edges[e], v)) {
            expected.push_back(v);
          }
        }
        std::vector<std::uint32_t> on_edge(found[e].begin(), found[e].end());
        std::sort(on_edge.begin(), on_edge.end());
        EXPECT_EQ(on_edge, expected) << "seed " << seed << ", scale " << scale << ", edge " << e;
        all += expected.size();
      }
      EXPECT_GT(all, 20u) << "seed " << seed;
    }
  }
}

// Vertices and edges, to which points and edges are added.
struct Edges {
  std::vector<Vec3f> vertices;
  std::vector<MeshEdge> edges;

  std::uint32_t add(const Vec3f& vertex) {
    vertices.push_back(vertex);
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  void addEdge(const Vec3f& from, const Vec3f& to) {
    const std::uint32_t a = add(from);
    edges.push_back(meshEdge(a, add(to)));
  }
  // Only ends of edges count, so a point gets an edge of its own that leads away.
  void addPoint(const Vec3f& at, SoupRandom& random) {
    addEdge(at, at + Vec3f(Vec3d{random.in(1, 2), random.in(1, 2), random.in(1, 2)} * 1e4));
  }
  base::Rows<std::uint32_t> find(const ParallelFor& parallel_for = serialFor) {
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return verticesOnEdges(vertices, edges, parallel_for);
  }
  // The vertices on an edge in rational numbers, of all vertices, in their order along it.
  std::vector<std::uint32_t> expected(const MeshEdge& edge) const {
    Box bounds;  // what is not in it is not on the edge
    bounds.extend(vertices[edge.low]);
    bounds.extend(vertices[edge.high]);
    const RationalVec low{Vec3d(vertices[edge.low])}, along = RationalVec{Vec3d(vertices[edge.high])} - low;
    const Rational length = dot(along, along);
    std::vector<std::pair<Rational, std::uint32_t>> on_edge;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      if (!contains(bounds, Box{vertices[v], vertices[v]})) {
        continue;
      }
      const RationalVec to_point = RationalVec{Vec3d(vertices[v])} - low;
      const Rational part = dot(along, to_point);
      if (part > 0 && part < length && isZero(cross(along, to_point))) {
        on_edge.emplace_back(part, v);
      }
    }
    std::sort(on_edge.begin(), on_edge.end());
    std::vector<std::uint32_t> numbers;
    for (const auto& [part, v] : on_edge) {
      numbers.push_back(v);
    }
    return numbers;
  }
  // Judges what is found; returns how much it is.
  std::size_t judge() {
    const base::Rows<std::uint32_t> found = find();
    EXPECT_EQ(found.count(), edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      EXPECT_EQ(std::vector<std::uint32_t>(found[e].begin(), found[e].end()), expected(edges[e]))
          << "edge " << e;
    }
    return found.items().size();
  }
};

// An edge of so many equal steps that are exact, with vertices at some of its places, and others a unit in
// the last place beside them. digits: of the steps, in units of the last place of the edge's beginning.
void addStepped(Edges& edges, const Vec3d& from, int steps, int digits, bool flat, SoupRandom& random) {
  Vec3d step;
  for (int axis = 0; axis < 3; ++axis) {
    const float at = static_cast<float>(std::abs(from[axis]));
    const double unit =
        at == 0.0f ? 0x1p-12 : double{std::nextafterf(at, std::numeric_limits<float>::max())} - double{at};
    step[axis] = (flat && axis == 1) ? 0.0 : unit * (random.below(2 * digits) - digits);
  }
  const Vec3f end(from + step * steps);
  edges.addEdge(Vec3f(from), end);
  for (int i = 1; i < steps; ++i) {
    const Vec3f place(from + step * i);
    const int choice = random.below(3);
    if (choice > 0) {
      Vec3f at = place;
      if (choice == 2) {
        at[random.below(3)] = std::nextafterf(at[0], 1e30f);
      }
      edges.addPoint(at, random);
    }
  }
}

TEST(VerticesOnEdges, AreFoundAtFewPlacesAndAtMany) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < test::rounds(60u); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SoupRandom random(seed);
    Edges edges;
    for (int i = 0; i < 6; ++i) {
      const double size = std::exp2(random.below(20) - 8);
      Vec3d from{random.in(-size, size), random.in(-size, size), random.in(-size, size)};
      if (random.below(3) == 0) {
        from[random.below(3)] = 0.0;
      }
      // 16 places are looked up one by one, and more of them searched for.
      addStepped(edges, from, 2 + random.below(random.below(2) == 0 ? 6 : 40),
                 random.below(2) == 0 ? 8 : 30000, random.below(3) == 0, random);
    }
    found += edges.judge();
  }
  EXPECT_GT(found, test::rounds(500u));
}

TEST(VerticesOnEdges, AreFoundAlongAxesAndAtEqualPlaces) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < test::rounds(60u); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SoupRandom random(seed);
    Edges edges;
    for (int i = 0; i < 8; ++i) {
      // Zeros of both signs, and places that are equal.
      const auto coordinate = [&] {
        const float values[5] = {0.0f, -0.0f, 1.5f, -2.25f, static_cast<float>(random.in(-3, 3))};
        return values[random.below(5)];
      };
      const Vec3f from{coordinate(), coordinate(), coordinate()};
      const int axis = random.below(3);
      Vec3f to = from;
      to[axis] = coordinate();
      if (from != to) {
        edges.addEdge(from, to);
      }
      for (int k = 0; k < 4; ++k) {
        Vec3f at = from;
        at[axis] = coordinate();
        if (random.below(3) == 0) {
          at[(axis + 1) % 3] = std::nextafterf(at[(axis + 1) % 3], 1e30f);
        }
        edges.addPoint(at, random);
      }
    }
    found += edges.judge();
  }
  EXPECT_GT(found, test::rounds(300u));
}

TEST(VerticesOnEdges, AreFoundAcrossZeroAndAmongTheSmallestNumbers) {
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  Edges edges;
  SoupRandom random(1);
  edges.addEdge({-4 * kTiny, -2 * kTiny, 6 * kTiny}, {4 * kTiny, 2 * kTiny, -6 * kTiny});
  edges.addPoint({0.0f, -0.0f, 0.0f}, random);
  edges.addPoint({2 * kTiny, kTiny, -3 * kTiny}, random);
  edges.addPoint({2 * kTiny, kTiny, -2 * kTiny}, random);
  // Across zero, where other vertices have the smallest numbers.
  edges.addEdge({-3.0f, -1.0f, 5.0f}, {3.0f, 1.0f, -5.0f});
  edges.addPoint({-1.5f, -0.5f, 2.5f}, random);
  edges.addEdge({0.0f, 1.0f, 2.0f}, {8.0f, 2.0f, 4.0f});
  edges.addPoint({4.0f, 1.5f, 3.0f}, random);
  edges.addPoint({2.0f, 1.25f, 2.5f}, random);
  edges.addPoint({2.0f, 1.25f, 2.5f + 1e-6f}, random);
  EXPECT_EQ(edges.judge(), 6u);  // the origin lies on two of them
}

TEST(VerticesOnEdges, AreNoneWhereTheyAreTooManyOrTheEdgeIsOutOfBounds) {
  for (const Vec3f& step : {Vec3f{1, 0, 0}, Vec3f{1, 2, 3}}) {
    for (const int count : {4096, 4097}) {
      Edges edges;
      const float far = static_cast<float>(count + 1);
      edges.addEdge({0, 0, 0}, step * far);
      for (int i = 1; i <= count; ++i) {
        edges.addEdge(step * static_cast<float>(i), Vec3f{-1, -5, static_cast<float>(i)});
      }
      EXPECT_EQ(edges.find()[0].size(), count == 4096 ? 4096u : 0u) << step.y;
    }
  }
  const float infinite = std::numeric_limits<float>::infinity();
  Edges edges;
  edges.addEdge({0, 0, 0}, {0x1p64f, 0, 0});
  edges.addEdge({0, 0, 0}, {infinite, 0, 0});
  edges.addEdge({0, 0, 0}, {std::nanf(""), 0, 0});
  edges.addEdge({1, 0, 0}, {-1, 0, 0});
  edges.addEdge({2, 0, 0}, {2, 0, 0});
  const base::Rows<std::uint32_t> found = edges.find();
  EXPECT_EQ(found.items().size(), 0u);  // no allowed edge ends at the origin
}

TEST(VerticesOnEdges, AreTheSameOnTwoThreads) {
  SoupRandom random(5);
  Edges edges;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d from{double(random.below(9)), double(random.below(9)), double(random.below(9))};
    addStepped(edges, from, 2 + random.below(4), 100, i % 2 == 0, random);
    edges.addEdge(Vec3f(from), Vec3f(from + Vec3d{double(random.below(9)) + 1, 0, 0}));
    edges.addEdge(Vec3f(from), Vec3f(from + Vec3d{3, 5, double(random.below(9))}));
  }
  const base::Rows<std::uint32_t> one = edges.find();
  const base::Rows<std::uint32_t> two = edges.find(onThreads(2));
  ASSERT_EQ(one.count(), two.count());
  EXPECT_GT(one.items().size(), 3000u);
  for (std::size_t e = 0; e < one.count(); ++e) {
    EXPECT_TRUE(std::equal(one[e].begin(), one[e].end(), two[e].begin(), two[e].end()));
  }
}

}  // namespace
}  // namespace sightline::occluders
