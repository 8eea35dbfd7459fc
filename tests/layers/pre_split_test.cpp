#include "sightline/layers/pre_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenes/random.h"

namespace sightline {
namespace {

using Corners = std::array<std::uint32_t, 3>;

constexpr std::uint64_t kSeed = 20240611;

struct PlainMesh {
  std::vector<Vec3d> positions;
  std::vector<Corners> triangles;

  SplitMesh split(const SplitCells& cells, double inflation) const {
    return splitMesh(positions, triangles, cells, inflation);
  }
  Vec3d at(std::size_t t, const Vec3d& weights) const {
    const auto& [a, b, c] = triangles[t];
    return positions[a] * weights.x + positions[b] * weights.y + positions[c] * weights.z;
  }
  double area(std::size_t t) const {
    const auto& [a, b, c] = triangles[t];
    return 0.5 * length(cross(positions[b] - positions[a], positions[c] - positions[a]));
  }
  double area() const {
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      sum += area(t);
    }
    return sum;
  }
};

Vec3d randomPoint(scenes::Random& random, double low, double high) {
  const double x = random.range(low, high), y = random.range(low, high), z = random.range(low, high);
  return {x, y, z};
}

// Returns large and small triangles anywhere in the cube from -1 to 1.
PlainMesh triangleSoup(std::uint32_t count) {
  scenes::Random random(kSeed);
  PlainMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d middle = randomPoint(random, -0.6, 0.6);
    const double reach = random.range(0.02, 0.4);
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(middle + randomPoint(random, -reach, reach));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// Returns the square from -1 to 1 at height 0, made of n x n quads.
PlainMesh floorOf(std::uint32_t n) {
  PlainMesh mesh;
  for (std::uint32_t row = 0; row <= n; ++row) {
    for (std::uint32_t column = 0; column <= n; ++column) {
      mesh.positions.push_back({2.0 * column / n - 1.0, 0.0, 2.0 * row / n - 1.0});
    }
  }
  for (std::uint32_t row = 0; row < n; ++row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t a = row * (n + 1) + column, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

SplitCells terrainCells(std::uint32_t across, std::uint32_t along) {
  const SplitAxis axes[] = {{{2, 0, 0}, -1.0, 1.0, across}, {{0, 0, 1}, -1.0, 1.0, along}};
  return gridCells(axes);
}

struct Case {
  std::string name;
  SplitCells cells;
  bool fills_space = true;
};

// Returns cells of each kind, some with oblique axes.
std::vector<Case> everyKind() {
  const SplitAxis skew[] = {{{1, 0.2, 0}, -0.8, 0.9, 4}, {{0.3, 0, -2}, -1.0, 0.7, 3}};
  const SplitAxis three[] = {{{1, 0, 0}, -1, 1, 3}, {{0, 1, 0}, -1, 1, 2}, {{0, 0, 1}, -1, 1, 4}};
  const Vec3d u = normalized(Vec3d(1, 2, -1)), v = normalized(cross(u, Vec3d(0, 0, 1)));
  std::vector<Case> cases{{"one cell", terrainCells(1, 1)},
                          {"grid", terrainCells(5, 3)},
                          {"skew grid", gridCells(skew)},
                          {"3D grid", gridCells(three)}};
  for (const std::uint32_t sectors : {1u, 2u, 3u, 4u, 5u, 8u, 13u}) {
    cases.push_back({"cylinder of " + std::to_string(sectors), cylinderCells({.axis_point = {0.1, 0, -0.2},
                                                                              .axis = {0.2, 2, 0},
                                                                              .zero = {1, 1, 0},
                                                                              .sectors = sectors,
                                                                              .radius = 0.8,
                                                                              .low = -0.7,
                                                                              .high = 0.9,
                                                                              .slices = 3})});
  }
  cases.push_back({"hexagons",
                   hexagonCells({.origin = {0.05, 0, 0.1},
                                 .width = 0.37,
                                 .low_u = -1.2,
                                 .high_u = 1.1,
                                 .low_v = -1.3,
                                 .high_v = 1.0}),
                   false});
  cases.push_back(
      {"hexagons askew",
       hexagonCells(
           {.u = u, .v = v, .width = 0.5, .low_u = -1.8, .high_u = 1.8, .low_v = -1.8, .high_v = 1.8}),
       false});
  return cases;
}

double areaOf(const SplitTriangle& t) {
  return 0.5 * length(cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0]));
}

double areaOf(const SplitMesh& split) {
  double sum = 0.0;
  for (const SplitPiece& piece : split.pieces) {
    for (const SplitTriangle& triangle : piece.triangles) {
      sum += areaOf(triangle);
    }
  }
  return sum;
}

// Returns the depth of a point inside the cell, negative outside.
double depthIn(const SplitCells& cells, std::uint32_t cell, double inflation, const Vec3d& p) {
  double depth = 1e30;
  for (const Plane& plane : cellPlanes(cells, cell, inflation)) {
    EXPECT_NEAR(length(plane.normal), 1.0, 1e-12);
    depth = std::min(depth, plane.evaluate(p));
  }
  return depth;
}

// Returns twice the signed area of three weights in the plane where they sum to one, seen along (1, 1, 1).
double turn(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(cross(b - a, c - a), Vec3d(1, 1, 1));
}

bool holds(const SplitTriangle& triangle, const Vec3d& weights) {
  const auto& [a, b, c] = triangle.weights;
  constexpr double kTolerance = 1e-9;
  return turn(a, b, weights) >= -kTolerance && turn(b, c, weights) >= -kTolerance &&
         turn(c, a, weights) >= -kTolerance;
}

bool holds(const SplitPiece& piece, std::size_t source, const Vec3d& weights) {
  return std::any_of(piece.triangles.begin(), piece.triangles.end(),
                     [&](const SplitTriangle& t) { return t.source == source && holds(t, weights); });
}

const SplitPiece* pieceOf(const SplitMesh& split, std::uint32_t cell) {
  for (const SplitPiece& piece : split.pieces) {
    if (piece.cell == cell) {
      return &piece;
    }
  }
  return nullptr;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> neighbourCells(const SplitMesh& split) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const SplitNeighbours& n : split.neighbours) {
    pairs.insert({split.pieces[n.first].cell, split.pieces[n.second].cell});
  }
  return pairs;
}

TEST(PreSplit, PiecesWithoutInflationHaveTheMeshsAreaTriangleByTriangle) {
  const PlainMesh mesh = triangleSoup(300);
  for (const Case& c : everyKind()) {
    const SplitMesh split = mesh.split(c.cells, 0.0);
    std::vector<double> area(mesh.triangles.size(), 0.0);
    for (const SplitPiece& piece : split.pieces) {
      for (const SplitTriangle& triangle : piece.triangles) {
        area[triangle.source] += areaOf(triangle);
      }
    }
    for (std::size_t t = 0; t < area.size(); ++t) {
      EXPECT_NEAR(area[t], mesh.area(t), 1e-12) << c.name << " triangle " << t << " seed " << kSeed;
    }
  }
}

TEST(PreSplit, PiecesLieInTheirInflatedCellsAndOnTheirSourceTriangles) {
  const PlainMesh mesh = triangleSoup(200);
  for (const Case& c : everyKind()) {
    for (const double inflation : {0.0, 0.2, 1.5}) {
      const SplitMesh split = mesh.split(c.cells, inflation);
      std::uint32_t next_cell = 0;
      for (const SplitPiece& piece : split.pieces) {
        EXPECT_GE(piece.cell, next_cell);
        next_cell = piece.cell + 1;
        EXPECT_FALSE(piece.triangles.empty());
        for (const SplitTriangle& triangle : piece.triangles) {
          for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_GE(depthIn(c.cells, piece.cell, inflation, triangle.positions[k]), -1e-12) << c.name;
            EXPECT_NEAR(length(mesh.at(triangle.source, triangle.weights[k]) - triangle.positions[k]), 0.0,
                        1e-12)
                << c.name;
          }
        }
      }
    }
  }
}

