// Polygons of whole cells of a grid, which tell for every point whether it lies in the polygon, and others.

#include "src/io/polygon_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline::io {
namespace {

using test::Random;
using test::rounds;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Point {
  int x = 0, y = 0;
  auto operator<=>(const Point&) const = default;
};
using Ring = std::vector<Point>;
using Cells = std::set<Point>;  // each by its lower left corner

int areaOf(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
int doubleAreaOf(const Ring& ring) {
  int area = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    area += areaOf(ring[0], ring[i], ring[i + 1]);
  }
  return area;
}

Cells randomCells(Random& random, int width, int height, std::size_t count) {
  Cells cells{{width / 2, height / 2}};
  while (cells.size() < count) {
    const Point cell{static_cast<int>(random.below(static_cast<std::uint32_t>(width))),
                     static_cast<int>(random.below(static_cast<std::uint32_t>(height)))};
    for (const Point step : {Point{1, 0}, Point{-1, 0}, Point{0, 1}, Point{0, -1}}) {
      if (cells.contains({cell.x + step.x, cell.y + step.y})) {
        cells.insert(cell);
      }
    }
  }
  return cells;
}

// The outlines of the cells, which lie to the left of them, with all corners of cells. Where two cells meet
// at a corner alone, an outline turns left or right.
std::vector<Ring> outlinesOf(const Cells& cells, bool turn_left) {
  std::set<std::pair<Point, Point>> edges;
  for (const auto& [x, y] : cells) {
    const std::array<Point, 4> corners{{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
      if (edges.erase({corners[(i + 1) % 4], corners[i]}) == 0) {
        edges.insert({corners[i], corners[(i + 1) % 4]});
      }
    }
  }
  std::vector<Ring> rings;
  while (!edges.empty()) {
    auto [from, to] = *edges.begin();
    Ring ring;
    while (edges.erase({from, to}) == 1) {
      ring.push_back(from);
      const Point ahead{to.x - from.x, to.y - from.y}, left{-ahead.y, ahead.x};
      const int first = turn_left ? 1 : -1;
      Point next = {to.x + ahead.x, to.y + ahead.y};
      for (const int side : {-first, first}) {
        const Point beside{to.x + side * left.x, to.y + side * left.y};
        next = edges.contains({to, beside}) ? beside : next;
      }
      from = std::exchange(to, next);
    }
    rings.push_back(std::move(ring));
  }
  // The outline comes first, then those of holes.
  std::sort(rings.begin(), rings.end(),
            [](const Ring& a, const Ring& b) { return doubleAreaOf(a) > doubleAreaOf(b); });
  return rings;
}

bool contains(const Cells& cells, double x, double y) {
  return cells.contains({static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))});
}

bool between(const Point& a, const Point& p, const Point& b) {
  return areaOf(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
         std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

// Whether the line from a to b stays inside and touches no outline but at its ends.
bool canBridge(const Cells& cells, const std::vector<Ring>& rings, const Point& a, const Point& b) {
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point &p = ring[i], &q = ring[(i + 1) % ring.size()];
      if (p != a && p != b && between(a, p, b)) {
        return false;
      }
      if (std::int64_t{areaOf(a, b, p)} * areaOf(a, b, q) < 0 &&
          std::int64_t{areaOf(p, q, a)} * areaOf(p, q, b) < 0) {
        return false;
      }
    }
  }
  const double x = a.x + 0.37 * (b.x - a.x), y = a.y + 0.37 * (b.y - a.y), off = 1e-6;
  return a != b && contains(cells, x - off, y - off) && contains(cells, x + off, y - off) &&
         contains(cells, x - off, y + off) && contains(cells, x + off, y + off);
}

// Whether a corner lies on an edge, between its ends.
bool touchesAnEdge(const Ring& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if (std::any_of(ring.begin(), ring.end(),
                    [&](const Point& p) { return p != a && p != b && between(a, p, b); })) {
      return true;
    }
  }
  return false;
}

