#include "src/layers/hull/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/layers/hull_of.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"

namespace sightline {
namespace {

using shapes::hullOf;
using shapes::Points;
using shapes::Random;
using test::Exact;

// Returns random directions, normals of triangles and faces (ties), and directions perpendicular to edges.
std::vector<Vec3d> directionsFor(const ConvexHull& hull, Random& random, std::size_t count) {
  std::vector<Vec3d> directions{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  while (directions.size() < count) {
    directions.push_back(random.direction() * std::exp2(random.number(-20, 20)));
    if (!hull.faces.empty()) {
      directions.push_back(hull.faces[random.below(static_cast<std::uint32_t>(hull.faces.size()))].normal);
    }
    const auto v = random.below(static_cast<std::uint32_t>(hull.vertices.size()));
    if (hull.first_neighbour[v] < hull.first_neighbour[v + 1]) {
      const Vec3d edge = hull.vertices[hull.neighbours[hull.first_neighbour[v]]] - hull.vertices[v];
      directions.push_back(cross(edge, random.direction()));
      directions.push_back(cross(edge, hull.vertices[v] - hull.centre));
    }
  }
  return directions;
}

void expectNoPointHigher(const ConvexHull& hull, const Points& points, const Vec3d& direction,
                         const layers::Support& found) {
  ASSERT_LT(found.vertex, hull.vertices.size());
  ASSERT_EQ(found.height, dot(direction, hull.vertices[found.vertex]));
  // Vertices whose rounded heights are near the greatest are compared exactly.
  const double bound = layers::supportError(hull, length(direction) * (1 + 0x1p-50));
  const Exact limit = Exact(found.height) + Exact(bound);
  for (const Vec3d& p : points) {
    if (dot(direction, p) >= found.height - bound) {
      ASSERT_LE(test::exactDot(direction, p), limit);
    }
  }
}

TEST(Support, NoPointIsHigherThanTheErrorAllowsFromAnyStart) {
  Random random(11);
  const std::vector<Points> sets{
      shapes::cube(),
      shapes::turned(shapes::prism(30), shapes::randomAxes(random)),
      shapes::toothpick(),
      shapes::moved(shapes::ellipsoid(24, 6, {1, 1e-3, 0.3}), {1e6, 3, -1e5}),
      shapes::scaled(shapes::randomBall(random, 800), 1e-6),
      shapes::scaled(shapes::turned(shapes::ellipsoid(30, 20, {1, 7, 2}), shapes::randomAxes(random)), 1e6),
      shapes::randomGrid(random, 400, 8),
      shapes::flatPolygon(50),
      shapes::segment({1, 2, 3}, {4, 5, 6}),
      shapes::point({1, 2, 3}),
  };
  for (std::size_t s = 0; s < sets.size(); ++s) {
    SCOPED_TRACE(s);
    const ConvexHull hull = hullOf(sets[s]);
    for (const Vec3d& direction : directionsFor(hull, random, 600)) {
      const auto start = random.below(static_cast<std::uint32_t>(hull.vertices.size()) + 2);
      expectNoPointHigher(hull, sets[s], direction, layers::farthest(hull, direction, start));
      if (HasFatalFailure()) {
        return;
      }
    }
  }
}

TEST(Support, EveryStartLeadsToTheSameHeight) {
  Random random(13);
  const Points points = shapes::toothpick();
  const ConvexHull hull = hullOf(points);
  ASSERT_GT(hull.descent_factor, 0.0);
  for (const Vec3d& direction : directionsFor(hull, random, 60)) {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3d& v : hull.vertices) {
      most = std::max(most, dot(direction, v));
    }
    const double bound = layers::supportError(hull, length(direction));
    for (std::uint32_t start = 0; start < hull.vertices.size(); ++start) {
      const layers::Support found = layers::farthest(hull, direction, start);
      ASSERT_LE(found.height, most);
      ASSERT_GE(found.height, most - bound);
    }
    ASSERT_LE(bound, 1e-10 * length(direction) * hull.radius + std::numeric_limits<double>::min() * 1e6);
  }
}

TEST(Support, TiesGoToTheLowerVertex) {
  const ConvexHull cube = hullOf(shapes::cube());
  EXPECT_EQ(layers::farthest(cube, {0, 0, 1}, 7).vertex, 4u);
  EXPECT_EQ(layers::farthest(cube, {0, 0, 0}, 3).vertex, 0u);
  EXPECT_EQ(layers::farthest(cube, {-1, 0, 0}, 6).vertex, 0u);
}

TEST(Support, StrangeStartsAndDirectionsDoNoHarm) {
  const ConvexHull hull = hullOf(shapes::toothpick());
  EXPECT_LT(layers::farthest(hull, {1, 2, 3}, 0xffffffffu).vertex, hull.vertices.size());
  const double huge = std::numeric_limits<double>::max();
  const ConvexHull large = hullOf(shapes::scaled(shapes::toothpick(), 1e100));
  const layers::Support found = layers::farthest(large, {huge, -huge, huge}, 17);
  EXPECT_LT(found.vertex, large.vertices.size());
  EXPECT_EQ(layers::supportError(large, huge), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace sightline