TEST(PreSplit, EveryInflatedCellHoldsAllOfTheMeshThatIsInIt) {
  const PlainMesh mesh = triangleSoup(100);
  scenes::Random random(kSeed, 1);
  for (const Case& c : everyKind()) {
    const double inflation = 0.2;
    const SplitMesh split = mesh.split(c.cells, inflation);
    std::size_t shared = 0;
    for (int i = 0; i < 400; ++i) {
      const std::size_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
      const double r = std::sqrt(random.uniform()), s = random.uniform();
      const Vec3d weights(1.0 - r, r * (1.0 - s), r * s), p = mesh.at(t, weights);
      std::size_t in = 0;
      for (std::uint32_t cell = 0; cell < c.cells.count; ++cell) {
        if (depthIn(c.cells, cell, inflation, p) > 1e-9) {
          const SplitPiece* piece = pieceOf(split, cell);
          ASSERT_NE(piece, nullptr) << c.name << " seed " << kSeed;
          EXPECT_TRUE(holds(*piece, t, weights)) << c.name << " cell " << cell << " seed " << kSeed;
          ++in;
        }
      }
      EXPECT_GE(in, 1u) << c.name;
      shared += in > 1 ? 1 : 0;
    }
    if (c.cells.count > 1) {
      EXPECT_GT(shared, 20u) << c.name;
    }
  }
}