bool joinHole(Random& random, const Cells& cells, const std::vector<Ring>& rings, Ring& ring,
              const Ring& hole) {
  const auto once = [](const Ring& in, const Point& p) { return std::count(in.begin(), in.end(), p) == 1; };
  for (int attempt = 0; attempt < 200; ++attempt) {
    const std::size_t i = random.below(static_cast<std::uint32_t>(ring.size()));
    const std::size_t j = random.below(static_cast<std::uint32_t>(hole.size()));
    std::vector<Ring> all = rings;
    all.push_back(ring);
    if (!once(ring, ring[i]) || !once(hole, hole[j]) || !canBridge(cells, all, ring[i], hole[j])) {
      continue;
    }
    Ring detour(hole.begin() + static_cast<std::ptrdiff_t>(j), hole.end());
    detour.insert(detour.end(), hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(j));
    detour.push_back(hole[j]);
    detour.push_back(ring[i]);
    ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i) + 1, detour.begin(), detour.end());
    return true;
  }
  return false;
}

// Leaves some straight corners out and repeats some corners.
Ring thinned(Random& random, const Ring& ring, std::uint32_t kept_of_four) {
  Ring result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &before = ring[(i + ring.size() - 1) % ring.size()], &after = ring[(i + 1) % ring.size()];
    if (areaOf(before, ring[i], after) != 0 || before == after || random.below(4) < kept_of_four) {
      result.push_back(ring[i]);
      if (random.below(40) == 0) {
        result.push_back(ring[i]);
      }
    }
  }
  return result;
}

// How a polygon of the plane stands in space.
struct Placement {
  Vec3d origin, x{1, 0, 0}, y{0, 1, 0};
  Vec3d operator()(const Point& p) const { return origin + x * p.x + y * p.y; }
};

// Half metres on planes along two axes and on sloping ones, all of them exactly; unless `exact`, also in any
// plane, with corners rounded.
Placement randomPlacement(Random& random, bool exact) {
  const int axis = static_cast<int>(random.below(3));
  const auto half = [&] { return 0.5 * (random.below(2) == 0 ? 1.0 : -1.0); };
  Placement placement;
  placement.x = placement.y = {};
  placement.x[axis] = half();
  placement.y[(axis + 1) % 3] = half();
  placement.origin = {std::round(random.in(-1e5, 1e5)), 0.5, std::round(random.in(-9, 9))};
  const std::uint32_t kind = random.below(exact ? 2 : 3);
  if (kind > 0) {
    placement.x[(axis + 2) % 3] = 0.5 * static_cast<double>(random.below(5));
    placement.y[(axis + 2) % 3] = -0.5 * static_cast<double>(random.below(5));
  }
  if (kind == 2) {
    placement.x = random.point(1.0);
    placement.y = cross(placement.x, random.point(1.0));
    placement.origin = random.point(100.0);
  }
  return placement;
}

Triangles cut(const std::vector<Vec3d>& corners, bool exact = true) {
  PolygonTriangulator triangulator;
  const PolygonTriangles result = triangulator.triangulate(corners);
  EXPECT_EQ(result.exact, exact);
  return {result.triangles.begin(), result.triangles.end()};
}

std::vector<Vec3d> placed(const Ring& ring, const Placement& placement) {
  std::vector<Vec3d> corners;
  for (const Point& p : ring) {
    corners.push_back(placement(p));
  }
  return corners;
}

// The triangles are those of the ring, none lies outside of the cells, and their areas add up to the cells'.
void expectCovers(Random& random, const Ring& ring, bool reversed, const Triangles& triangles,
                  const Cells& cells) {
  int area = 0;
  for (const auto& triangle : triangles) {
    const Point &a = ring.at(triangle[0]), &b = ring.at(triangle[1]), &c = ring.at(triangle[2]);
    const int own = (reversed ? -1 : 1) * areaOf(a, b, c);
    EXPECT_GE(own, 0);
    area += own;
    for (int sample = 0; own != 0 && sample < 8; ++sample) {
      double s = random.in(0.0, 1.0), t = random.in(0.0, 1.0);
      if (s + t > 1.0) {
        s = 1.0 - s;
        t = 1.0 - t;
      }
      const double x = a.x + s * (b.x - a.x) + t * (c.x - a.x), y = a.y + s * (b.y - a.y) + t * (c.y - a.y);
      if (std::abs(x - std::round(x)) > 1e-9 && std::abs(y - std::round(y)) > 1e-9) {
        EXPECT_TRUE(contains(cells, x, y)) << x << ' ' << y;
      }
    }
  }
  EXPECT_EQ(area, 2 * static_cast<int>(cells.size()));
}

