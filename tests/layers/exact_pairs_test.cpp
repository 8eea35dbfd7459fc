#include "tests/support/exact_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/layer_shapes.h"

namespace sightline {
namespace {

using shapes::Points;
using shapes::Random;

// Whether closed hulls of a few points intersect, by testing all candidates for separating planes: through
// three of the points, or through two and parallel to a side. Whole coordinates up to some thousands are
// exact.
bool apartByAPlane(const Points& a, const Points& b, const Vec3d& normal) {
  double high_a = dot(normal, a[0]);
  double low_a = high_a;
  double high_b = dot(normal, b[0]);
  double low_b = high_b;
  for (const Vec3d& p : a) {
    high_a = std::max(high_a, dot(normal, p));
    low_a = std::min(low_a, dot(normal, p));
  }
  for (const Vec3d& p : b) {
    high_b = std::max(high_b, dot(normal, p));
    low_b = std::min(low_b, dot(normal, p));
  }
  return high_a < low_b || high_b < low_a;
}

// Two polytopes are disjoint if and only if one of these normals separates them: the normals of planes
// through three points of the difference set's generators. The test tries all cross products of edges of one
// set and of both sets, and the differences themselves (for points and segments).
bool meetByAllPlanes(const Points& a, const Points& b) {
  std::vector<Vec3d> edges;
  for (const Points* set : {&a, &b}) {
    for (const Vec3d& p : *set) {
      for (const Vec3d& q : *set) {
        if (!(p == q)) {
          edges.push_back(p - q);
        }
      }
    }
  }
  const std::size_t own = edges.size();
  for (const Vec3d& p : a) {
    for (const Vec3d& q : b) {
      edges.push_back(p - q);
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (apartByAPlane(a, b, edges[i])) {
      return false;
    }
    for (std::size_t j = 0; j < own; ++j) {
      const Vec3d normal = cross(edges[i], edges[j]);
      if (apartByAPlane(a, b, normal) || apartByAPlane(a, b, cross(normal, edges[j]))) {
        return false;
      }
    }
  }
  return true;
}

TEST(ExactPairs, AgreesWithTryingAllPlanesOnWholePoints) {
  int intersecting = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points a = shapes::randomGrid(random, 1 + random.below(5), 3);
    const Vec3d offset{static_cast<double>(random.whole(0, 5)), 0, 0};
    const Points b = shapes::moved(shapes::randomGrid(random, 1 + random.below(5), 3), offset);
    const bool expected = meetByAllPlanes(a, b);
    intersecting += expected ? 1 : 0;
    ASSERT_EQ(test::convexHullsIntersect(a, b), expected);
    ASSERT_EQ(test::convexHullsIntersect(b, a), expected);
  }
  EXPECT_GT(intersecting, 60);
  EXPECT_LT(intersecting, 540);
}

TEST(ExactPairs, TellsTouchingFromTheLeastGap) {
  const Points a = shapes::cube();
  EXPECT_TRUE(test::convexHullsIntersect(a, shapes::box({1, 0, 0}, {2, 1, 1})));
  EXPECT_FALSE(test::convexHullsIntersect(a, shapes::box({std::nextafter(1.0, 2.0), 0, 0}, {2, 1, 1})));
  EXPECT_TRUE(test::inConvexHull({1, 1, 1}, a));
  EXPECT_FALSE(test::inConvexHull({1, 1, std::nextafter(1.0, 2.0)}, a));
  EXPECT_FALSE(test::inConvexHull({0, 0x1p-1000, 1.5}, a));
  // The middle of a segment whose ends differ much in magnitude.
  EXPECT_TRUE(test::inConvexHull({0.5, 1e-30 / 2, 1e30 / 2}, Points{{0, 0, 0}, {1, 1e-30, 1e30}}));
}

TEST(ExactPairs, OcclusionNeedsTheRayToMeetTheFrontFirst) {
  const Points near_box = shapes::cube({0, 0, 5}, 1.0);
  const Points far_box = shapes::cube({0, 0, 9}, 1.0);
  EXPECT_TRUE(test::occludesExactly(near_box, far_box, {0, 0, 0}));
  EXPECT_FALSE(test::occludesExactly(far_box, near_box, {0, 0, 0}));
  EXPECT_FALSE(test::occludesExactly(near_box, far_box, {0, 0, 20}));
  EXPECT_TRUE(test::occludesExactlyTowards(near_box, far_box, {0, 0, -1}));
  EXPECT_FALSE(test::occludesExactlyTowards(far_box, near_box, {0, 0, -1}));
  EXPECT_TRUE(test::occludesExactlyTowards(far_box, near_box, {0, 0, 1}));
  // A grazing ray: the eye, the near box's edge and the far box's edge are in line.
  EXPECT_TRUE(test::occludesExactly(near_box, shapes::box({2, 0, 8}, {3, 1, 12}), {0, 0, 0}));
  EXPECT_FALSE(test::occludesExactly(near_box, shapes::box({2 + 0x1p-40, 0, 8}, {3, 1, 8}), {0, 0, 0}));
  // A front part that contains the eye occludes everything.
  EXPECT_TRUE(test::occludesExactly(near_box, far_box, {0, 0, 5}));
  EXPECT_TRUE(test::occludesExactly(near_box, shapes::cube({0, 40, 5}), {0, 0, 5}));
}

TEST(ExactPairs, AFarEyeSeesAsADirectionDoes) {
  int occluding = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points front = shapes::randomGrid(random, 4, 4);
    const Points back = shapes::moved(shapes::randomGrid(random, 4, 4), {0, 0, 6});
    const Vec3d towards{random.whole(-3, 3) + 0.5, random.whole(-3, 3) + 0.5, -7};
    // Rays from an eye farther than 2^40 differ from parallel rays by less than whole points of this size
    // resolve.
    const bool expected = test::occludesExactlyTowards(front, back, towards);
    occluding += expected ? 1 : 0;
    ASSERT_EQ(test::occludesExactly(front, back, towards * 0x1p+40), expected);
  }
  EXPECT_GT(occluding, 20);
  EXPECT_LT(occluding, 180);
}

}  // namespace
}  // namespace sightline
