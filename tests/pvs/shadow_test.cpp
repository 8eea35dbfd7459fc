// Compares shadows of convex occluders, from points and from convex regions, with exact segments.

#include <gtest/gtest.h>

#include "tests/pvs/convex_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace test;
using pvs::separated;

struct Family {
  const char* name;
  double scale;   // metres
  double offset;  // of the origin, metres
  bool sliver;
};
constexpr Family kFamilies[] = {{"metres", 1.0, 0.0, false},         {"placed", 3.0, 30.0, false},
                                {"slivers", 1.0, 1.0, true},         {"tiny", 1e-4, 0.0, false},
                                {"tiny, far off", 0.05, 1e4, false}, {"huge", 1e6, 1e6, false},
                                {"huge and tiny", 10.0, 1e6, false}};

// One random occluder.
struct Single {
  Random random;
  Vec3d origin;
  Shape shape;
  OccluderSet set;
  ConvexOccluders all;

  Single(const Family& family, std::uint64_t seed)
      : random(seed),
        origin(random.point(family.offset)),
        shape(seed % 2 == 0 ? randomPolygon(random, origin, family.scale, family.sliver)
                            : randomBody(random, origin, family.scale, family.sliver)),
        set(setOf(std::span(&shape, 1))),
        all(set) {}

  const std::vector<Vec3f>& points() const { return shape.solid.points; }
  Vec3d corner() { return Vec3d(points()[random.below(static_cast<std::uint32_t>(points().size()))]); }
};

// An eye anywhere around, or at a difficult place: in a face's plane, on an edge's line, at a corner's
// coordinates, close in front of the shape.
Vec3d eyeFor(Single& s, double scale) {
  const Vec3d a = s.corner(), b = s.corner(), c = s.corner();
  switch (s.random.below(8)) {
    case 0:
      return a + (b - a) * s.random.in(1.5, 4.0) + (c - a) * s.random.in(-2.0, 2.0);
    case 1:
      return a + (b - a) * s.random.in(1.01, 9.0);
    case 2:
      return {a.x, b.y, c.z + s.random.in(-3.0, 3.0) * scale};
    case 3:
      return pointWithin(s.shape, s.random) + randomDirection(s.random) * (scale * 1e-3);
    case 4:
      return s.origin + randomDirection(s.random) * (scale * s.random.in(20.0, 500.0));
    case 5:  // so far away that rounding exceeds the margin
      return s.origin + randomDirection(s.random) * (scale * std::pow(10.0, s.random.in(3.0, 10.0)));
    default:
      return s.origin + randomDirection(s.random) * (scale * s.random.in(1.2, 6.0));
  }
}

// Boxes behind the shape as seen from the eye, beside shadow planes, and touching the shape.
std::vector<Box> boxesFor(Single& s, const Vec3d& eye, double scale) {
  std::vector<Box> boxes;
  Random& random = s.random;
  // A point on the ray from the eye through a point of the shape.
  const auto beyond = [&](const Vec3d& p, int i) {
    const double farther = i % 3 == 0 ? scale / length(p - eye) : 1.0;
    return eye + (p - eye) * (1.0 + random.in(0.0, 3.0) * farther);
  };
  const auto half = [&] {
    const double size = scale * std::pow(10.0, random.in(-4.0, -0.5));
    return Vec3d(size, random.below(5) == 0 ? 0.0 : size * random.in(0.1, 1.0), size * random.in(0.1, 1.0));
  };
  for (int i = 0; i < 12; ++i) {  // a box that contains a visible point of the shape and a point beyond it
    const Vec3d p = pointWithin(s.shape, random, i % 2 == 0);
    boxes.push_back(boxAround(beyond(p, i), half()));
  }
  // A box with a point of a shadow plane as its corner, or consisting of that point only.
  for (int i = 0; i < 12; ++i) {
    const Vec3d a = s.corner(), b = s.corner();
    const Vec3d p = beyond(a + (b - a) * random.in(0.0, 1.0), i);
    const Vec3d h = half(), turn = random.point(1.0);
    const Vec3d signs(turn.x < 0 ? -1 : 1, turn.y < 0 ? -1 : 1, turn.z < 0 ? -1 : 1);
    boxes.push_back(i % 4 == 0 ? boxOf(p, p)
                               : boxOf(p, p + Vec3d(h.x * signs.x, h.y * signs.y, h.z * signs.z)));
  }
  for (int i = 0; i < 4; ++i) {  // a box at a corner, containing part of the shape
    const Vec3d a = s.corner(), b = s.corner();
    boxes.push_back(boxOf(a, a + randomDirection(random) * (0.3 * scale)));
    boxes.push_back(boxOf(a, b));
  }
  for (int i = 0; i < 4; ++i) {
    boxes.push_back(boxAround(s.origin + random.point(5.0 * scale), half()));
  }
  return boxes;
}