struct Ways {
  bool from_each_corner = false;
  bool exact = false;  // corners that lie on edges do so when placed
};

// Polygons are cut in both orientations.
void expectCutExactly(Random& random, Ring ring, const Cells& cells, const Ways& ways) {
  for (std::size_t first = 0; first < (ways.from_each_corner ? ring.size() : 1); ++first) {
    for (const bool reversed : {false, true}) {
      const Placement placement = randomPlacement(random, ways.exact);
      expectCovers(random, ring, reversed, cut(placed(ring, placement)), cells);
      if (testing::Test::HasFailure()) {
        for (const Point& p : ring) {
          ADD_FAILURE() << p.x << ' ' << p.y;
        }
        return;
      }
      std::reverse(ring.begin(), ring.end());
    }
    std::rotate(ring.begin(), ring.begin() + 1, ring.end());
  }
}

Cells cellsOf(const std::vector<std::string>& rows) {
  Cells cells;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      if (rows[y][x] == '#') {
        cells.insert({static_cast<int>(x), -static_cast<int>(y)});
      }
    }
  }
  return cells;
}

TEST(PolygonTriangles, OfAnLCoverNothingBesideIt) {
  // The corner between its legs lies on the line from one leg's end to the other's.
  const std::vector<Vec3d> corners{{0, 0, -5}, {2, 0, -5}, {2, 1, -5}, {1, 1, -5}, {1, 2, -5}, {0, 2, -5}};
  double area = 0.0;
  for (const auto& [a, b, c] : cut(corners)) {
    const double own = 0.5 * cross(corners[b] - corners[a], corners[c] - corners[a]).z;
    EXPECT_GT(own, 0.0);
    area += own;
  }
  EXPECT_EQ(area, 3.0);
}

TEST(PolygonTriangles, OfLettersCombsAndStairsCoverJustThem) {
  const std::vector<std::vector<std::string>> shapes{{"#.", "#.", "##"},
                                                     {"###", ".#.", ".#."},
                                                     {"##.", ".#.", ".##"},
                                                     {"#.#", "###"},
                                                     {"#.#.#.#", "#######"},
                                                     {"#...", "##..", "###.", "####"},
                                                     {".#.", "###", ".#."},
                                                     {"#.#", "###", "#.#"},
                                                     {"####", "#...", "####", "...#", "####"},
                                                     {"#..", "##.", ".##", "..#"},
                                                     {"####", "#..#", "#.##"}};
  Random random(1);
  for (const auto& shape : shapes) {
    const Cells cells = cellsOf(shape);
    const std::vector<Ring> rings = outlinesOf(cells, true);
    ASSERT_EQ(rings.size(), 1u);
    for (std::uint32_t kept = 0; kept <= 4; kept += 2) {
      expectCutExactly(random, thinned(random, rings[0], kept), cells, {.from_each_corner = true});
    }
  }
}

