// Cracks that are closed, and those that are not.

#include "src/occluders/conform/close_cracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/occluders/triangle_soup.h"
#include "tests/support/cut_work.h"

namespace sightline::occluders {
namespace {

using test::boundaryEdges;
using test::greedyVoxels;
using test::Soup;
using test::SoupRandom;

// Every triangle with corners of its own, moved by less than `by` along each axis.
Soup shaken(const Soup& soup, double by, unsigned seed) {
  SoupRandom random(seed);
  Soup result;
  for (std::size_t i = 0; i < soup.triangles.size(); i += 3) {
    Vec3d corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = soup.vertices[soup.triangles[i + k]] +
                   Vec3d{random.in(-by, by), random.in(-by, by), random.in(-by, by)};
    }
    result.add(corners[0], corners[1], corners[2]);
  }
  return result;
}

// The least distance between a point and a triangle, by the closest of many points of it.
double distanceTo(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  constexpr int kSteps = 64;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; i + k <= kSteps; ++k) {
      const Vec3d q = a + (b - a) * (double(i) / kSteps) + (c - a) * (double(k) / kSteps);
      least = std::min(least, length(q - p));
    }
  }
  return least;
}

TEST(CloseCracks, AWidthOfNothingChangesNothing) {
  const Soup soup = shaken(greedyVoxels(1, 3), 0.001, 1);
  for (const double width :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const ClosedCracks closed = closeCracks(soup.input(), width);
    EXPECT_EQ(closed.triangles, soup.triangles);
    EXPECT_EQ(closed.slack, 0.0);
    EXPECT_EQ(closed.merged + closed.bent, 0u);
  }
}

TEST(CloseCracks, AWidthThatNoTwoNumbersDifferByChangesNothing) {
  // A vertex lies exactly on an edge. The cells of a grid so fine could not be told apart.
  Soup soup;
  soup.add({200, 200, 200}, {204, 200, 200}, {200, 204, 200});
  soup.add({202, 202, 200}, {204, 200, 200}, {204, 204, 201});
  for (const double width : {1e-310, std::numeric_limits<double>::denorm_min(), 0x1p-150}) {
    const ClosedCracks closed = closeCracks(soup.input(), width);
    EXPECT_EQ(closed.triangles, soup.triangles) << width;
    EXPECT_EQ(closed.merged + closed.bent, 0u) << width;
  }
  EXPECT_EQ(closeCracks(soup.input(), 0x1p-149).bent, 1u);
}

TEST(CloseCracks, AVertexBesideAnEdgeBendsIt) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  soup.add({2, 2, 0.001}, {4, 0, 0}, {4, 4, 1});
  soup.add({0, 4, 0}, {2, 2, 0.001}, {0, 4, 7});
  const ClosedCracks left_open = closeCracks(soup.input(), 0.0009);
  EXPECT_EQ(left_open.triangles, soup.triangles);
  const ClosedCracks closed = closeCracks(soup.input(), 0.0011);
  EXPECT_EQ(closed.source, (std::vector<std::uint32_t>{0, 0, 1, 2}));
  EXPECT_EQ(boundaryEdges(closed.triangles), 6u);
  EXPECT_EQ(closed.bent, 1u);
  EXPECT_GE(closed.slack, 0.001);
  EXPECT_LT(closed.slack, 0.001001);
}

TEST(CloseCracks, VerticesBesideLongObliqueEdgesBendThem) {
  // Triangles on both sides of an edge through space, those on one side with corners beside it.
  constexpr int kPieces = 40;
  constexpr double kBeside = 0.0625;
  const Vec3d from{-300, 20, 500}, to{340, -60, 1100}, side{0, 900, 120};
  for (const double width : {kBeside * 1.001, kBeside * 0.999}) {
    Soup soup;
    soup.add(from, to, (from + to) * 0.5 + side);
    Vec3d last = from;
    const Vec3d along = (to - from) / length(to - from);
    const Vec3d across = cross(along, side) / length(cross(along, side));
    for (int i = 1; i <= kPieces; ++i) {
      Vec3d next = from + (to - from) * (double(i) / kPieces);
      next = i < kPieces ? next + across * (i % 2 == 0 ? kBeside : -kBeside) : to;
      soup.add(next, last, (from + to) * 0.5 - side);
      last = next;
    }
    const ClosedCracks closed = closeCracks(soup.input(), width);
    EXPECT_EQ(closed.bent, width > kBeside ? kPieces - 1u : 0u) << width;
  }
}

