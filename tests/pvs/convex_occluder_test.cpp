// Convex occluders: which ones are found, how far they are inset, and when a region is separated from them.

#include <gtest/gtest.h>

#include "tests/pvs/convex_scenes.h"

namespace sightline {
namespace {

using namespace test;
using pvs::separated;

Shape wallShape(bool double_sided = false) {  // faces +z
  Shape shape;
  shape.solid.points = {{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}, {-2, 1, 0}};
  shape.solid.faces = {{0, 1, 2, 3}};
  shape.double_sided = double_sided;
  return shape;
}

Shape blockShape(const Vec3f& low, const Vec3f& high) {
  return {block(low, high), false};
}

TEST(ConvexOccluders, HaveEachBodyOnceAndEachOtherPolygon) {
  const std::vector<Shape> shapes{wallShape(), blockShape({0, 0, 5}, {3, 4, 7}), {octahedron(), false}};
  const ConvexOccluders all(setOf(shapes));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_TRUE(all[0].body);
  EXPECT_EQ(all[0].object, ObjectId(1u));
  EXPECT_NEAR(all[0].area, 12.0, 1e-5);
  EXPECT_NEAR(all[0].volume, 24.0, 1e-5);
  EXPECT_EQ(all[0].bounds, (Box{{0, 0, 5}, {3, 4, 7}}));
  EXPECT_EQ(all.facesOf(all[0]).size(), 6u);
  EXPECT_EQ(all.edgesOf(all[0]).size(), 12u);
  EXPECT_FALSE(all[1].body);
  EXPECT_NEAR(all[1].area, 8.0, 1e-5);
  EXPECT_EQ(all[1].volume, 0.0);
  EXPECT_EQ(all[1].bounds, (Box{{-2, -1, 0}, {2, 1, 0}}));
  EXPECT_EQ(all.edgesOf(all[1]).size(), 4u);
  EXPECT_TRUE(all[2].body);
  EXPECT_NEAR(all[2].volume, 4.0 / 3.0, 1e-6);
}

TEST(ConvexOccluders, AreLargestFirst) {
  Random random(3);
  std::vector<Shape> shapes;
  for (int i = 0; i < 60; ++i) {
    const Vec3d origin(4.0 * i, 0, 0);
    shapes.push_back(i % 2 == 0 ? randomPolygon(random, origin, 1.0) : randomBody(random, origin, 1.0));
  }
  const ConvexOccluders all(setOf(shapes));
  ASSERT_EQ(all.size(), shapes.size());
  for (std::uint32_t i = 1; i < all.size(); ++i) {
    EXPECT_LE(all[i].area, all[i - 1].area);
  }
}

// Minimum depth of the inset corners behind all planes; for a polygon, behind the lines of its edges.
long double depthOfDrawn(const ConvexOccluders& all, const ConvexOccluder& occluder, const Shape& shape,
                         const OccluderSet& set) {
  long double least = INFINITY;
  for (const pvs::DrawnEdge& edge : all.edgesOf(occluder)) {
    using Vec3l = Vec3<long double>;
    const Vec3l p(edge.from);
    if (occluder.body) {
      for (const BodyFace& face : set.facesOf(set.bodies[0])) {
        const Plane& plane = face.plane;
        least = std::min(least, -(dot(Vec3l(plane.normal), p) + static_cast<long double>(plane.offset)));
      }
      continue;
    }
    const std::vector<Vec3f> corners = shape.solid.polygon(0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3l a(corners[i]), b(corners[(i + 1) % corners.size()]);
      const Vec3l inwards = normalized(cross(Vec3l(all.facesOf(occluder)[0].plane.normal), b - a));
      least = std::min(least, dot(inwards, p - a));
    }
  }
  return least;
}

TEST(ConvexOccluders, AreDrawnInByTheirMargin) {
  int used = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Random random(seed);
    const double scale = std::pow(10.0, random.in(-3.0, 3.0)), off = seed % 3 == 0 ? 1e4 : 10.0;
    const Vec3d origin = random.point(off * scale);
    const Shape shape =
        seed % 2 == 0 ? randomPolygon(random, origin, scale) : randomBody(random, origin, scale);
    OccluderSet set = setOf(std::span(&shape, 1));
    const auto slack = static_cast<float>(seed % 5 == 0 ? 0.01 * scale : 0.0);
    for (Occluder& occluder : set.occluders) {
      occluder.slack = std::max(occluder.slack, slack);
    }
    for (OccluderBody& body : set.bodies) {
      body.slack = std::max(body.slack, slack);
    }
    const ConvexOccluders all(set);
    if (all.size() != 1) {
      continue;
    }
    ++used;
    EXPECT_GE(all[0].margin, 2.0 * static_cast<double>(slack)) << "seed " << seed;
    EXPECT_GE(depthOfDrawn(all, all[0], shape, set), static_cast<long double>(2.0f * slack))
        << "seed " << seed;
    EXPECT_LE(depthOfDrawn(all, all[0], shape, set), static_cast<long double>(scale)) << "seed " << seed;
  }
  EXPECT_GT(used, 300);
}

TEST(ConvexOccluders, AreNoneWhereTheMarginIsNotClearlySmaller) {
  OccluderSet set = setOf(std::vector{wallShape()});
  set.occluders[0].slack = 0.05f;  // of a half height of 1
  EXPECT_EQ(ConvexOccluders(set).size(), 1u);
  set.occluders[0].slack = 0.2f;
  EXPECT_EQ(ConvexOccluders(set).size(), 0u);
  set.occluders[0].slack = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ConvexOccluders(set).size(), 0u);
  EXPECT_EQ(ConvexOccluders(OccluderSet()).size(), 0u);
}

