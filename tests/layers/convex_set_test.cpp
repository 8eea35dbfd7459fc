#include "src/layers/pairs/convex_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/layers/hull/support.h"
#include "tests/layers/hull_of.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/rounds.h"

namespace sightline::layers {
namespace {

using shapes::hullOf;
using shapes::Random;
using test::Exact;

// The height of a point of the set above the local origin, without rounding.
Exact exactHeight(const Placement& placement, const Vec3d& point, const Vec3d& direction,
                  const Vec3d& local_origin) {
  Exact height = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Exact at = Exact(placement.x[axis]) * Exact(point.x) + Exact(placement.y[axis]) * Exact(point.y) +
                     Exact(placement.z[axis]) * Exact(point.z) + Exact(placement.origin[axis]);
    height += Exact(direction[axis]) * (at - Exact(local_origin[axis]));
  }
  return height;
}

// The greatest height of the whole set.
Exact exactReach(const ConvexSet& set, const shapes::Points& points, const Vec3d& direction,
                 const Vec3d& local_origin) {
  Exact highest = exactHeight(set.placement, points[0], direction, local_origin);
  for (const Vec3d& p : points) {
    highest = std::max(highest, exactHeight(set.placement, p, direction, local_origin));
  }
  if (set.kind == ConvexSet::Kind::kWithEye) {
    Exact eye = 0;
    for (int axis = 0; axis < 3; ++axis) {
      eye += Exact(direction[axis]) * (Exact(set.eye_or_sweep[axis]) - Exact(local_origin[axis]));
    }
    highest = std::max(highest, eye);
  } else if (set.kind == ConvexSet::Kind::kSwept) {
    highest += std::max(Exact(0), test::exactDot(direction, set.eye_or_sweep));
  }
  return highest;
}

ConvexSet randomSet(Random& random, const ConvexHull& hull, double scale, double away) {
  ConvexSet set{&hull};
  const shapes::Axes axes = shapes::randomAxes(random);
  set.placement = {axes.x * scale, axes.y * scale * random.number(0.001, 1.0), axes.z * scale,
                   random.direction() * away};
  set.kind =
      std::array{ConvexSet::Kind::kHull, ConvexSet::Kind::kWithEye, ConvexSet::Kind::kSwept}[random.below(3)];
  set.eye_or_sweep = random.direction() * (random.number(0.0, 9.0) * scale);
  if (set.kind == ConvexSet::Kind::kWithEye) {
    set.eye_or_sweep += set.placement.origin;
  }
  return set;
}

TEST(ConvexSet, NoPointIsHigherThanItReachesAndTheBoundIsTight) {
  for (std::uint64_t seed = 0; seed < test::rounds(200u); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const shapes::Points points =
        seed % 20 == 0 ? shapes::turned(shapes::toothpick(), shapes::randomAxes(random))
                       : shapes::randomBall(random, 1 + random.below(20), random.direction() * 3.0);
    const ConvexHull hull = hullOf(points);
    const double scale = std::array{1.0, 1e-6, 1e6}[random.below(3)];
    const ConvexSet set = randomSet(random, hull, scale, scale * (seed % 3 == 0 ? 1e6 : 2.0));
    const Vec3d local_origin = set.placement.origin + random.direction() * scale;
    const LocalSet local = localSet(set, local_origin);
    // The sum of the axes' components is at most 3 sqrt(3) times the scale.
    const double allowed = 2.0 * supportError(hull, 5.2 * scale);
    for (int i = 0; i < 4; ++i) {
      const Vec3d direction = random.direction();
      const Reach found = reach(local, direction, static_cast<std::uint32_t>(random.bits()));
      const Exact exact = exactReach(set, points, direction, local_origin);
      EXPECT_GE(Exact(found.upper), exact);
      EXPECT_LE(Exact(found.upper), exact + Exact(1e-14 * local.size + allowed));
    }
  }
}

TEST(ConvexSet, AnyNumberLeadsToAPointOfTheSet) {
  Random random(7);
  const ConvexHull hull = hullOf(shapes::cube());
  for (int i = 0; i < 1000; ++i) {
    const ConvexSet set = randomSet(random, hull, 1.0, 2.0);
    const LocalSet local = localSet(set, set.placement.origin);
    const std::uint32_t number = i % 5 == 0 ? PairWitness::kEye : static_cast<std::uint32_t>(random.bits());
    const Vec3d point = pointOf(local, knownVertex(local, number));
    const Vec3d direction = random.direction();
    EXPECT_LE(dot(point, direction), reach(local, direction, 0).upper);
  }
}

TEST(ConvexSet, WhatIsNotFiniteHasNoFiniteBounds) {
  const ConvexHull hull = hullOf(shapes::cube());
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (int entry = 0; entry < 15; ++entry) {
      ConvexSet set{&hull};
      set.kind = entry % 2 == 0 ? ConvexSet::Kind::kWithEye : ConvexSet::Kind::kSwept;
      std::array<Vec3d*, 5> vectors{&set.placement.x, &set.placement.y, &set.placement.z,
                                    &set.placement.origin, &set.eye_or_sweep};
      (*vectors[static_cast<std::size_t>(entry) / 3])[entry % 3] = bad;
      const LocalSet local = localSet(set, Vec3d());
      EXPECT_FALSE(std::isfinite(local.size + local.hull_error + local.far_error)) << entry;
    }
  }
}

}  // namespace
}  // namespace sightline::layers