TEST(CloseCracks, VerticesThatNearlyMeetBecomeOne) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  soup.add({4, 0.0005, 0}, {4, 4, 0}, {0, 4, 0.0005});
  EXPECT_EQ(boundaryEdges(closeCracks(soup.input(), 0.0003).triangles), 6u);
  const ClosedCracks closed = closeCracks(soup.input(), 0.0006);
  EXPECT_EQ(closed.merged, 2u);
  EXPECT_EQ(boundaryEdges(closed.triangles), 4u);
  EXPECT_GE(closed.slack, 0.0005);
  EXPECT_LT(closed.slack, 0.0006);
}

TEST(CloseCracks, ShakenVoxelsBecomeWatertight) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Soup soup = shaken(greedyVoxels(seed, 6), 0.0002, seed);
    EXPECT_EQ(boundaryEdges(soup.triangles), soup.triangles.size());
    const ClosedCracks closed = closeCracks(soup.input(), 0.001);
    EXPECT_EQ(boundaryEdges(closed.triangles), 0u);
    EXPECT_LT(closed.slack, 0.002);
  }
}

TEST(CloseCracks, NothingMovesFartherThanItSays) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    // Triangles of all sizes beside a width that bends most of them.
    SoupRandom random(seed);
    Soup soup;
    for (int i = 0; i < 40; ++i) {
      Vec3d corners[3];
      for (Vec3d& corner : corners) {
        corner = {random.in(0, 3), random.in(0, 3), random.in(0, 0.2)};
      }
      soup.add(corners[0], corners[1], corners[2]);
    }
    const ClosedCracks closed = closeCracks(soup.input(), 0.15);
    EXPECT_GT(closed.merged, 0u);
    EXPECT_GT(closed.bent, 20u);
    EXPECT_GT(closed.slack, 0.1);
    EXPECT_LE(closed.slack, 0.3001);
    const auto corner = [&](std::span<const std::uint32_t> triangles, std::size_t t, std::size_t k) {
      return soup.vertices[triangles[3 * t + k]];
    };
    constexpr double kOfSamples = 4.0 / 64;  // metres between points that stand for a triangle, or less
    for (std::size_t i = 0; i < closed.source.size(); ++i) {
      const std::size_t t = closed.source[i];
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LE(distanceTo(corner(closed.triangles, i, k), corner(soup.triangles, t, 0),
                             corner(soup.triangles, t, 1), corner(soup.triangles, t, 2)),
                  closed.slack + kOfSamples);
      }
    }
  }
}

TEST(CloseCracks, ClosedSolidsAreLeftAlone) {
  Soup soup;
  soup.addBox({0, 0, 0}, {4, 4, 0.0001});
  soup.addBox({4.0001, 0, 0}, {8, 4, 0.0001});
  const ClosedCracks closed = closeCracks(soup.input(), 0.01);
  EXPECT_EQ(closed.triangles, soup.triangles);
  EXPECT_EQ(closed.slack, 0.0);
}

// What is connected stays so: the boundary of the pieces of a closed surface is none, whatever collapses.
TEST(CloseCracks, CollapsedTrianglesLeaveNoGap) {
  Soup soup;
  // A strip of narrow triangles between two large ones, each with vertices of its own to one side.
  soup.add({0, 0, 0}, {8, 0, 0}, {4, -4, 0});
  for (int i = 0; i < 8; ++i) {
    const double x = i;
    soup.addQuad({x, 0.00005, 0}, {x + 1, 0.00005, 0}, {x + 1, 0.0001, 0}, {x, 0.0001, 0});
  }
  soup.add({8, 0.00015, 0}, {0, 0.00015, 0}, {4, 4, 0});
  const ClosedCracks closed = closeCracks(soup.input(), 0.001);
  EXPECT_EQ(boundaryEdges(closed.triangles), 4u);
}

TEST(CloseCracks, ThreadsChangeNothingAndOddCoordinatesStay) {
  Soup soup = shaken(greedyVoxels(3, 9), 0.0002, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  soup.add({nan, 0, 0}, {1, 0, 0}, {0, 1, 0});
  soup.add({0x1p70, 0, 0}, {1.00001, 0, 0}, {0, 1, 0});
  const ClosedCracks one = closeCracks(soup.input(), 0.001),
                     two = closeCracks(soup.input(), 0.001, onThreads(2));
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_EQ(one.source, two.source);
  EXPECT_EQ(one.slack, two.slack);
  EXPECT_EQ(one.source.back(), soup.count() - 1);
  EXPECT_EQ(one.source[one.source.size() - 2], soup.count() - 2);
}

}  // namespace
}  // namespace sightline::occluders