TEST(PolygonTriangles, OfAnyShapeOfCellsCoverJustTheCells) {
  Random random(2);
  int touching = 0;
  for (int round = 0; round < rounds(2000); ++round) {
    const int width = 2 + static_cast<int>(random.below(7)), height = 2 + static_cast<int>(random.below(7));
    const auto most = static_cast<std::uint32_t>(width * height);
    const Cells cells = randomCells(random, width, height, 2 + random.below(most - 1));
    std::vector<Ring> rings = outlinesOf(cells, random.below(2) == 0);
    Ring ring = rings[0];
    const std::vector<Ring> holes(rings.begin() + 1, rings.end());
    if (!std::all_of(holes.begin(), holes.end(),
                     [&](const Ring& hole) { return joinHole(random, cells, rings, ring, hole); })) {
      continue;
    }
    ring = thinned(random, ring, random.below(5));
    touching += std::set(ring.begin(), ring.end()).size() < ring.size() ? 1 : 0;
    SCOPED_TRACE(round);
    const bool touches = touchesAnEdge(ring);
    expectCutExactly(random, ring, cells, {.exact = touches});
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(touching, rounds(500));
}

TEST(PolygonTriangles, OfWallsWithWindowsLeaveTheWindowsOpen) {
  Random random(3);
  for (int round = 0; round < rounds(1000); ++round) {
    Cells cells;
    const int width = 7 + static_cast<int>(random.below(4)), height = 4 + static_cast<int>(random.below(3));
    for (int x = 0; x < width; ++x) {
      for (int y = 0; y < height; ++y) {
        cells.insert({x, y});
      }
    }
    const int windows = 1 + static_cast<int>(random.below(2));
    for (int window = 0; window < windows; ++window) {
      for (int x = 0; x <= static_cast<int>(random.below(2)); ++x) {
        for (int y = 0; y <= static_cast<int>(random.below(2)); ++y) {
          cells.erase({1 + 3 * window + x, 1 + y});
        }
      }
    }
    std::vector<Ring> rings = outlinesOf(cells, true);
    for (Ring& ring : rings) {
      ring = thinned(random, ring, 0);
    }
    Ring wall = rings[0];
    for (std::size_t hole = 1; hole < rings.size(); ++hole) {
      ASSERT_TRUE(joinHole(random, cells, rings, wall, rings[hole]));
    }
    SCOPED_TRACE(round);
    expectCutExactly(random, wall, cells, {});
    ASSERT_FALSE(HasFailure());
  }
}

// Star-shaped around the origin: a ray from there tells whether a point lies inside.
TEST(PolygonTriangles, OfStarsCoverJustThem) {
  Random random(4);
  for (int round = 0; round < rounds(500); ++round) {
    const std::uint32_t count = 5 + random.below(40);
    const Vec3d x = normalized(random.point(1.0)), y = normalized(cross(x, random.point(1.0)));
    std::vector<Vec3d> corners;
    std::vector<std::array<double, 2>> flat;
    double area = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 6.283185307179586 * i / count, radius = random.in(0.1, 10.0);
      flat.push_back({radius * std::cos(angle), radius * std::sin(angle)});
      corners.push_back(x * flat.back()[0] + y * flat.back()[1] + Vec3d{1, 2, 3});
    }
    const auto areaOf3 = [](const auto& a, const auto& b, const auto& c) {
      return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    };
    const std::array<double, 2> middle{};
    for (std::uint32_t i = 0; i < count; ++i) {
      area += areaOf3(middle, flat[i], flat[(i + 1) % count]);
    }
    const Triangles triangles = cut(corners);
    EXPECT_EQ(triangles.size(), count - 2);
    for (const auto& [a, b, c] : triangles) {
      EXPECT_GT(areaOf3(flat[a], flat[b], flat[c]), -1e-12);
      area -= areaOf3(flat[a], flat[b], flat[c]);
      const double px = (flat[a][0] + flat[b][0] + flat[c][0]) / 3;
      const double py = (flat[a][1] + flat[b][1] + flat[c][1]) / 3;
      const double turns = std::atan2(py, px) / 6.283185307179586;
      const auto sector = static_cast<std::uint32_t>((turns < 0 ? turns + 1 : turns) * count);
      const std::array<double, 2> p{px, py};
      EXPECT_GT(areaOf3(flat[sector % count], flat[(sector + 1) % count], p), -1e-9);
    }
    EXPECT_NEAR(area, 0.0, 1e-9);
    ASSERT_FALSE(HasFailure()) << round;
  }
}