TEST(ConvexOccluders, HaveTheFacesOfABodyThatIsTooThin) {
  OccluderSet set = setOf(std::vector{blockShape({-5, -5, -0.05f}, {5, 5, 0.05f})});
  ASSERT_EQ(set.bodies.size(), 1u);
  set.bodies[0].slack = 0.02f;
  for (Occluder& occluder : set.occluders) {
    occluder.slack = 0.02f;
  }
  const ConvexOccluders all(set);
  ASSERT_EQ(all.size(), 2u);  // nothing is left of the sides
  EXPECT_FALSE(all[0].body);
  EXPECT_NEAR(all[1].area, 100.0, 1e-4);
}

TEST(Separated, NeedsThePolygonsFront) {
  const ConvexOccluders all(setOf(std::vector{wallShape()}));
  const auto at = [&](const Vec3d& low, const Vec3d& high) {
    return separated(all, all[0], cornersOf(boxOf(low, high)), 0.0);
  };
  EXPECT_TRUE(at({-9, -9, 1e-3}, {9, 9, 5}));
  EXPECT_TRUE(at({7, 0, 1e-3}, {9, 9, 5}));
  EXPECT_FALSE(at({-9, -9, 0}, {9, 9, 5}));
  EXPECT_FALSE(at({-9, -9, -5}, {9, 9, -1}));
  EXPECT_FALSE(at({7, 0, -1}, {9, 9, 5}));
  const ConvexOccluders both(setOf(std::vector{wallShape(true)}));
  const std::vector<Vec3d> behind = cornersOf(boxOf({-9, -9, -5}, {9, 9, -1}));
  EXPECT_TRUE(separated(both, both[0], behind, 0.0));
  const std::vector<Vec3d> beside = cornersOf(boxOf({7, 0, -1}, {9, 9, 5}));
  EXPECT_FALSE(separated(both, both[0], beside, 0.0));
}

TEST(Separated, NeedsToBeOutsideOfTheBody) {
  const ConvexOccluders all(setOf(std::vector{blockShape({-1, -1, -1}, {1, 1, 1})}));
  const auto at = [&](const Vec3d& low, const Vec3d& high) {
    return separated(all, all[0], cornersOf(boxOf(low, high)), 0.0);
  };
  EXPECT_TRUE(at({1.001, -9, -9}, {9, 9, 9}));
  EXPECT_FALSE(at({1, -9, -9}, {9, 9, 9}));
  EXPECT_FALSE(at({0.5, 0.5, 0.5}, {9, 9, 9}));
  EXPECT_FALSE(at({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}));
  EXPECT_FALSE(at({-9, -9, -9}, {9, 9, 9}));
  // Beyond the tip of an octahedron, only a plane of the boxes separates.
  const ConvexOccluders tip(setOf(std::vector{Shape{octahedron(), false}}));
  EXPECT_TRUE(separated(tip, tip[0], cornersOf(boxOf({1.01, -3, -3}, {2, 3, 3})), 0.0));
  EXPECT_FALSE(separated(tip, tip[0], cornersOf(boxOf({0.9, -3, -3}, {2, 3, 3})), 0.0));
}