TEST(PreSplit, CellsFillSpaceWithoutOverlap) {
  scenes::Random random(kSeed, 2);
  for (const Case& c : everyKind()) {
    for (int i = 0; i < 500; ++i) {
      const Vec3d p = randomPoint(random, -1.0, 1.0) * (c.fills_space && i % 2 ? 10.0 : 0.6);
      std::size_t in = 0;
      for (std::uint32_t cell = 0; cell < c.cells.count; ++cell) {
        in += depthIn(c.cells, cell, 0.0, p) > 0.0 ? 1 : 0;
      }
      EXPECT_EQ(in, 1u) << c.name << " seed " << kSeed;
    }
  }
}

TEST(PreSplit, OverlapIsTheFractionOfTheCellsWidth) {
  const SplitCells cells = terrainCells(4, 5);
  const SplitMesh split = floorOf(20).split(cells, 0.2);
  ASSERT_EQ(split.pieces.size(), 20u);
  // Cells are 0.5 by 0.4, and inner cells are larger by 10 % of that on each side.
  Vec3d low(9, 9, 9), high(-9, -9, -9);
  for (const SplitTriangle& triangle : pieceOf(split, 4 + 1)->triangles) {
    for (const Vec3d& p : triangle.positions) {
      low = min(low, p);
      high = max(high, p);
    }
  }
  EXPECT_NEAR(low.x, -0.5 - 0.05, 1e-12);
  EXPECT_NEAR(high.x, 0.0 + 0.05, 1e-12);
  EXPECT_NEAR(low.z, -0.6 - 0.04, 1e-12);
  EXPECT_NEAR(high.z, -0.2 + 0.04, 1e-12);
  // There are 4 borders between rows and 3 between columns; the overlap at each is counted twice.
  EXPECT_NEAR(areaOf(split), (2.0 + 3 * 0.1) * (2.0 + 4 * 0.08), 1e-9);
}

