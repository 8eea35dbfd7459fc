#include "src/pvs/bake/cell_region.h"

#include <gtest/gtest.h>

#include <random>

namespace sightline::pvs {
namespace {

Vec3d randomPoint(std::mt19937& random, const Vec3d& low, const Vec3d& high) {
  Vec3d p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = std::uniform_real_distribution<double>(low[axis], high[axis])(random);
  }
  return p;
}

// A convex hull is bounded by the minimum of dot(direction, corner) over its corners, for all directions.
bool insideHull(const Vec3d& point, const std::vector<Vec3d>& corners, std::mt19937& random) {
  for (int i = 0; i < 200; ++i) {
    const Vec3d d = randomPoint(random, {-1, -1, -1}, {1, 1, 1});
    double most = -INFINITY;
    for (const Vec3d& corner : corners) {
      most = std::max(most, dot(d, corner));
    }
    if (dot(d, point) > most + 1e-12 * length(d)) {
      return false;
    }
  }
  return true;
}

TEST(CellRegion, HoldsAllThatLiesBeforeThePlane) {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Vec3d low = randomPoint(random, {-5, -5, -5}, {5, 5, 5});
    const CellBox cell{low, low + randomPoint(random, {0.1, 0.1, 0.1}, {3, 3, 3})};
    Vec3d normal = normalized(randomPoint(random, {-1, -1, -1}, {1, 1, 1}));
    if (seed % 3 == 0) {
      normal = {0, 1, 0};
    }
    const double least = dot(normal, randomPoint(random, cell.min, cell.max));
    const std::vector<Vec3d> corners = cornersBefore(cell, normal, least);
    for (const Vec3d& corner : corners) {
      EXPECT_GE(dot(normal, corner), least - sideMargin(cell));
    }
    for (int i = 0; i < 20; ++i) {
      const Vec3d p = randomPoint(random, cell.min, cell.max);
      if (dot(normal, p) >= least + sideMargin(cell)) {
        EXPECT_TRUE(insideHull(p, corners, random));
      }
    }
  }
}

TEST(CellRegion, IsAllOrNothingWhereThePlanePassesBy) {
  const CellBox cell{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(cornersBefore(cell, {0, 1, 0}, -1.0).size(), 8u);
  EXPECT_EQ(cornersBefore(cell, {0, 1, 0}, 0.0).size(), 8u);
  EXPECT_EQ(cornersBefore(cell, {0, 1, 0}, 2.0).size(), 4u);
  EXPECT_TRUE(cornersBefore(cell, {0, 1, 0}, 2.001).empty());
  EXPECT_EQ(cornersOf(cell).size(), 8u);
  EXPECT_EQ(cell.smallestFace(), 2.0);
}

// A rectangle in the plane y = height, from (x0, z0) to (x1, z1), with its front upwards.
struct Floor {
  std::vector<ConvexEdge> edges;
  Plane plane;

  Floor(double height, double x0, double z0, double x1, double z1, bool upwards = true) {
    std::vector<Vec3d> corners{{x0, height, z0}, {x0, height, z1}, {x1, height, z1}, {x1, height, z0}};
    if (!upwards) {
      std::swap(corners[1], corners[3]);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      edges.push_back({corners[i], corners[(i + 1) % 4]});
    }
    plane = upwards ? Plane{{0, 1, 0}, -height} : Plane{{0, -1, 0}, height};
  }
  DividingFace face(bool double_sided = false) const { return {plane, edges, 1e-6, double_sided}; }
};

const CellBox kCell{{0, 0, 0}, {4, 4, 4}};

TEST(DividingPlane, IsThatOfAFaceThatFillsTheCell) {
  const Floor floor(1.0, -1, -1, 5, 5);
  const std::vector<DividingFace> faces{floor.face()};
  const std::optional<CellPlane> plane = dividingPlane(kCell, faces, 0.25, 1e-9);
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->normal, Vec3d(0, 1, 0));
  EXPECT_NEAR(plane->front, 1.25, 1e-4);
  EXPECT_NEAR(plane->back, 0.75, 1e-4);
  EXPECT_GE(plane->front, 1.25);
  EXPECT_LE(plane->back, 0.75);
}

TEST(DividingPlane, TakesTilesOfOnePlaneTogether) {
  const Floor west(1.0, -1, -1, 1.9, 5), east(1.0, 1.9, -1, 5, 5), step(1.5, 1, 1, 2, 2);
  const std::vector<DividingFace> faces{step.face(), west.face(), east.face()};
  const std::optional<CellPlane> plane = dividingPlane(kCell, faces, 0.0, 1e-9);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->front, 1.0, 1e-4);
  EXPECT_FALSE(dividingPlane(kCell, std::span(faces).first(1), 0.0, 1e-9))
      << "a sixteenth of the cross-section";
}

TEST(DividingPlane, CountsAFloorThatTheCellStandsOn) {
  const Floor floor(-0.01, -1, -1, 5, 5);
  const std::vector<DividingFace> faces{floor.face()};
  const std::optional<CellPlane> plane = dividingPlane(kCell, faces, 0.25, 1e-9);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->front, 0.24, 1e-4);
  EXPECT_FALSE(dividingPlane(kCell, faces, 0.0, 1e-9));
}

TEST(DividingPlane, OfASlabHasBothFaces) {
  const Floor top(2.2, -1, -1, 5, 5), bottom(1.9, -1, -1, 5, 5, false);
  const std::vector<DividingFace> faces{bottom.face(), top.face()};
  const std::optional<CellPlane> plane = dividingPlane(kCell, faces, 0.1, 1e-9);
  ASSERT_TRUE(plane);
  EXPECT_EQ(std::abs(plane->normal.y), 1.0);
  const double sign = plane->normal.y;
  EXPECT_NEAR(sign * (sign > 0 ? plane->front : plane->back), 2.3, 1e-4);
  EXPECT_NEAR(sign * (sign > 0 ? plane->back : plane->front), 1.8, 1e-4);
}

TEST(DividingPlane, OfADoubleSidedFaceHasItTwice) {
  const Floor sheet(2.0, -1, -1, 5, 5), far_below(0.5, -1, -1, 5, 5, false);
  const std::vector<DividingFace> faces{sheet.face(true), far_below.face()};
  const std::optional<CellPlane> plane = dividingPlane(kCell, faces, 0.1, 1e-9);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->front, 2.1, 1e-4);
  EXPECT_NEAR(plane->back, 1.9, 1e-4);
}

}  // namespace
}  // namespace sightline::pvs
