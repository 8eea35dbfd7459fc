// Meshes as unions of convex pieces: nothing of a mesh is outside the pieces, and rays through the meshes'
// triangles find no occlusion that the order of their pieces lacks.

#include "sightline/layers/convex_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "tests/layers/made_parts.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace made;

struct Mesh {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  Result<std::vector<ConvexHull>> pieces(std::uint32_t most = 16) const {
    return convexPieces(positions, triangles, {.max_pieces = most});
  }
};

// A square tube bent to a circle around the y axis.
Mesh tubeRing(std::uint32_t around, double thickness = 0.1) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double angle = 6.283185307179586 * i / around;
    for (const auto& [radius, y] : {std::pair(1.0, -thickness), std::pair(1.0 + thickness, -thickness),
                                    std::pair(1.0 + thickness, thickness), std::pair(1.0, thickness)}) {
      mesh.positions.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
    }
    const std::uint32_t at = 4 * i, next = 4 * ((i + 1) % around);
    for (std::uint32_t k = 0; k < 4; ++k) {
      mesh.quad(at + k, next + k, next + (k + 1) % 4, at + (k + 1) % 4);
    }
  }
  return mesh;
}

// The walls of an L, as two long quads: large triangles that only cuts can divide.
Mesh corner() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {8, 0, 0}, {8, 3, 0}, {0, 3, 0}, {0, 0, 8}, {0, 3, 8}};
  mesh.quad(0, 1, 2, 3);
  mesh.quad(0, 3, 5, 4);
  return mesh;
}

// Triangles in two clouds.
Mesh soup(Random& random, std::uint32_t triangles) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const Vec3d cloud = i < 3 ? Vec3d(20, 0, 0) : Vec3d();
    mesh.positions.push_back(random.point({-4, -4, -4}, {4, 4, 4}) + cloud);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

double surfaceOf(const ConvexHull& hull) {
  double sum = 0.0;
  for (const auto& [a, b, c] : hull.triangles) {
    sum += 0.5 * length(cross(hull.vertices[b] - hull.vertices[a], hull.vertices[c] - hull.vertices[a]));
  }
  return sum;
}

// Whether a small cube around the point intersects a hull, in exact arithmetic.
bool isInSome(const std::vector<ConvexHull>& hulls, const Vec3d& p) {
  const Points around = shapes::cube(p, 0x1p-36);
  return std::any_of(hulls.begin(), hulls.end(), [&](const ConvexHull& hull) {
    return test::convexHullsIntersect(around, hull.vertices);
  });
}

TEST(ConvexPieces, HoldEveryPointOfTheMesh) {
  Random random(3);
  std::vector<Mesh> meshes{tubeRing(12), corner()};
  for (int i = 0; i < 4; ++i) {
    meshes.push_back(soup(random, 3 + random.below(8)));
  }
  std::size_t divided = 0;
  for (const Mesh& mesh : meshes) {
    const Result<std::vector<ConvexHull>> pieces = mesh.pieces(8);
    ASSERT_TRUE(pieces);
    ASSERT_LE(pieces->size(), 8u);
    divided += pieces->size() > 1 ? 1 : 0;
    for (const ConvexHull& piece : *pieces) {
      EXPECT_LT(piece.slack, 0x1p-40);
    }
    for (int sample = 0; sample < 150; ++sample) {
      const auto& [a, b, c] = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
      double u = random.number(0, 1), v = random.number(0, 1);
      if (u + v > 1.0) {
        u = 1.0 - u, v = 1.0 - v;
      }
      const Vec3d p = mesh.positions[a] * (1.0 - u - v) + mesh.positions[b] * u + mesh.positions[c] * v;
      ASSERT_TRUE(isInSome(*pieces, p)) << sample;
    }
  }
  EXPECT_EQ(divided, meshes.size());
}

TEST(ConvexPieces, OfARingAreMuchSmallerThanItsHull) {
  const Mesh mesh = tubeRing(48);
  const Result<std::vector<ConvexHull>> one = mesh.pieces(1), many = mesh.pieces(16);
  ASSERT_TRUE(one && many);
  ASSERT_EQ(one->size(), 1u);
  EXPECT_GE(many->size(), 12u);
  double sum = 0.0;
  for (const ConvexHull& piece : *many) {
    sum += surfaceOf(piece);
  }
  EXPECT_LT(sum, 0.6 * surfaceOf(one->front()));
}

TEST(ConvexPieces, OfAConvexMeshAreOne) {
  for (const Points& points : {shapes::cube(), shapes::prism(7), shapes::toothpick()}) {
    const ConvexHull hull = *buildHull(points);
    const Mesh mesh{hull.vertices, hull.triangles};
    const Result<std::vector<ConvexHull>> pieces = mesh.pieces();
    ASSERT_TRUE(pieces);
    EXPECT_EQ(pieces->size(), 1u);
    EXPECT_EQ(pieces->front().vertices.size(), hull.vertices.size());
  }
}

PartId addMesh(LayerSorter& sorter, const std::vector<ConvexHull>& pieces) {
  std::vector<HullId> hulls;
  for (const ConvexHull& piece : pieces) {
    hulls.push_back(sorter.addHull(piece));
  }
  return sorter.addPart(hulls);
}

