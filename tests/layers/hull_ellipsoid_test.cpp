#include "layers/hull_ellipsoid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "layers/convex_pair.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using shapes::Random;

ConvexHull hullOf(const std::vector<Vec3d>& points) {
  Result<ConvexHull> hull = buildHull(points);
  EXPECT_TRUE(hull);
  return std::move(*hull);
}

// Solid, flat, straight or a point; long or round; anywhere.
std::vector<Vec3d> randomPoints(Random& random, std::uint64_t kind) {
  const double thin = kind % 4 == 0 ? 0.0 : kind % 4 == 1 ? 1e-3 : 1.0, thinner = kind % 8 < 4 ? thin : 0.0;
  const double size = std::pow(10.0, static_cast<double>(random.below(13)) - 6.0);
  const Vec3d middle = kind % 3 == 0 ? Vec3d() : random.point({-9, -9, -9}, {9, 9, 9}) * size;
  const Vec3d x = random.direction(), y = random.direction(), z = random.direction();
  std::vector<Vec3d> points;
  for (std::uint32_t i = 0; i < 4 + random.below(60); ++i) {
    const Vec3d p = random.point({-1, -1, -1}, {1, 1, 1}) * size;
    points.push_back(middle + x * p.x + y * (p.y * thin) + z * (p.z * thinner));
  }
  return points;
}

TEST(HullEllipsoid, IsNowhereLowerThanTheHull) {
  std::size_t tight = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Random random(seed);
    const std::vector<Vec3d> points = randomPoints(random, seed);
    const ConvexHull hull = hullOf(points);
    const HullEllipsoid around = ellipsoidAround(hull);
    for (int i = 0; i < 40; ++i) {
      const Vec3d direction = i == 0 ? Vec3d{0, 1, 0} : random.direction();
      double highest = dot(direction, points[0]), lowest = highest;
      for (const Vec3d& point : points) {
        highest = std::max(highest, dot(direction, point));
        lowest = std::min(lowest, dot(direction, point));
      }
      const double height = around.height(direction);
      EXPECT_GE(height, highest - 0x1p-45 * around.reach) << "seed " << seed;
      tight += height - highest < 0.5 * (highest - lowest) ? 1 : 0;
    }
  }
  EXPECT_GT(tight, 400u * 40u / 2u);
}

TEST(HullEllipsoid, OfAPointIsNotFinite) {
  const ConvexHull point = hullOf({{1, 2, 3}});
  EXPECT_FALSE(std::isfinite(ellipsoidAround(point).a.x));
}

// The shortcut for pairs that were apart never says what the whole test does not.
TEST(HullEllipsoid, LetsNoPairBeApartThatIsNot) {
  std::size_t apart = 0, meets = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const ConvexHull first = hullOf(randomPoints(random, 4 * seed + 2)),
                     second = hullOf(randomPoints(random, 4 * seed + 3));
    const HullEllipsoid around_first = ellipsoidAround(first), around_second = ellipsoidAround(second);
    const double reach = first.radius + second.radius;
    PairWitness witness;
    PairCounts counts;
    for (int i = 0; i < 30; ++i) {
      // From far away to where they meet, and on.
      ConvexSet a{&first}, b{&second};
      a.placement.origin = -first.centre;
      b.placement.origin = Vec3d(reach * (1.5 - 0.1 * i), 0.02 * reach, 0.0) - second.centre;
      b.kind = seed % 2 == 0 ? ConvexSet::Kind::kHull : ConvexSet::Kind::kWithEye;
      b.eye_or_sweep = {0.0, reach * 3.0, 0.0};
      PairWitness cold;
      const Meeting exact = meeting(a, b, cold, counts);
      a.around = &around_first;
      b.around = &around_second;
      const Meeting quick = meeting(a, b, witness, counts);
      EXPECT_EQ(quick == Meeting::kApart, exact == Meeting::kApart) << "seed " << seed << ", step " << i;
      ++(exact == Meeting::kApart ? apart : meets);
    }
  }
  EXPECT_GT(apart, 1000u);
  EXPECT_GT(meets, 1000u);
}

}  // namespace
}  // namespace sightline::layers