// Checks with rays that all of a hidden box is blocked.
void expectBlocked(const Shape& shape, const Vec3d& eye, const Box& box, Random& random,
                   const std::string& what) {
  std::vector<Vec3d> points = cornersOf(box);
  for (int i = 0; i < 4; ++i) {
    points.push_back(pointIn(box, random));
  }
  for (const Vec3d& x : points) {
    ASSERT_TRUE(blocks(shape, eye, x)) << what;
  }
}

TEST(ConvexShadow, HidesNothingThatCanBeSeen) {
  for (const Family& family : kFamilies) {
    std::size_t hidden_count = 0, usable = 0;
    for (std::uint64_t seed = 0; seed < test::rounds(120u); ++seed) {
      Single s(family, seed);
      if (s.all.size() != 1) {
        continue;  // thinner than rounding
      }
      ++usable;
      for (int view = 0; view < 4; ++view) {
        const Vec3d eye = eyeFor(s, family.scale);
        if (!separated(s.all, s.all[0], std::span(&eye, 1), 0.0)) {
          continue;
        }
        const std::vector<Box> boxes = boxesFor(s, eye, family.scale);
        for (const std::uint32_t i : hiddenBoxes(s.all, s.all[0], eye, boxes)) {
          ++hidden_count;
          expectBlocked(s.shape, eye, boxes[i], s.random,
                        std::string(family.name) + ", seed " + std::to_string(seed));
        }
      }
    }
    EXPECT_GT(usable, test::rounds(60u)) << family.name;
    EXPECT_GT(hidden_count, test::rounds(2000u)) << family.name;
  }
}

TEST(ConvexShadow, HidesWhatIsClearlyBehind) {
  int asked = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    Single s(kFamilies[seed % 2], seed);
    ASSERT_EQ(s.all.size(), 1u) << "seed " << seed;
    const double scale = kFamilies[seed % 2].scale;
    const Vec3d eye = s.origin + randomDirection(s.random) * (scale * s.random.in(2.0, 8.0));
    if (!s.shape.body()) {  // clearly in front of the polygon
      const double height = s.set.occluders[0].plane.evaluate(eye) / length(eye - s.origin);
      if (!((s.shape.double_sided ? std::abs(height) : height) > 0.3)) {
        continue;
      }
    }
    ++asked;
    EXPECT_TRUE(separated(s.all, s.all[0], std::span(&eye, 1), 0.1 * scale)) << "seed " << seed;
    const Vec3d middle = pointWithin(s.shape, s.random, true);
    const double beyond = 1.0 + s.random.in(1.5, 5.0) * scale / length(middle - eye);
    const Box box = boxAround(eye + (middle - eye) * beyond, Vec3d(1, 1, 1) * (0.01 * scale));
    EXPECT_EQ(hiddenBoxes(s.all, s.all[0], eye, std::span(&box, 1)).size(), 1u) << "seed " << seed;
  }
  EXPECT_GT(asked, 900);
}

// The shadow ends where it should, to within a ten-thousandth of the edge's position.
TEST(ConvexShadow, ReachesNearlyToItsEdges) {
  const Shape shape{block({-1, -2, -3}, {1, 2, 3}), false};
  const ConvexOccluders all(setOf(std::span(&shape, 1)));
  const Vec3d eye(0, 0, 13);  // from here, the near face at z = 3 projects to twice its size at z = -7
  const double x = 2.0, y = 4.0;
  const std::vector<Box> boxes{
      boxOf({-0.9999 * x, -0.9999 * y, -7}, {0.9999 * x, 0.9999 * y, -7}),
      boxOf({0, 0, -7}, {1.0001 * x, 0.9 * y, -7}), boxOf({0, 0, -7}, {0.9 * x, 1.0001 * y, -7}),
      boxOf({-0.9, -1.9, 2.9}, {0.9, 1.9, 2.9999}), boxOf({-0.9, -1.9, 2.9}, {0.9, 1.9, 3})};
  EXPECT_EQ(hiddenBoxes(all, all[0], eye, boxes), (std::set<std::uint32_t>{0, 3}));
}

TEST(ConvexShadow, IsNoneFromBehindAPolygonFromItsPlaneAndFromWithinABody) {
  Shape wall;
  wall.solid.points = {{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}, {-2, 1, 0}};
  wall.solid.faces = {{0, 1, 2, 3}};
  const ConvexOccluders all(setOf(std::span(&wall, 1)));
  Shadow shadow;
  EXPECT_TRUE(makeShadow(all, all[0], {0, 0, 1}, 10.0, shadow));
  EXPECT_FALSE(makeShadow(all, all[0], {0, 0, -1}, 10.0, shadow));
  EXPECT_FALSE(makeShadow(all, all[0], {5, 0, 0}, 10.0, shadow));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(makeShadow(all, all[0], {0, 0, nan}, 10.0, shadow));
  EXPECT_FALSE(makeShadow(all, all[0], {0, 0, 1}, nan, shadow));
  const Shape cube{block({-1, -1, -1}, {1, 1, 1}), false};
  const ConvexOccluders body(setOf(std::span(&cube, 1)));
  EXPECT_TRUE(makeShadow(body, body[0], {0, 0, 2}, 10.0, shadow));
  EXPECT_FALSE(makeShadow(body, body[0], {0, 0, 0}, 10.0, shadow));
  EXPECT_FALSE(makeShadow(body, body[0], {0, 0, nan}, 10.0, shadow));
}

