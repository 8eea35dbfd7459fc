#include "src/layers/pairs/envelope_pair.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/rounds.h"

namespace sightline::layers {
namespace {

using shapes::Points;
using shapes::Random;
using Kind = ConvexSet::Kind;

// A hull with its envelope, in the world's space.
struct Whole {
  Points points;
  ConvexHull hull;
  HullEnvelope around;
  ConvexSet set;

  explicit Whole(const Points& given, Kind kind = Kind::kHull, const Vec3d& eye_or_sweep = {})
      : points(given), hull(*buildHull(given)), around(hull, boxOf(hull)) {
    set = {&hull, {}, kind, eye_or_sweep, &around};
    const std::size_t count = points.size();
    if (kind == Kind::kWithEye) {
      points.push_back(eye_or_sweep);
    } else if (kind == Kind::kSwept) {
      for (std::size_t i = 0; i < count; ++i) {
        points.push_back(points[i] + eye_or_sweep);
      }
    }
  }
  Whole(const Whole&) = delete;
  Whole& operator=(const Whole&) = delete;
};

// Whether all of a lies below all of b along a direction, in extended precision.
bool liesBelow(const Points& a, const Points& b, const Vec3d& direction) {
  const auto height = [&](const Vec3d& p) {
    return static_cast<long double>(p.x) * direction.x + static_cast<long double>(p.y) * direction.y +
           static_cast<long double>(p.z) * direction.z;
  };
  for (const Vec3d& p : a) {
    for (const Vec3d& q : b) {
      if (!(height(p) < height(q))) {
        return false;
      }
    }
  }
  return true;
}

bool search(const Whole& first, const Whole& second, Vec3d& direction, std::uint64_t& tries) {
  direction = directionBetween(first.set, second.set);
  return separates(first.set, second.set, direction) ||
         separateEnvelopes(first.set, second.set, direction, tries);
}

Points randomBoxAt(Random& random, const Vec3d& middle) {
  const shapes::Axes axes = shapes::randomAxes(random);
  const Vec3d half{random.number(0.1, 3.0), random.number(0.1, 3.0), random.number(0.1, 3.0)};
  return shapes::moved(shapes::turned(shapes::box(-half, half), axes), middle);
}

// The envelope of a box is hardly larger than the box, so of those that are apart few are missed.
TEST(EnvelopePair, BoxesThatAreApartAreFoundApartInAFewTries) {
  const std::uint64_t pairs = test::rounds(1500u);
  std::size_t apart = 0, found = 0;
  std::uint64_t tries = 0;
  for (std::uint64_t seed = 1; seed <= pairs; ++seed) {
    Random random(seed);
    const Kind kind = std::array{Kind::kHull, Kind::kWithEye, Kind::kSwept}[seed % 3];
    const Whole first(randomBoxAt(random, {}));
    const Whole second(randomBoxAt(random, random.direction() * random.number(2.0, 7.0)), kind,
                       random.direction() * random.number(1.0, 12.0));
    const bool intersect = test::convexHullsIntersect(first.points, second.points);
    Vec3d direction;
    const bool is_found = search(first, second, direction, tries);
    if (is_found) {
      EXPECT_FALSE(intersect) << "seed " << seed;
      EXPECT_TRUE(liesBelow(first.points, second.points, direction)) << "seed " << seed;
      EXPECT_TRUE(isUnit(direction)) << "seed " << seed;
    }
    apart += intersect ? 0 : 1;
    found += is_found ? 1 : 0;
  }
  EXPECT_GT(apart, pairs / 5);
  EXPECT_LT(apart, pairs * 4 / 5);
  EXPECT_GT(found, apart * 95 / 100);
  EXPECT_LE(tries, pairs * 8);
}

TEST(EnvelopePair, NothingThatTouchesIsFoundApart) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const Points ball = shapes::randomBall(random, 20), grid = shapes::randomGrid(random, 12, 3);
    const Whole first(seed % 2 == 0 ? ball : grid);
    // One of its points lies on the first hull, or the eye does.
    const Points other = shapes::randomBall(random, 15, random.direction() * 2.0);
    const Vec3d touched =
        first.hull.vertices[random.below(static_cast<std::uint32_t>(first.hull.vertices.size()))];
    const bool by_eye = seed % 3 == 0;
    const Whole second(by_eye ? other : shapes::moved(other, touched - other[0]),
                       by_eye ? Kind::kWithEye : Kind::kHull, touched);
    Vec3d direction;
    std::uint64_t tries = 0;
    if (test::convexHullsIntersect(first.points, second.points)) {
      EXPECT_FALSE(search(first, second, direction, tries)) << "seed " << seed;
    }
  }
}

// A direction that hardly separates would be lost with the next motion.
TEST(EnvelopePair, TheGapFoundIsAFairShareOfTheWidest) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const double gap = random.number(0.1, 1.0);
    const Vec3d half{1.0, 2.0, 0.5}, across = {0.0, random.number(-1.0, 1.0), random.number(-0.4, 0.4)};
    const shapes::Axes axes = shapes::randomAxes(random);
    const Whole first(shapes::turned(shapes::box(-half, half), axes));
    const Whole second(
        shapes::turned(shapes::moved(shapes::box(-half, half), Vec3d{2.0 + gap, 0.0, 0.0} + across), axes));
    Vec3d direction = random.direction();
    std::uint64_t tries = 0;
    if (separates(first.set, second.set, direction)) {
      continue;
    }
    ASSERT_TRUE(separateEnvelopes(first.set, second.set, direction, tries)) << "seed " << seed;
    double low = 1e300, high = -1e300;
    for (const Vec3d& p : first.points) {
      high = std::max(high, dot(p, direction));
    }
    for (const Vec3d& p : second.points) {
      low = std::min(low, dot(p, direction));
    }
    EXPECT_GT(low - high, 0.2 * gap) << "seed " << seed;
  }
}

TEST(EnvelopePair, PointsAndWhatIsNotFiniteAreNotFoundApart) {
  const Whole cube(shapes::cube()), far(shapes::cube({9, 0, 0})), point(shapes::point({9, 0, 0}));
  ConvexSet lost = far.set;
  lost.placement.origin.x = std::nan("");
  for (const ConvexSet& set : {point.set, lost}) {
    Vec3d direction = directionBetween(cube.set, set);
    std::uint64_t tries = 0;
    EXPECT_TRUE(isUnit(direction));
    EXPECT_FALSE(separates(cube.set, set, direction));
    EXPECT_FALSE(separateEnvelopes(cube.set, set, direction, tries));
  }
}

}  // namespace
}  // namespace sightline::layers
