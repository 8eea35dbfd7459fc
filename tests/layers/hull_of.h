#pragma once

// The hull of points that have one.

#include <gtest/gtest.h>

#include "sightline/layers/hull.h"
#include "tests/support/layer_shapes.h"

namespace sightline::shapes {

inline ConvexHull hullOf(const Points& points) {
  const Result<ConvexHull> hull = buildHull(points);
  EXPECT_TRUE(hull) << (hull ? "" : hull.error().message);
  return hull ? *hull : ConvexHull{};
}

}  // namespace sightline::shapes
