#include "sightline/layers/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

#include "tests/layers/hull_of.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using shapes::hullOf;
using shapes::Points;
using shapes::Random;
using test::Exact;
using Place = std::tuple<double, double, double>;

std::set<Place> places(const Points& points) {
  std::set<Place> set;
  for (const Vec3d& p : points) {
    set.insert({p.x, p.y, p.z});
  }
  return set;
}

// Returns the distinct positions that are not in the hull of the other positions.
std::set<Place> extremePlaces(const Points& points) {
  const std::set<Place> all = places(points);
  std::set<Place> extreme;
  for (const Place& place : all) {
    Points others;
    for (const auto& [x, y, z] : all) {
      if (Place{x, y, z} != place) {
        others.emplace_back(x, y, z);
      }
    }
    const auto& [x, y, z] = place;
    if (!test::inConvexHull({x, y, z}, others)) {
      extreme.insert(place);
    }
  }
  return extreme;
}

void expectClosed(const ConvexHull& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : hull.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{t[i], t[(i + 1) % 3]}];
    }
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
}

void expectConvex(const ConvexHull& hull) {
  for (const auto& t : hull.triangles) {
    for (const Vec3d& v : hull.vertices) {
      ASSERT_GE(test::exactVolume(hull.vertices[t[0]], hull.vertices[t[1]], hull.vertices[t[2]], v), 0);
    }
  }
}

// Returns the edges between triangles that do not lie in one plane, by exact volumes.
void expectEdgesAreWhereTheSurfaceBends(const ConvexHull& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> opposite;
  for (const auto& t : hull.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      opposite[{t[i], t[(i + 1) % 3]}] = t[(i + 2) % 3];
    }
  }
  std::vector<std::vector<std::uint32_t>> expected(hull.vertices.size());
  for (const auto& [edge, corner] : opposite) {
    const auto& [a, b] = edge;
    const std::uint32_t beyond = opposite.at({b, a});
    if (test::exactVolume(hull.vertices[a], hull.vertices[b], hull.vertices[corner], hull.vertices[beyond]) !=
        0) {
      expected[a].push_back(b);
    }
  }
  ASSERT_EQ(hull.first_neighbour.size(), hull.vertices.size() + 1);
  for (std::size_t v = 0; v < expected.size(); ++v) {
    const std::vector<std::uint32_t> neighbours(hull.neighbours.begin() + hull.first_neighbour[v],
                                                hull.neighbours.begin() + hull.first_neighbour[v + 1]);
    ASSERT_EQ(neighbours, expected[v]);
  }
}

void expectFacesHoldVertices(const ConvexHull& hull) {
  double size = hull.radius;
  for (const Vec3d& v : hull.vertices) {
    size = std::max(size, maxComponent(abs(v)));
  }
  for (std::size_t f = 0; f < hull.faces.size(); f += 1 + hull.faces.size() / 40) {
    const Plane& face = hull.faces[f];
    EXPECT_NEAR(length(face.normal), 1.0, 1e-15);
    Exact highest = -2 * Exact(hull.radius);
    for (const Vec3d& v : hull.vertices) {
      const Exact height = test::exactDot(face.normal, v) + Exact(face.offset);
      ASSERT_LE(height, 0);
      highest = std::max(highest, height);
    }
    EXPECT_GE(highest.convert_to<double>(), -1e-14 * size);
  }
}

// Expects that no point is farther from the hull than its slack. A box around the point that contains the
// ball of that radius must intersect the hull.
void expectPointsWithinSlack(const ConvexHull& hull, const Points& points, std::size_t step = 1) {
  const double s = hull.slack;
  for (std::size_t i = 0; i < points.size(); i += step) {
    // The box's corners are rounded to the last digit of the coordinates.
    const double half = s * (1 + 1e-9) + 0x1p-52 * maxComponent(abs(points[i]));
    const Points box = s > 0.0 ? shapes::cube(points[i], half) : Points{points[i]};
    ASSERT_TRUE(test::convexHullsIntersect(box, hull.vertices))
        << "point " << i << " dimension " << hull.dimension << " slack " << s;
  }
}

