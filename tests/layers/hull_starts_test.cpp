#include "src/layers/hull/hull_starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/layers/hull_of.h"
#include "tests/support/layer_shapes.h"

namespace sightline {
namespace {

using shapes::hullOf;
using shapes::Points;
using shapes::Random;

double greatestHeight(const ConvexHull& hull, const Vec3d& direction) {
  double height = dot(direction, hull.vertices.front());
  for (const Vec3d& vertex : hull.vertices) {
    height = std::max(height, dot(direction, vertex));
  }
  return height;
}

// Directions of one cell differ by at most half the main component along each of the two other axes, and two
// vertices by at most twice the size, all in units of the box.
TEST(HullStarts, AreNearlyTheFarthestOfAllVertices) {
  Random random(5);
  for (const Points& points :
       {shapes::toothpick(), shapes::moved(shapes::ellipsoid(24, 12, {9, 1e-3, 0.3}), {1e3, 3, -1e3}),
        shapes::randomBall(random, 500)}) {
    const ConvexHull hull = hullOf(points);
    ASSERT_EQ(hull.starts.size(), layers::kStarts);
    for (int i = 0; i < 2000; ++i) {
      const Vec3d unit = random.direction();
      const Vec3d size = hull.start_size;
      const Vec3d direction(unit.x / size.x, unit.y / size.y, unit.z / size.z);
      const std::uint32_t start = hull.starts[layers::startCell(direction, size)];
      double box = 0.0;  // half the box's largest side, by which start_size is scaled
      for (const Vec3d& vertex : hull.vertices) {
        box = std::max(box, maxComponent(abs(vertex - hull.centre)));
      }
      const double gap = greatestHeight(hull, direction) - dot(direction, hull.vertices[start]);
      ASSERT_LE(gap, 1.001 * maxComponent(abs(unit)) * box) << "direction " << i;
    }
  }
}

TEST(HullStarts, DifferForLongHullsTurnedByLittle) {
  const ConvexHull hull = hullOf(shapes::ellipsoid(24, 40, {0.008, 0.077, 0.008}));
  const std::set<std::uint32_t> starts(hull.starts.begin(), hull.starts.end());
  EXPECT_GT(starts.size(), layers::kStarts / 2);
}

TEST(HullStarts, AreOnlyOfHullsOnWhichSearchesGoUphill) {
  EXPECT_TRUE(hullOf(shapes::cube()).starts.empty());
  EXPECT_TRUE(hullOf(shapes::flatPolygon(50)).starts.empty());
  EXPECT_TRUE(hullOf(shapes::segment({1, 2, 3}, {4, 5, 6})).starts.empty());
}

}  // namespace
}  // namespace sightline
