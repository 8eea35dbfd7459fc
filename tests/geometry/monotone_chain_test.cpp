// The hull of points of a grid, many of them equal or in one line, against brute force.

#include "src/geometry/monotone_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <compare>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/rounds.h"

namespace sightline::geometry {
namespace {

struct GridCorner {
  int x = 0, y = 0;
  friend auto operator<=>(const GridCorner&, const GridCorner&) = default;
};

int turnAt(const GridCorner& a, const GridCorner& b, const GridCorner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

std::vector<GridCorner> hullOf(std::vector<GridCorner> points) {
  std::sort(points.begin(), points.end());
  return convexHull(std::move(points), [](const GridCorner& a, const GridCorner& b, const GridCorner& c) {
    return turnAt(a, b, c) > 0;
  });
}

// Whether p lies strictly between two of the points or strictly inside a triangle of them.
bool isNoCorner(const GridCorner& p, const std::set<GridCorner>& points) {
  for (const GridCorner& a : points) {
    for (const GridCorner& b : points) {
      const bool between = turnAt(a, p, b) == 0 && (a < p && p < b);
      for (const GridCorner& c : points) {
        if (between || (turnAt(a, b, p) > 0 && turnAt(b, c, p) > 0 && turnAt(c, a, p) > 0)) {
          return true;
        }
      }
    }
  }
  return false;
}

TEST(MonotoneChain, GoesCounterClockwiseThroughAllCornersAndNothingElse) {
  for (unsigned seed = 0; seed < test::rounds(2000u); ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t bound) { return static_cast<int>(random() % bound); };
    const std::uint32_t size = 1 + static_cast<std::uint32_t>(below(6));
    std::vector<GridCorner> points(2 + static_cast<std::size_t>(below(12)));
    for (GridCorner& p : points) {
      p = {below(size), below(size)};
    }
    const std::set<GridCorner> all(points.begin(), points.end());
    std::set<GridCorner> corners;
    for (const GridCorner& p : all) {
      if (!isNoCorner(p, all)) {
        corners.insert(p);
      }
    }
    const std::vector<GridCorner> hull = hullOf(points);
    if (all.size() < 2) {
      continue;  // equal points
    }
    EXPECT_EQ(std::set<GridCorner>(hull.begin(), hull.end()), corners) << "seed " << seed;
    EXPECT_EQ(hull.size(), corners.size()) << "seed " << seed;
    EXPECT_EQ(hull[0], *all.begin()) << "seed " << seed;
    for (std::size_t i = 0; i < hull.size() && hull.size() > 2; ++i) {
      EXPECT_GT(turnAt(hull[i], hull[(i + 1) % hull.size()], hull[(i + 2) % hull.size()]), 0)
          << "seed " << seed;
    }
  }
  EXPECT_TRUE(hullOf({{1, 2}}).empty());
}

}  // namespace
}  // namespace sightline::geometry