void expectBall(const ConvexHull& hull) {
  for (const Vec3d& v : hull.vertices) {
    Exact square = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Exact d = Exact(v[axis]) - Exact(hull.centre[axis]);
      square += d * d;
    }
    ASSERT_LE(square, Exact(hull.radius) * Exact(hull.radius));
  }
}

void expectSound(const ConvexHull& hull, const Points& points, std::size_t step = 1) {
  const std::set<Place> given = places(points);
  for (const Place& place : places(hull.vertices)) {
    ASSERT_TRUE(given.contains(place));
  }
  EXPECT_EQ(places(hull.vertices).size(), hull.vertices.size());
  expectBall(hull);
  expectPointsWithinSlack(hull, points, step);
  if (hull.dimension == 3) {
    expectClosed(hull);
    expectConvex(hull);
    expectEdgesAreWhereTheSurfaceBends(hull);
    expectFacesHoldVertices(hull);
  } else {
    EXPECT_TRUE(hull.faces.empty());
    EXPECT_TRUE(hull.triangles.empty());
    const std::size_t count = hull.vertices.size();
    EXPECT_EQ(std::min<std::size_t>(count, 3), static_cast<std::size_t>(hull.dimension) + 1);
    EXPECT_EQ(hull.neighbours.size(), static_cast<std::size_t>(hull.dimension) * count);
  }
}

// Returns the points of a cube and more points all over its sides and edges.
Points dicedCube(int cuts) {
  Points points;
  for (int i = 0; i <= cuts; ++i) {
    for (int j = 0; j <= cuts; ++j) {
      for (int k = 0; k <= cuts; ++k) {
        if (i % cuts == 0 || j % cuts == 0 || k % cuts == 0) {
          points.emplace_back(2.0 * i / cuts - 1, 2.0 * j / cuts - 1, 2.0 * k / cuts - 1);
        }
      }
    }
  }
  return points;
}

TEST(Hull, ACubeHasSixFacesAndThreeEdgesACorner) {
  const ConvexHull hull = hullOf(dicedCube(4));
  EXPECT_EQ(hull.dimension, 3);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles.size(), 12u);
  EXPECT_EQ(hull.faces.size(), 6u);
  for (std::size_t v = 0; v < 8; ++v) {
    EXPECT_EQ(hull.first_neighbour[v + 1] - hull.first_neighbour[v], 3u);
  }
  EXPECT_EQ(hull.slack, 0.0);
  // Along the sum of the three sides' normals, the other end of an edge is lower by 2 / sqrt(3) and the far
  // corner by three times that. The mean of the triangles' normals differs a little from that sum.
  EXPECT_GE(hull.descent_factor, 3.0);
  EXPECT_LE(hull.descent_factor, 8.0);
}

TEST(Hull, PointsInTheSidesOfATurnedCubeAreNoVertices) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points points = shapes::turned(dicedCube(6), shapes::randomAxes(random));
    const ConvexHull hull = hullOf(points);
    EXPECT_EQ(hull.vertices.size(), 8u);
    EXPECT_LE(hull.slack, 1e-13);
    EXPECT_GT(hull.descent_factor, 0.0);
    expectSound(hull, points, 7);
  }
}

TEST(Hull, VerticesOfWholePointsAreTheExtremeOnes) {
  std::map<int, int> dimensions;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int half = random.whole(1, 4);
    const Points points = shapes::randomGrid(random, 1 + random.below(30), half);
    const ConvexHull hull = hullOf(points);
    ++dimensions[hull.dimension];
    ASSERT_EQ(places(hull.vertices), extremePlaces(points));
    expectSound(hull, points);
    if (HasFatalFailure()) {
      return;
    }
  }
  for (int dimension = 0; dimension <= 3; ++dimension) {
    EXPECT_GT(dimensions[dimension], 0) << dimension;
  }
}

