#include "src/layers/hull/hull_envelope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/layers/pairs/convex_pair.h"
#include "tests/layers/hull_of.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using shapes::hullOf;
using shapes::Random;

HullEnvelope envelopeOf(const ConvexHull& hull) {
  return {hull, boxOf(hull)};
}

// A random hull: solid, flat, a segment or a point; long or round; anywhere.
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

TEST(HullEnvelope, IsNowhereLowerThanTheHull) {
  std::size_t tight = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Random random(seed);
    const std::vector<Vec3d> points = randomPoints(random, seed);
    const ConvexHull hull = hullOf(points);
    const HullEnvelope around = envelopeOf(hull);
    for (int i = 0; i < 40; ++i) {
      const Vec3d direction = i == 0 ? Vec3d{0, 1, 0} : random.direction();
      double highest = dot(direction, points[0]), lowest = highest;
      for (const Vec3d& point : points) {
        highest = std::max(highest, dot(direction, point));
        lowest = std::min(lowest, dot(direction, point));
      }
      const double height = around.height(direction);
      EXPECT_GE(height, highest - 0x1p-45 * around.reach()) << "seed " << seed;
      EXPECT_NEAR(dot(around.farthest(direction), direction), height, 1e-12 * around.reach())
          << "seed " << seed;
      tight += height - highest < 0.5 * (highest - lowest) ? 1 : 0;
    }
  }
  EXPECT_GT(tight, 400u * 40u / 2u);
}

std::vector<Vec3d> boxAround(const Vec3d& middle, double half) {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(middle + Vec3d(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half));
  }
  return corners;
}

// Tests two sets with a witness that they were disjoint along the x axis.
Intersection askAgain(ConvexSet first, ConvexSet second) {
  const HullEnvelope around_first = envelopeOf(*first.hull), around_second = envelopeOf(*second.hull);
  first.around = &around_first;
  second.around = &around_second;
  PairWitness witness;
  witness.disjoint = true;
  witness.pairs = 2;
  witness.direction = {1.0, 0.0, 0.0};
  PairCounts counts;
  return testIntersection(first, second, witness, counts);
}

TEST(HullEnvelope, SaysNothingOfAPoint) {
  const ConvexHull point = hullOf({{5, 0, 0}}), box = hullOf(boxAround({5, 0, 0}, 1.0));
  EXPECT_TRUE(std::isnan(envelopeOf(point).height({1, 0, 0})));
  for (const auto kind : {ConvexSet::Kind::kHull, ConvexSet::Kind::kWithEye, ConvexSet::Kind::kSwept}) {
    ConvexSet in_the_box{&point, {}, kind};
    in_the_box.eye_or_sweep = {-3.0, 0.0, 0.0};
    EXPECT_NE(askAgain(in_the_box, {&box}), Intersection::kDisjoint) << static_cast<int>(kind);
  }
}

TEST(HullEnvelope, LetsNothingBeDisjointThatIsTooLargeOrTooSmallForNumbers) {
  const ConvexHull box = hullOf(boxAround({}, 1.0)), aside = hullOf(boxAround({10, -10, 0}, 1.0));
  ConvexSet huge{&aside};
  huge.placement.x = huge.placement.y = {1e308, 0.0, 0.0};
  huge.kind = ConvexSet::Kind::kWithEye;
  huge.eye_or_sweep = {-5.0, 0.0, 0.0};
  EXPECT_EQ(askAgain(huge, {&box}), Intersection::kUndecided);

  ConvexSet tiny{&box}, neighbour{&box};
  tiny.placement.x = neighbour.placement.x = {1e-170, 0.0, 0.0};
  tiny.placement.y = neighbour.placement.y = {0.0, 1e-170, 0.0};
  tiny.placement.z = neighbour.placement.z = {0.0, 0.0, 1e-170};
  neighbour.placement.origin = {1.5e-170, 0.0, 0.0};
  EXPECT_NE(askAgain(tiny, neighbour), Intersection::kDisjoint);
}

// The shortcut for pairs that were disjoint agrees with the whole test.
TEST(HullEnvelope, LetsNoPairBeDisjointThatIsNot) {
  std::size_t disjoint = 0, intersecting = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const ConvexHull first = hullOf(randomPoints(random, 4 * seed + 2)),
                     second = hullOf(randomPoints(random, 4 * seed + 3));
    const HullEnvelope around_first = envelopeOf(first), around_second = envelopeOf(second);
    const double reach = first.radius + second.radius;
    PairWitness witness;
    PairCounts counts;
    for (int i = 0; i < 30; ++i) {
      // Moves one hull from far away to where the two intersect, and on.
      ConvexSet a{&first}, b{&second};
      a.placement.origin = -first.centre;
      b.placement.origin = Vec3d(reach * (1.5 - 0.1 * i), 0.02 * reach, 0.0) - second.centre;
      b.kind = seed % 2 == 0 ? ConvexSet::Kind::kHull : ConvexSet::Kind::kWithEye;
      b.eye_or_sweep = {0.0, reach * 3.0, 0.0};
      PairWitness cold;
      const Intersection exact = testIntersection(a, b, cold, counts);
      a.around = &around_first;
      b.around = &around_second;
      const Intersection quick = testIntersection(a, b, witness, counts);
      EXPECT_EQ(quick == Intersection::kDisjoint, exact == Intersection::kDisjoint)
          << "seed " << seed << ", step " << i;
      ++(exact == Intersection::kDisjoint ? disjoint : intersecting);
    }
  }
  EXPECT_GT(disjoint, 1000u);
  EXPECT_GT(intersecting, 1000u);
}

}  // namespace
}  // namespace sightline::layers