TEST(PreSplit, PlanesHaveEachUninflatedCellOnItsSide) {
  scenes::Random random(kSeed, 3);
  for (const Case& c : everyKind()) {
    for (int i = 0; i < 300; ++i) {
      const Vec3d p = randomPoint(random, -1.0, 1.0) * (i % 3 ? 0.8 : 5.0);
      for (std::uint32_t a = 0; a < c.cells.count; ++a) {
        if (depthIn(c.cells, a, 0.0, p) < 0.0) {
          continue;
        }
        for (std::uint32_t b = 0; b < c.cells.count; ++b) {
          if (a == b) {
            continue;
          }
          const Plane a_first = planeBetween(c.cells, a, b), b_first = planeBetween(c.cells, b, a);
          EXPECT_NEAR(length(a_first.normal), 1.0, 1e-12);
          EXPECT_GE(a_first.evaluate(p), -1e-12) << c.name << " cells " << a << " " << b << " seed " << kSeed;
          EXPECT_LE(b_first.evaluate(p), 1e-12) << c.name << " cells " << a << " " << b << " seed " << kSeed;
        }
      }
    }
  }
}

TEST(PreSplit, NeighboursOverSidesAndCornersHavePlanesAndOthersDoNot) {
  const SplitCells cells = terrainCells(4, 5);
  const auto pairs = neighbourCells(floorOf(10).split(cells, 0.2));
  for (std::uint32_t a = 0; a < 20; ++a) {
    for (std::uint32_t b = a + 1; b < 20; ++b) {
      const int columns = std::abs(int(a % 4) - int(b % 4)), rows = std::abs(int(a / 4) - int(b / 4));
      EXPECT_EQ(pairs.count({a, b}), columns <= 1 && rows <= 1 ? 1u : 0u) << a << " " << b;
    }
  }
}

TEST(PreSplit, LargeInflationMakesNeighboursOfCellsFartherApart) {
  const auto pairs = neighbourCells(floorOf(10).split(terrainCells(4, 1), 1.2));
  EXPECT_EQ(pairs.count({0, 2}), 1u);
  EXPECT_EQ(pairs.count({0, 3}), 0u);
}

TEST(PreSplit, PiecesThatShareAPointOfTheMeshAreNeighboursWithTheirCellsPlane) {
  const PlainMesh mesh = triangleSoup(150);
  for (const Case& c : everyKind()) {
    const SplitMesh split = mesh.split(c.cells, 0.2);
    const auto pairs = neighbourCells(split);
    for (const SplitPiece& a : split.pieces) {
      for (const SplitPiece& b : split.pieces) {
        const bool intersect =
            a.cell < b.cell &&
            std::any_of(a.triangles.begin(), a.triangles.end(), [&](const SplitTriangle& t) {
              return std::any_of(t.positions.begin(), t.positions.end(),
                                 [&](const Vec3d& p) { return depthIn(c.cells, b.cell, 0.2, p) >= 0.0; });
            });
        if (intersect) {
          EXPECT_EQ(pairs.count({a.cell, b.cell}), 1u) << c.name << " cells " << a.cell << " " << b.cell;
        }
      }
    }
    for (const SplitNeighbours& n : split.neighbours) {
      EXPECT_LT(n.first, n.second);
      const Plane plane = planeBetween(c.cells, split.pieces[n.first].cell, split.pieces[n.second].cell);
      EXPECT_EQ(n.rule.plane.normal, plane.normal);
      EXPECT_EQ(n.rule.plane.offset, plane.offset);
    }
  }
}

TEST(PreSplit, AnyTwoSectorsOfACupAreParted) {
  // The bottom of a cup, at whose axis all sectors touch.
  const SplitCells cells = cylinderCells({.sectors = 7});
  EXPECT_EQ(floorOf(6).split(cells, 0.1).neighbours.size(), 7u * 6u / 2u);
  for (std::uint32_t s = 0; s < 7; ++s) {
    const Plane plane = planeBetween(cells, s, (s + 1) % 7);
    EXPECT_NEAR(plane.offset, 0.0, 1e-15);
    EXPECT_NEAR(plane.normal.y, 0.0, 1e-15);
  }
}