TEST(Hull, FindsTheDimensionOfFlatWholePoints) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points points = shapes::randomFlatGrid(random, 1 + random.below(12), 4, random.whole(0, 2));
    const ConvexHull hull = hullOf(points);
    ASSERT_LE(hull.dimension, 2);
    ASSERT_EQ(places(hull.vertices), extremePlaces(points));
    expectSound(hull, points);
  }
}

TEST(Hull, APolygonsNeighboursGoRoundItsOutline) {
  const std::size_t sides = 9;
  const ConvexHull hull = hullOf(shapes::flatPolygon(sides));
  ASSERT_EQ(hull.vertices.size(), sides);
  for (std::uint32_t v = 0; v < sides; ++v) {
    const std::set<std::uint32_t> expected{static_cast<std::uint32_t>((v + 1) % sides),
                                           static_cast<std::uint32_t>((v + sides - 1) % sides)};
    const std::set<std::uint32_t> found(hull.neighbours.begin() + hull.first_neighbour[v],
                                        hull.neighbours.begin() + hull.first_neighbour[v + 1]);
    EXPECT_EQ(found, expected);
  }
}

TEST(Hull, FlatUpToRoundingIsFlatWithItsThicknessInTheSlack) {
  for (std::uint64_t seed = 1; seed <= test::rounds(50u); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const shapes::Axes axes = shapes::randomAxes(random);
    const Vec3d away = random.direction() * 10.0;
    const Points disc = shapes::moved(shapes::turned(shapes::flatPolygon(24), axes), away);
    const ConvexHull polygon = hullOf(disc);
    EXPECT_EQ(polygon.dimension, 2);
    EXPECT_EQ(polygon.vertices.size(), 24u);
    EXPECT_LE(polygon.slack, 1e-12);
    expectSound(polygon, disc);
    Points line;
    for (int i = 0; i < 20; ++i) {
      line.push_back(away + axes.x * random.number(-3, 3));
    }
    const ConvexHull segment = hullOf(line);
    EXPECT_EQ(segment.dimension, 1);
    EXPECT_LE(segment.slack, 1e-12);
    expectSound(segment, line);
  }
}

// The third corner is just so far off the line through the others that the three have a plane, and its image
// along an axis is too close to the line's for a corner.
TEST(Hull, ATriangleTooThinForAPolygonIsASegment) {
  const Points corners{{0, 0, 0}, {8388593, -5388576, -3000017}, {588943, -378319, -210624}};
  for (const double scale : {1.0, 0x1p-300, 1e60}) {
    const Points points = shapes::scaled(corners, scale);
    const ConvexHull hull = hullOf(points);
    EXPECT_EQ(hull.dimension, 1) << scale;
    expectSound(hull, points);
  }
}

TEST(Hull, SizeAndPlaceDoNotMatter) {
  Random random(7);
  const std::vector<Points> sets{shapes::cube(),
                                 shapes::turned(shapes::prism(7), shapes::randomAxes(random)),
                                 shapes::randomBall(random, 60),
                                 shapes::ellipsoid(12, 5, {1, 7, 1}),
                                 shapes::flatPolygon(5),
                                 shapes::segment({1, 2, 3}, {-1, 0, 0.5})};
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const ConvexHull plain = hullOf(sets[s]);
    for (const double scale : {0x1p-600, 1e-6, 1e6, 1e90}) {
      SCOPED_TRACE(testing::Message() << "set " << s << " scale " << scale);
      const Points points = shapes::scaled(sets[s], scale);
      const ConvexHull hull = hullOf(points);
      EXPECT_EQ(hull.dimension, plain.dimension);
      EXPECT_EQ(hull.vertices.size(), plain.vertices.size());
      EXPECT_EQ(hull.triangles.size(), plain.triangles.size());
      EXPECT_LE(hull.slack, 1e-12 * scale);
      EXPECT_EQ(hull.descent_factor > 0.0, plain.descent_factor > 0.0);
      expectSound(hull, points, 5);
    }
    SCOPED_TRACE(testing::Message() << "set " << s << " far away");
    const Points points = shapes::moved(sets[s], {1e6, -1e6, 1e6});
    const ConvexHull hull = hullOf(points);
    EXPECT_EQ(hull.dimension, plain.dimension);
    EXPECT_EQ(hull.vertices.size(), plain.vertices.size());
    EXPECT_LE(hull.slack, 1e-8);
    expectSound(hull, points, 5);
  }
}

