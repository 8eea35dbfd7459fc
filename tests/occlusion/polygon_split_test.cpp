#include "src/occlusion/tree/polygon_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/random_numbers.h"

namespace sightline::occlusion {
namespace {

using test::Random;

Piece push(PolygonStack& stack, std::span<const Vec3d> corners) {
  const Piece piece{static_cast<std::uint32_t>(stack.corners.size()),
                    static_cast<std::uint32_t>(corners.size())};
  for (const Vec3d& corner : corners) {
    stack.corners.push_back({corner, PlaneRef{}, false});
  }
  return piece;
}

// Returns a regular polygon in a random plane.
std::vector<Vec3d> ring(Random& random, std::uint32_t n, double radius, double distance) {
  const Vec3d middle = random.point(distance), normal = normalized(random.point(1.0));
  const Vec3d u = normalized(cross(normal, random.point(1.0))), v = cross(normal, u);
  std::vector<Vec3d> corners;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * i / n;
    corners.push_back(middle + u * (radius * std::cos(angle)) + v * (radius * std::sin(angle)));
  }
  return corners;
}

Vec3d doubleArea(std::span<const Corner> corners) {
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(corners[i].position - corners[0].position, corners[i + 1].position - corners[0].position);
  }
  return sum;
}

std::vector<Corner> copyOf(const PolygonStack& stack, Piece piece) {
  const std::span<const Corner> corners = stack.of(piece);
  return {corners.begin(), corners.end()};
}

// A unit square in z = 0 around the origin, counter-clockwise seen from +z.
const std::vector<Vec3d> kSplitSquare{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};

TEST(PolygonSplit, SaysOnWhichSideAPolygonLies) {
  PolygonStack stack;
  const Piece square = push(stack, kSplitSquare);
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, 2.0}, {}, 0.0).side, Side::kFront);
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -2.0}, {}, 0.0).side, Side::kBack);
  EXPECT_EQ(stack.split(square, {{0, 0, 1}, 0.0}, {}, 0.0).side, Side::kOnPlane);
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, 1.0}, {}, 0.0).side, Side::kFront) << "an edge on the plane";
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -1.0}, {}, 0.0).side, Side::kBack) << "an edge on the plane";
  const Vec3d diagonal = normalized(Vec3d(1, 1, 0));
  EXPECT_EQ(stack.split(square, {diagonal, -std::sqrt(2.0)}, {}, 0.0).side, Side::kBack) << "a corner on it";
  EXPECT_EQ(stack.corners.size(), 4u) << "nothing is added without a split";
}

TEST(PolygonSplit, CutsThroughEdgesAndThroughCorners) {
  PolygonStack stack;
  const Piece square = push(stack, kSplitSquare);
  const SplitResult middle = stack.split(square, {{1, 0, 0}, -0.5}, {}, 0.0);
  ASSERT_EQ(middle.side, Side::kBoth);
  EXPECT_NEAR(length(doubleArea(stack.of(middle.front))), 2.0, 1e-12);
  EXPECT_NEAR(length(doubleArea(stack.of(middle.back))), 6.0, 1e-12);
  const SplitResult diagonal = stack.split(square, {normalized(Vec3d(1, 1, 0)), 0.0}, {}, 0.0);
  ASSERT_EQ(diagonal.side, Side::kBoth);
  EXPECT_EQ(diagonal.front.count, 3u);
  EXPECT_EQ(diagonal.back.count, 3u);
}

TEST(PolygonSplit, LeavesThePolygonItselfUnchanged) {
  PolygonStack stack;
  const Piece square = push(stack, kSplitSquare);
  stack.split(square, {{1, 0, 0}, -0.5}, {}, 0.0);
  for (std::size_t i = 0; i < kSplitSquare.size(); ++i) {
    EXPECT_EQ(stack.of(square)[i].position, kSplitSquare[i]);
  }
}