TEST(ConvexPieces, APoleThroughARingIsNotGroupedWithIt) {
  for (const std::uint32_t most : {1u, 16u}) {
    LayerSorter sorter;
    const PartId around = addMesh(sorter, *tubeRing(48).pieces(most));
    const PartId pole = addMesh(sorter, {*buildHull(shapes::box({-0.1, -2, -0.1}, {0.1, 2, 0.1}))});
    // From the side the ring is in front of the pole and behind it; from above, the pole is in the hole.
    EXPECT_EQ(sorter.update(viewFrom({0, 0, 9})).groups(), 1u);
    const View above = viewFrom({0.3, 9, 0.2}, {0, -1, 0.001});
    EXPECT_EQ(sorter.update(above).groups(), most == 1 ? 1u : 2u);
    sorter.setEnabled(around, false);
    EXPECT_EQ(sorter.update(above).group(0)[0], pole);
  }
}

// Where a ray hits a triangle, in lengths of the direction; none within 1e-9 of its edges.
std::optional<double> hitOf(const Vec3d& from, const Vec3d& direction, const Vec3d& a, const Vec3d& b,
                            const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, across = cross(direction, ac);
  const double area = dot(ab, across);
  if (std::abs(area) < 1e-12) {
    return std::nullopt;
  }
  const Vec3d offset = from - a, side = cross(offset, ab);
  const double u = dot(offset, across) / area, v = dot(direction, side) / area, t = dot(ac, side) / area;
  return u > 1e-9 && v > 1e-9 && u + v < 1.0 - 1e-9 && t > 1e-9 ? std::optional(t) : std::nullopt;
}

TEST(ConvexPieces, RaysThroughTheMeshesFindNoOcclusionThatTheOrderLacks) {
  std::size_t pairs = 0, groups = 0, groups_of_one_hull = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(6u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    LayerSorter sorter({.arcs = LayerArcs::kAll}), coarse;
    std::vector<Mesh> meshes;
    for (int i = 0; i < 10; ++i) {
      Mesh mesh = i % 3 == 0 ? corner() : i % 3 == 1 ? tubeRing(12, 0.2) : soup(random, 4);
      const Vec3d to = random.point({-9, -9, -9}, {9, 9, 9}), x = random.direction();
      const Vec3d y = normalized(cross(x, random.direction())), z = cross(x, y);
      for (Vec3d& p : mesh.positions) {
        p = (x * p.x + y * p.y + z * p.z) * (i % 3 == 1 ? 3.0 : 1.0) + to;
      }
      addMesh(sorter, *mesh.pieces(8));
      addMesh(coarse, *mesh.pieces(1));
      meshes.push_back(std::move(mesh));
    }
    const View view = viewFrom({0, 0, 20});
    const Answer answer(sorter.update(view));
    groups += answer.in_order.size();
    groups_of_one_hull += coarse.update(view).groups();
    for (int ray = 0; ray < 3000; ++ray) {
      const Vec3d direction = random.point({-9, -9, -9}, {9, 9, 9}) - view.eye;
      struct Hit {
        std::uint32_t part = 0;
        double at = 0.0;
      };
      std::vector<Hit> hits;
      for (std::uint32_t part = 0; part < meshes.size(); ++part) {
        for (const auto& [a, b, c] : meshes[part].triangles) {
          const std::vector<Vec3d>& p = meshes[part].positions;
          if (const std::optional<double> at = hitOf(view.eye, direction, p[a], p[b], p[c])) {
            hits.push_back({part, *at});
          }
        }
      }
      for (const Hit& front : hits) {
        for (const Hit& back : hits) {
          if (front.part != back.part && front.at < back.at) {
            ++pairs;
            ASSERT_TRUE(answer.hasArc(front.part, back.part)) << front.part << " " << back.part;
          }
        }
      }
    }
  }
  EXPECT_GT(pairs, test::rounds(1000u));
  EXPECT_GT(groups, groups_of_one_hull);
}

TEST(ConvexPieces, HostileMeshesAreRefusedOrDivided) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Mesh mesh = corner();
  EXPECT_FALSE(Mesh{}.pieces());
  EXPECT_FALSE((Mesh{mesh.positions, {}}.pieces()));
  mesh.triangles.push_back({0, 1, 6});
  EXPECT_FALSE(mesh.pieces());
  mesh.triangles.back() = {0, 1, 0xffffffffu};
  EXPECT_FALSE(mesh.pieces());
  mesh = corner();
  mesh.positions[2].y = nan;
  EXPECT_FALSE(mesh.pieces());
  mesh.positions[2].y = 1e200;
  EXPECT_FALSE(mesh.pieces());
  const Mesh point{{{1, 2, 3}}, {{0, 0, 0}, {0, 0, 0}}};
  const Mesh line{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {2, 1, 0}}};
  for (const Mesh* flat : {&point, &line}) {
    const Result<std::vector<ConvexHull>> pieces = flat->pieces();
    ASSERT_TRUE(pieces);
    EXPECT_EQ(pieces->size(), 1u);
  }
  EXPECT_EQ(corner().pieces(0)->size(), 1u);
  EXPECT_LE(tubeRing(12).pieces(0xffffffffu)->size(), std::size_t{kMaxConvexPieces});
  Mesh large = tubeRing(12);
  for (Vec3d& p : large.positions) {
    p = p * 1e99;
  }
  EXPECT_TRUE(large.pieces());
  for (Vec3d& p : large.positions) {
    p = p * 1e-299;
  }
  EXPECT_TRUE(large.pieces());
}

}  // namespace
}  // namespace sightline