TEST(Hull, RandomSolidsAreSound) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Vec3d stretch{std::exp2(random.number(-12, 0)), 1.0, std::exp2(random.number(-12, 0))};
    const shapes::Axes axes = shapes::randomAxes(random);
    Points points = shapes::randomBall(random, 20 + random.below(150));
    for (Vec3d& p : points) {
      p = axes.turn({p.x * stretch.x, p.y, p.z * stretch.z});
    }
    const ConvexHull hull = hullOf(points);
    EXPECT_EQ(hull.dimension, 3);
    EXPECT_LE(hull.slack, 1e-12);
    expectSound(hull, points, 9);
  }
}

TEST(Hull, NearlyFlatAndNearlyStraightSolidsAreSound) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Vec3d thin{std::exp2(random.number(-56, -30)), 1.0,
                     random.below(2) == 0 ? 1.0 : std::exp2(random.number(-56, -30))};
    const shapes::Axes axes = shapes::randomAxes(random);
    Points points = random.below(2) == 0 ? shapes::randomBall(random, 12) : dicedCube(2);
    for (Vec3d& p : points) {
      p = axes.turn({p.x * thin.x, p.y, p.z * thin.z});
    }
    const ConvexHull hull = hullOf(points);
    EXPECT_LE(hull.slack, 1e-11);
    expectSound(hull, points);
  }
}

TEST(Hull, TheSamePointsManyTimesChangeNothing) {
  Random random(3);
  const Points once = shapes::randomBall(random, 30);
  Points often;
  for (int i = 0; i < 200; ++i) {
    often.push_back(once[random.below(30)]);
  }
  often.insert(often.end(), once.begin(), once.end());
  EXPECT_EQ(places(hullOf(often).vertices), places(hullOf(once).vertices));
  EXPECT_EQ(hullOf(Points(50, {1, 2, 3})).vertices.size(), 1u);
  EXPECT_EQ(hullOf(Points(50, {1, 2, 3})).slack, 0.0);
}

TEST(Hull, TheToothpickKeepsAllItsPoints) {
  const Points points = shapes::toothpick();
  const ConvexHull hull = hullOf(points);
  EXPECT_EQ(hull.vertices, points);
  EXPECT_EQ(hull.triangles.size(), 640u);
  EXPECT_GT(hull.descent_factor, 0.0);
  EXPECT_LT(hull.descent_factor, 1e4);
  expectClosed(hull);
  expectFacesHoldVertices(hull);
}

TEST(Hull, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(buildHull({}));
  EXPECT_FALSE(buildHull(Points{{0, 0, 0}, {1, nan, 0}}));
  EXPECT_FALSE(buildHull(Points{{0, 0, std::numeric_limits<double>::infinity()}}));
  EXPECT_FALSE(buildHull(Points{{0, -1.1e100, 0}}));
  EXPECT_TRUE(buildHull(Points{{0, -1e100, 0}}));
  // Too many points are refused before any is read, so their memory is never written.
  constexpr std::size_t kTooMany = (std::size_t{1} << 24) + 1;
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(kTooMany * sizeof(Vec3d));
  EXPECT_FALSE(buildHull({reinterpret_cast<const Vec3d*>(memory.get()), kTooMany}));
}

TEST(Hull, WritesNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    Points points = shapes::randomBall(random, 40);
    for (Vec3d& p : points) {
      p.y *= 0x1p-44;
    }
    hullOf(points);
    hullOf(shapes::turned(dicedCube(3), shapes::randomAxes(random)));
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace sightline