TEST(PolygonSplit, KeepsAreaAndOrientationAndPutsEachPartOnItsSide) {
  int splits = 0;
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
      Random random(seed);
      PolygonStack stack;
      const Piece piece =
          push(stack, ring(random, 3 + random.below(12), random.in(0.1, 5.0) * scale, 6.0 * scale));
      const Vec3d normal = normalized(random.point(1.0));
      const Plane plane{normal, random.in(-5.0, 5.0) * scale};
      const Vec3d before = doubleArea(stack.of(piece));
      const SplitResult result = stack.split(piece, plane, {}, 0.0);
      if (result.side != Side::kBoth) {
        continue;
      }
      ++splits;
      const Vec3d front = doubleArea(stack.of(result.front)), back = doubleArea(stack.of(result.back));
      const double size = scale * scale;
      EXPECT_NEAR(length(before - front - back), 0.0, 1e-9 * size) << "seed " << seed;
      EXPECT_GE(dot(front, before), 0.0) << "seed " << seed;
      EXPECT_GE(dot(back, before), 0.0) << "seed " << seed;
      EXPECT_GE(result.front.count, 3u) << "seed " << seed;
      EXPECT_GE(result.back.count, 3u) << "seed " << seed;
      EXPECT_LE(result.front.count + result.back.count, piece.count + 4) << "seed " << seed;
      for (const Corner& corner : stack.of(result.front)) {
        EXPECT_GT(plane.evaluate(corner.position), -1e-12 * scale) << "seed " << seed;
      }
      for (const Corner& corner : stack.of(result.back)) {
        EXPECT_LT(plane.evaluate(corner.position), 1e-12 * scale) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(splits, 2000);
}

TEST(PolygonSplit, CornersWithinTheToleranceCountAsOnThePlane) {
  PolygonStack stack;
  const Piece square = push(stack, kSplitSquare);
  // The corners at x = 1 have a magnitude of 2.
  const double on_plane = kOnPlane * 2.0;
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -1.0 + 0.5 * on_plane}, {}, 0.0).side, Side::kBack);
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -1.0 + 3.5 * on_plane}, {}, 0.0).side, Side::kBack)
      << "a side is reached at four times the tolerance";
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -1.0 + 5.0 * on_plane}, {}, 0.0).side, Side::kBoth);
  EXPECT_EQ(stack.split(square, {{1, 0, 0}, -1.0 + 5.0 * on_plane}, {}, 1.0).side, Side::kBack)
      << "the scale widens the tolerance";
}

TEST(PolygonSplit, NewEdgesAreNamedAndEmbedded) {
  std::vector<Plane> planes{{{1, 0, 0}, -0.5}};
  PolygonStack stack;
  stack.planes = &planes;
  const Piece square = push(stack, kSplitSquare);
  const PlaneRef ref = PlaneRef::make(0, false);
  const SplitResult result = stack.split(square, planes[0], ref, 0.0);
  ASSERT_EQ(result.side, Side::kBoth);
  for (const bool front : {true, false}) {
    int named = 0;
    const std::vector<Corner> corners = copyOf(stack, front ? result.front : result.back);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const bool in_plane =
          corners[i].position.x == 0.5 && corners[(i + 1) % corners.size()].position.x == 0.5;
      EXPECT_EQ(corners[i].embedded, in_plane);
      EXPECT_EQ(corners[i].edge.bits == PlaneRef{}.bits, !in_plane);
      if (in_plane) {
        ++named;
        EXPECT_TRUE(corners[i].edge.samePlane(ref));
        // Polygons lie behind the plane of their edge: the front part behind the flipped one.
        EXPECT_EQ(corners[i].edge.flipped(), front);
      }
    }
    EXPECT_EQ(named, 1);
  }
}

TEST(PolygonSplit, APartStaysOnTheSideOfThePlaneThatMadeItsEdge) {
  // A second split by the same plane id changes nothing, whatever the rounding.
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    std::vector<Plane> planes{{normalized(random.point(1.0)), random.in(-3.0, 3.0)}};
    PolygonStack stack;
    stack.planes = &planes;
    const Piece piece = push(stack, ring(random, 3 + random.below(6), 4.0, 5.0));
    const PlaneRef ref = PlaneRef::make(0, random.below(2) == 0);
    const Plane plane = ref.flipped() ? planes[0].flipped() : planes[0];
    const SplitResult result = stack.split(piece, plane, ref, 0.0);
    if (result.side != Side::kBoth) {
      continue;
    }
    EXPECT_EQ(stack.split(result.front, plane, ref, 0.0).side, Side::kFront) << "seed " << seed;
    EXPECT_EQ(stack.split(result.back, plane, ref, 0.0).side, Side::kBack) << "seed " << seed;
    // With the plane flipped, the result is the opposite one.
    EXPECT_EQ(stack.split(result.front, plane.flipped(), ref.other(), 0.0).side, Side::kBack)
        << "seed " << seed;
    EXPECT_EQ(stack.split(result.back, plane.flipped(), ref.other(), 0.0).side, Side::kFront)
        << "seed " << seed;
  }
}