TEST(Separated, IsFalseOfNoRegionAndOfOneThatIsNotFinite) {
  const ConvexOccluders all(setOf(std::vector{wallShape()}));
  EXPECT_FALSE(separated(all, all[0], {}, 0.0));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec3d> corners = cornersOf(boxOf({-1, -1, 1}, {1, 1, 2}));
      corners[3][axis] = bad;
      EXPECT_FALSE(separated(all, all[0], corners, 0.0));
    }
  }
}

TEST(Separated, KeepsTheNearDistance) {
  const ConvexOccluders all(setOf(std::vector{wallShape()}));
  const std::vector<Vec3d> before = cornersOf(boxOf({-9, -9, 0.5}, {9, 9, 5}));
  EXPECT_TRUE(separated(all, all[0], before, 0.499));
  EXPECT_FALSE(separated(all, all[0], before, 0.5));
  // Near the plane, but 3 metres from the wall's end and 4 above it: 5 metres from its corner.
  const std::vector<Vec3d> aside = cornersOf(boxOf({5, 5, 0.5}, {9, 9, 5}));
  EXPECT_TRUE(separated(all, all[0], aside, 4.999));
  EXPECT_FALSE(separated(all, all[0], aside, 5.03));
}

// The real triangles may be closer than the polygons, by the slack.
TEST(Separated, CountsTheSlack) {
  const std::vector<Shape> shapes{wallShape(), blockShape({-2, -1, -4}, {2, 1, 0})};
  for (const Shape& shape : shapes) {
    OccluderSet set = setOf(std::span(&shape, 1));
    for (Occluder& occluder : set.occluders) {
      occluder.slack = 0.05f;
    }
    for (OccluderBody& body : set.bodies) {
      body.slack = 0.05f;
    }
    const ConvexOccluders all(set);
    ASSERT_EQ(all.size(), 1u);
    const auto at = [&](const Vec3d& nearest, double near_distance) {
      return separated(all, all[0], cornersOf(boxOf(nearest, {9, 9, 9})), near_distance);
    };
    EXPECT_FALSE(at({-9, -9, 0.05}, 0.0));
    EXPECT_TRUE(at({-9, -9, 0.15}, 0.0));
    EXPECT_FALSE(at({-9, -9, 0.55}, 0.5));
    EXPECT_TRUE(at({-9, -9, 0.65}, 0.5));
    EXPECT_FALSE(at({5, 5, 0.15}, 4.99));  // 5 metres from the corner, by the boxes, less the slack
    EXPECT_TRUE(at({5, 5, 0.15}, 4.89));
  }
}

// Random points of both are never closer than the requested distance, and never on a wrong side.
TEST(Separated, HoldsForAllPointsOfBoth) {
  int yes = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    const Shape shape =
        seed % 2 == 0 ? randomPolygon(random, {0, 0, 0}, 1.0) : randomBody(random, {0, 0, 0}, 1.0);
    const OccluderSet set = setOf(std::span(&shape, 1));
    const ConvexOccluders all(set);
    ASSERT_EQ(all.size(), 1u) << "seed " << seed;
    const Box region = boxAround(random.point(2.0), {random.in(0, 1), random.in(0, 1), random.in(0, 1)});
    const double near_distance = random.in(0.0, 0.5);
    if (!separated(all, all[0], cornersOf(region), near_distance)) {
      continue;
    }
    ++yes;
    int before = 0, behind = 0;
    for (int i = 0; i < 40; ++i) {
      const Vec3d q = pointIn(region, random), p = pointWithin(shape, random);
      ASSERT_GT(length(q - p), near_distance) << "seed " << seed;
      ++(set.occluders[0].plane.evaluate(q) > 0.0 ? before : behind);
    }
    if (!shape.body()) {
      EXPECT_TRUE(behind == 0 || (before == 0 && shape.double_sided)) << "seed " << seed;
    }
  }
  EXPECT_GT(yes, 800);
}

}  // namespace
}  // namespace sightline