TEST(PolygonTriangles, OfPolygonsThatCrossOrOverlapThemselvesAreNotExactAndReachAllCorners) {
  const std::vector<std::vector<Vec3d>> polygons{
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},                 // a bow tie
      {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 3, 0}},                 // whose wings differ
      {{0, 3, 0}, {2, -3, 0}, {-3, 1, 0}, {3, 1, 0}, {-2, -3, 0}},  // a pentagram
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},  // twice
                                                                                                 // around
      // A spiral that comes to lie on its own begin.
      {{0, 0, 0},
       {9, 0, 0},
       {9, 9, 0},
       {0, 9, 0},
       {0, -2, 0},
       {5, -2, 0},
       {5, 5, 0},
       {4, 5, 0},
       {4, -1, 0},
       {1, -1, 0},
       {1, 8, 0},
       {8, 8, 0},
       {8, 1, 0},
       {0, 1, 0}},
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, -1, 0}},
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0x1p64}, {0, 1, 0}}};
  for (const std::vector<Vec3d>& polygon : polygons) {
    const Triangles triangles = cut(polygon, false);
    std::set<std::uint32_t> used;
    for (const auto& triangle : triangles) {
      used.insert(triangle.begin(), triangle.end());
    }
    EXPECT_EQ(used.size(), polygon.size());
  }
}

TEST(PolygonTriangles, OfWhatHasNoAreaAreThereAndCoverNothing) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).size(), 2u);
  EXPECT_EQ(cut({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).size(), 3u);
  EXPECT_EQ(cut({{0, 0, 1e-300}, {0, 0, 2e-300}, {0, 0, 0}, {0, 0, 0}}).size(), 2u);
  // A triangle that is given as a quad.
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 1u);
  // A square with a spike that stays inside of its box.
  EXPECT_EQ(cut({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 4, 0}, {2, 1, 0}, {2, 4, 0}, {0, 4, 0}}).size(), 3u);
  // With one that leaves it, its box would be too small.
  EXPECT_EQ(cut({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 4, 0}, {2, 5, 0}, {2, 4, 0}, {0, 4, 0}}, false).size(),
            5u);
}

TEST(PolygonTriangles, OfCornersThatAreNotInOnePlaneAreCutAsSeenAlongTheNormal) {
  // Seen from above an arrow head, whose notch must stay open.
  const std::vector<Vec3d> corners{{0, 0, 0.1}, {3, 1, -0.1}, {0, 2, 0.1}, {1, 1, 0.3}};
  for (const auto& [a, b, c] : cut(corners)) {
    EXPECT_GT(cross(corners[b] - corners[a], corners[c] - corners[a]).z, 0.0);
  }
}

Ring combOf(int teeth) {
  Ring ring{{0, 0}, {2 * teeth - 1, 0}};
  for (int tooth = teeth - 1; tooth >= 0; --tooth) {
    for (const Point p : {Point{2 * tooth + 1, 9}, {2 * tooth, 9}, {2 * tooth, 1}, {2 * tooth - 1, 1}}) {
      ring.push_back(p);
    }
  }
  ring.resize(ring.size() - 2);  // the last tooth stands at the end
  return ring;
}

TEST(PolygonTriangles, OfManyCornersTakeBoundedWork) {
  const Ring comb = combOf(rounds(1000));  // 4 corners each
  const Triangles triangles = cut(placed(comb, {}));
  int area = 0;
  for (const auto& [a, b, c] : triangles) {
    ASSERT_GE(areaOf(comb[a], comb[b], comb[c]), 0);
    area += areaOf(comb[a], comb[b], comb[c]);
  }
  EXPECT_EQ(area, doubleAreaOf(comb));
  const Ring more = combOf(PolygonTriangulator::kMostCorners / 4 + 1);
  EXPECT_EQ(cut(placed(more, {}), false).size(), more.size() - 2);
  // With few steps, small polygons are cut and those beyond them are not.
  PolygonTriangulator hasty(10);
  EXPECT_TRUE(hasty.triangulate(placed(combOf(2), {})).exact);
  EXPECT_FALSE(hasty.triangulate(placed(combOf(500), {})).exact);
  EXPECT_TRUE(hasty.triangulate(placed(combOf(2), {})).exact);
}

}  // namespace
}  // namespace sightline::io