TEST(PolygonSplit, AnOldEdgeInThePlaneIsEmbeddedWhenItBoundsThePolygonTowardsTheSameSide) {
  // The square's edge at x = 1, made by plane 0 (x = 1); plane 1 is the same, plane 2 turned.
  std::vector<Plane> planes{{{1, 0, 0}, -1.0}, {{1, 0, 0}, -1.0}, {{-1, 0, 0}, 1.0}};
  const std::vector<double> tolerances(planes.size(), 1e-6);
  for (const std::size_t by : {1u, 2u}) {
    PolygonStack stack;
    stack.planes = &planes;
    stack.tolerances = &tolerances;
    const Piece square = push(stack, kSplitSquare);
    stack.corners[1].edge = PlaneRef::make(0, false);
    const SplitResult result = stack.split(square, planes[by], PlaneRef::make(by, false), 0.0);
    EXPECT_EQ(result.side, by == 1 ? Side::kBack : Side::kFront);
    EXPECT_TRUE(stack.of(square)[1].embedded) << by;
    EXPECT_EQ(stack.of(square)[1].edge.bits, PlaneRef::make(0, false).bits) << "it keeps its own plane";
    for (const std::size_t other : {0u, 2u, 3u}) {
      EXPECT_FALSE(stack.of(square)[other].embedded);
    }
  }
}

TEST(PolygonSplit, AnOldEdgeIsNotEmbeddedInAPlaneOfAnotherWidth) {
  const std::vector<Plane> planes(2, Plane{{1, 0, 0}, -1.0});
  for (const double width : {0.0, 0.9e-6, 1e-6 + 1e-13, 1.1e-6}) {
    const std::vector<double> tolerances{1e-6, width};
    PolygonStack stack;
    stack.planes = &planes;
    stack.tolerances = &tolerances;
    stack.equal_tolerance = 1e-12;
    const Piece square = push(stack, kSplitSquare);
    stack.corners[1].edge = PlaneRef::make(0, false);
    EXPECT_EQ(stack.split(square, planes[1], PlaneRef::make(1, false), 0.0).side, Side::kBack);
    EXPECT_EQ(stack.of(square)[1].embedded, width == 1e-6 + 1e-13) << width;
  }
}

TEST(PolygonSplit, TheCutOfALongEdgeIsAsGoodAsItsNearerEnd) {
  // A ribbon from 2 m to about 1e15 m, where neighbouring numbers are an eighth of a metre apart.
  for (const bool near_first : {true, false}) {
    PolygonStack stack;
    const double z0 = near_first ? -2.0 : -1.2345e15 / 1.1, z1 = near_first ? -1.2345e15 / 1.1 : -2.0;
    const Piece ribbon = push(stack, std::vector<Vec3d>{{-1, 0, z0}, {1, 0, z0}, {1, 0, z1}, {-1, 0, z1}});
    const SplitResult result = stack.split(ribbon, {{0, 0, 1}, 3.3}, {}, 0.0);
    ASSERT_EQ(result.side, Side::kBoth);
    for (const Corner& corner : stack.of(result.front)) {
      EXPECT_TRUE(corner.position.z == -2.0 || std::abs(corner.position.z + 3.3) < 1e-14)
          << corner.position.z;
    }
  }
}

TEST(PolygonSplit, PolygonsThatWouldGetTooManyCornersAreReported) {
  Random random(1);
  PolygonStack stack;
  const Piece fits = push(stack, ring(random, PolygonStack::kMaxCorners - 2, 1.0, 0.0));
  const Piece large = push(stack, ring(random, PolygonStack::kMaxCorners - 1, 1.0, 0.0));
  EXPECT_NE(stack.split(fits, {{1, 0, 0}, 0.0}, {}, 0.0).side, Side::kOnPlane);
  EXPECT_FALSE(stack.overflow);
  EXPECT_EQ(stack.split(large, {{1, 0, 0}, 0.0}, {}, 0.0).side, Side::kOnPlane);
  EXPECT_TRUE(stack.overflow);
}

TEST(PolygonSplit, ManySplitsKeepTheWholeArea) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    PolygonStack stack;
    std::vector<Piece> pieces{push(stack, ring(random, 5, 4.0, 3.0))};
    const Vec3d whole = doubleArea(stack.of(pieces[0]));
    for (int cut = 0; cut < 8; ++cut) {
      const Plane plane{normalized(random.point(1.0)), random.in(-2.0, 2.0)};
      std::vector<Piece> next;
      for (const Piece piece : pieces) {
        const SplitResult result = stack.split(piece, plane, {}, 0.0);
        if (result.side == Side::kBoth) {
          next.push_back(result.front);
          next.push_back(result.back);
        } else {
          next.push_back(piece);
        }
      }
      pieces = next;
    }
    Vec3d sum;
    for (const Piece piece : pieces) {
      sum += doubleArea(stack.of(piece));
    }
    EXPECT_NEAR(length(sum - whole), 0.0, 1e-9) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline::occlusion