// Each vertex of the real mesh is off the occluder by up to the slack, in a random direction.
TEST(ConvexShadow, HidesNothingThatCanBeSeenPastAMeshThatIsOffBySlack) {
  std::size_t hidden_count = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Single s(kFamilies[seed % 2], seed);
    const double scale = kFamilies[seed % 2].scale;
    const double slack = scale * std::pow(10.0, s.random.in(-5.0, -1.7));
    Shape drawn = s.shape;
    for (Vec3f& p : drawn.solid.points) {
      p = Vec3f(Vec3d(p) + randomDirection(s.random) * (0.999 * slack));
    }
    for (Occluder& occluder : s.set.occluders) {
      occluder.slack = static_cast<float>(slack);
    }
    for (OccluderBody& body : s.set.bodies) {
      body.slack = static_cast<float>(slack);
    }
    const ConvexOccluders all(s.set);
    if (all.size() != 1) {
      continue;
    }
    for (int view = 0; view < 4; ++view) {
      const Vec3d eye = eyeFor(s, scale);
      if (!separated(all, all[0], std::span(&eye, 1), 0.0)) {
        continue;
      }
      std::vector<Box> boxes = boxesFor(s, eye, scale);
      for (const std::uint32_t i : hiddenBoxes(all, all[0], eye, boxes)) {
        ++hidden_count;
        expectBlocked(drawn, eye, boxes[i], s.random, "seed " + std::to_string(seed));
      }
    }
  }
  EXPECT_GT(hidden_count, 3000u);
}

// The corners of a box, or of the part of it in front of a plane.
std::vector<Vec3d> randomRegion(Random& random, const Box& box) {
  const std::vector<Vec3d> corners = cornersOf(box);
  if (random.below(2) == 0) {
    return corners;
  }
  Plane plane{randomDirection(random), 0.0};
  plane.offset = -dot(plane.normal, pointIn(box, random));
  std::vector<Vec3d> kept;
  for (std::size_t i = 0; i < 8; ++i) {
    const double height = plane.evaluate(corners[i]);
    if (height >= 0.0) {
      kept.push_back(corners[i]);
    }
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const double other = plane.evaluate(corners[i ^ bit]);
      if (height >= 0.0 && other < 0.0) {
        kept.push_back(corners[i] + (corners[i ^ bit] - corners[i]) * (height / (height - other)));
      }
    }
  }
  return kept.empty() ? corners : kept;
}

Vec3d pointAmong(std::span<const Vec3d> corners, Random& random) {
  Vec3d sum;
  double weights = 0.0;
  for (const Vec3d& corner : corners) {
    const double weight = std::pow(random.in(0.0, 1.0), 4.0);
    sum += corner * weight;
    weights += weight;
  }
  return sum / weights;
}

TEST(ConvexShadow, OfAllCornersOfARegionHidesFromAllOfTheRegion) {
  std::size_t hidden_count = 0;
  for (std::uint64_t seed = 0; seed < 900; ++seed) {
    const Family& family = kFamilies[seed % 3];
    Single s(family, seed);
    if (s.all.size() != 1) {
      continue;
    }
    const Vec3d middle = s.origin + randomDirection(s.random) * (family.scale * s.random.in(1.0, 6.0));
    const Vec3d half =
        Vec3d(s.random.in(0.01, 1.0), s.random.in(0.01, 1.0), s.random.in(0.01, 1.0)) * family.scale;
    const std::vector<Vec3d> corners = randomRegion(s.random, boxAround(middle, half));
    if (!separated(s.all, s.all[0], corners, 0.0)) {
      continue;
    }
    const std::vector<Box> boxes = boxesFor(s, middle, family.scale);
    std::set<std::uint32_t> hidden = hiddenBoxes(s.all, s.all[0], corners[0], boxes);
    for (const Vec3d& corner : corners) {
      const std::set<std::uint32_t> from_here = hiddenBoxes(s.all, s.all[0], corner, boxes);
      std::erase_if(hidden, [&](std::uint32_t i) { return !from_here.contains(i); });
    }
    hidden_count += hidden.size();
    for (const std::uint32_t i : hidden) {
      for (int view = 0; view < 6; ++view) {
        expectBlocked(s.shape, pointAmong(corners, s.random), boxes[i], s.random,
                      "seed " + std::to_string(seed));
      }
    }
  }
  EXPECT_GT(hidden_count, 800u);
}

}  // namespace
}  // namespace sightline
