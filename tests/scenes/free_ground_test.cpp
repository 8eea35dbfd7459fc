#include "scenes/free_ground.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/random.h"

namespace sightline::scenes {
namespace {

Footprint anyFootprint(Random& random) {
  const double x = random.range(-6, 6), y = random.range(-6, 6), turns = random.uniform();
  const double half_length = random.range(0.5, 4.0);
  return {{x, y}, unitVector(turns), half_length, random.range(0.5, 4.0)};
}

// True if a point of a fine grid over the first footprint is in the second one.
bool sharePoint(const Footprint& a, const Footprint& b, double grown) {
  for (int i = -40; i <= 40; ++i) {
    for (int k = -40; k <= 40; ++k) {
      if (b.distance(a.at(i / 40.0, k / 40.0)) <= grown) {
        return true;
      }
    }
  }
  return false;
}

TEST(FreeGround, FootprintsOverlapWhereTheyShareAPoint) {
  Random random(5);
  int overlapping = 0;
  for (int i = 0; i < 400; ++i) {
    const Footprint a = anyFootprint(random), b = anyFootprint(random);
    overlapping += overlaps(a, b) ? 1 : 0;
    if (sharePoint(a, b, 0.0)) {
      EXPECT_TRUE(overlaps(a, b)) << "seed 5, pair " << i;
    } else if (!sharePoint(a, b, 0.2)) {
      EXPECT_FALSE(overlaps(a, b)) << "seed 5, pair " << i;
    }
  }
  EXPECT_GT(overlapping, 50);
  EXPECT_LT(overlapping, 350);
}

TEST(FreeGround, WhatIsTakenIsNotFree) {
  FreeGround free;
  EXPECT_TRUE(free.tryCircle({0, 0}, 2.0));
  EXPECT_FALSE(free.tryCircle({2.5, 0}, 1.0));
  EXPECT_TRUE(free.isFree(Point2{3.1, 0}, 1.0));
  EXPECT_FALSE(free.isFree(Footprint{{4.0, 0.0}, {1.0, 0.0}, 2.5, 1.0}));
  EXPECT_TRUE(free.tryFootprint({{4.0, 0.0}, {1.0, 0.0}, 1.5, 1.0}));
  EXPECT_FALSE(free.isFree(Point2{4.0, 1.4}, 0.5));
  EXPECT_FALSE(free.isFree(Footprint{{5.0, 1.5}, unitVector(0.1), 1.0, 1.0}));
}

TEST(FreeGround, LinesKeepTheirWidth) {
  FreeGround free;
  const Vec3d line[] = {{0, 0, 5}, {10, 0, 0}, {10, 10, 0}};
  free.keepLine(line, 1.0);
  EXPECT_FALSE(free.isFree(Point2{5.0, 1.4}, 0.5));
  EXPECT_TRUE(free.isFree(Point2{5.0, 1.6}, 0.5));
  EXPECT_FALSE(free.isFree(Footprint{{5.0, 3.0}, {1.0, 0.0}, 1.0, 2.2}));
  EXPECT_TRUE(free.isFree(Footprint{{5.0, 3.3}, {1.0, 0.0}, 1.0, 2.2}));
  // A rectangle around the line's end, with all its corners far away.
  EXPECT_FALSE(free.isFree(Footprint{{10.0, 10.0}, {1.0, 0.0}, 6.0, 6.0}));
}

}  // namespace
}  // namespace sightline::scenes