TEST(PreSplit, NoPlanePartsHexagonsThoughOnePartsEachPair) {
  const SplitCells cells = hexagonCells({.width = 0.4, .low_u = -1, .high_u = 1, .low_v = -1, .high_v = 1});
  const PlainMesh floor = floorOf(3);
  const SplitMesh split = floor.split(cells, 0.0);
  EXPECT_NEAR(areaOf(split), 4.0, 1e-12);
  ASSERT_GT(split.neighbours.size(), 60u);
  const auto isCut = [&](const SplitPiece& piece, const Plane& plane) {
    double low = 1.0, high = -1.0;
    for (const SplitTriangle& triangle : piece.triangles) {
      for (const Vec3d& p : triangle.positions) {
        low = std::min(low, plane.evaluate(p));
        high = std::max(high, plane.evaluate(p));
      }
    }
    return low < -1e-9 && high > 1e-9;
  };
  for (const SplitNeighbours& n : split.neighbours) {
    const Plane& plane = n.rule.plane;
    EXPECT_FALSE(isCut(split.pieces[n.first], plane));
    EXPECT_FALSE(isCut(split.pieces[n.second], plane));
    EXPECT_TRUE(std::any_of(split.pieces.begin(), split.pieces.end(),
                            [&](const SplitPiece& piece) { return isCut(piece, plane); }));
  }
}

TEST(PreSplit, WhatLiesExactlyBetweenTwoCellsIsInOneOfThem) {
  // Upright triangles in the planes between cells of a grid, of hexagons and of sectors.
  PlainMesh wall;
  wall.positions = {{0, 0, -0.9}, {0, 0, 0.9}, {0, 1, 0}, {0.1, -0.3, 0}, {0.9, -0.3, 0}, {0.5, 0.5, 0}};
  wall.triangles = {{0, 1, 2}, {3, 4, 5}, {2, 1, 0}};
  const SplitCells of_hexagons = hexagonCells(
      {.origin = {0.2, 0, 0}, .width = 0.4, .low_u = -1.5, .high_u = 1.5, .low_v = -1.5, .high_v = 1.5});
  for (const SplitCells& cells :
       {terrainCells(2, 2), terrainCells(4, 6), cylinderCells({.sectors = 4}), cylinderCells({.sectors = 2}),
        cylinderCells({.sectors = 8, .radius = 2.0}), of_hexagons}) {
    EXPECT_NEAR(areaOf(wall.split(cells, 0.0)), wall.area(), 1e-12);
  }
}

TEST(PreSplit, CellsThatAreOnlyTouchedGetNothing) {
  PlainMesh mesh;  // lies in x <= 0 and touches x = 0 with a vertex and with an edge
  mesh.positions = {{-0.5, 0, 0.1}, {-0.5, 0, 0.5}, {0, 0, 0.2}, {0, 0.5, 0.3}, {-0.5, 0.5, 0.3}};
  mesh.triangles = {{0, 1, 2}, {2, 3, 4}};
  const SplitMesh split = mesh.split(terrainCells(2, 2), 0.0);
  ASSERT_EQ(split.pieces.size(), 1u);
  EXPECT_EQ(split.pieces[0].cell, 2u);
  ASSERT_EQ(split.pieces[0].triangles.size(), 2u);
  EXPECT_EQ(split.pieces[0].triangles[0].positions[2], mesh.positions[2]);
  EXPECT_EQ(split.pieces[0].triangles[1].weights[0], Vec3d(1, 0, 0));
  EXPECT_TRUE(split.neighbours.empty());
}

TEST(PreSplit, WindingStays) {
  const SplitMesh split = floorOf(7).split(terrainCells(5, 3), 0.2);
  for (const SplitPiece& piece : split.pieces) {
    for (const SplitTriangle& t : piece.triangles) {
      EXPECT_GE(cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0]).y, -1e-15);
    }
  }
}

TEST(PreSplit, NothingGivesNothing) {
  const SplitMesh split = splitMesh({}, {}, terrainCells(3, 3), 0.2);
  EXPECT_TRUE(split.pieces.empty());
  EXPECT_TRUE(split.neighbours.empty());
}

}  // namespace
}  // namespace sightline
