#include "src/layers/pairs/convex_pair.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include "src/layers/hull/support.h"
#include "tests/layers/hull_of.h"
#include "tests/support/exact_pairs.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/rounds.h"

namespace sightline::layers {

std::ostream& operator<<(std::ostream& out, Intersection m) {
  return out << std::array{"disjoint", "intersecting", "undecided"}[static_cast<std::size_t>(m)];
}

namespace {

using shapes::hullOf;
using shapes::Points;
using shapes::Random;
using Kind = ConvexSet::Kind;

constexpr std::array<Kind, 3> kKinds{Kind::kHull, Kind::kWithEye, Kind::kSwept};

Intersection ask(const ConvexSet& first, const ConvexSet& second) {
  PairWitness witness;
  PairCounts counts;
  return testIntersection(first, second, witness, counts);
}

Intersection ask(const Points& first, const Points& second) {
  const ConvexHull a = hullOf(first), b = hullOf(second);
  return ask(ConvexSet{&a}, ConvexSet{&b});
}

// The set's points in the world, exact if the placement's numbers are small whole numbers.
Points worldPoints(const ConvexSet& set, const Points& points) {
  Points world;
  for (const Vec3d& p : points) {
    world.push_back(set.placement.point(p));
  }
  const std::size_t count = world.size();
  if (set.kind == Kind::kWithEye) {
    world.push_back(set.eye_or_sweep);
  } else if (set.kind == Kind::kSwept) {
    for (std::size_t i = 0; i < count; ++i) {
      world.push_back(world[i] + set.eye_or_sweep);
    }
  }
  return world;
}

// Tests the pair in both orders, and again with the witnesses of the first tests.
void expectExact(const ConvexSet& first, const Points& first_points, const ConvexSet& second,
                 const Points& second_points) {
  const bool intersect =
      test::convexHullsIntersect(worldPoints(first, first_points), worldPoints(second, second_points));
  PairWitness there, back;
  PairCounts counts;
  for (int i = 0; i < 2; ++i) {
    for (const Intersection answer :
         {testIntersection(first, second, there, counts), testIntersection(second, first, back, counts)}) {
      if (intersect) {
        EXPECT_NE(answer, Intersection::kDisjoint);
      } else {
        EXPECT_EQ(answer, Intersection::kDisjoint);
      }
    }
  }
}

// A random point, segment, polygon or solid with whole coordinates.
Points randomWhole(Random& random) {
  const int dimension = random.whole(0, 3);
  const int half = random.whole(1, 5);
  return dimension == 3 ? shapes::randomGrid(random, 4 + random.below(8), half)
                        : shapes::randomFlatGrid(random, 1 + random.below(6), half, dimension);
}

Vec3d randomWholePoint(Random& random, int half) {
  return shapes::randomGrid(random, 1, half)[0];
}

// Two random sets with small whole coordinates.
struct WholePair {
  WholePair(Random& random, ConvexSet::Kind kind)
      : a(randomWhole(random)),
        b(shapes::moved(randomWhole(random), randomWholePoint(random, 5))),
        hull_a(hullOf(a)),
        hull_b(hullOf(b)),
        first{&hull_a},
        second{&hull_b, {}, kind, randomWholePoint(random, 12)} {}
  WholePair(const WholePair&) = delete;
  WholePair& operator=(const WholePair&) = delete;

  Points a, b;
  ConvexHull hull_a, hull_b;
  ConvexSet first, second;
};

TEST(ConvexPair, AgreesWithExactArithmeticAboutSmallWholeNumbers) {
  std::array<int, 2> seen{};
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const WholePair pair(random, kKinds[seed % 3]);
    const ConvexSet &first = pair.first, &second = pair.second;
    expectExact(first, pair.a, second, pair.b);
    ++seen[ask(first, second) == Intersection::kDisjoint ? 1 : 0];
  }
  EXPECT_GT(seen[0], 400);
  EXPECT_GT(seen[1], 400);
}

// A placement of whole numbers that turns by a right angle or an angle of the 3-4-5 triangle, mirrors, shears
// or flattens.
Placement randomWholePlacement(Random& random) {
  Placement placement;
  switch (random.below(4)) {
    case 0:
      placement = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
      break;
    case 1:
      placement = {{3, 4, 0}, {-4, 3, 0}, {0, 0, 5}};
      break;
    case 2:
      placement = {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}};
      break;
    default:
      placement = {randomWholePoint(random, 2), randomWholePoint(random, 2), randomWholePoint(random, 2)};
      break;
  }
  placement.origin = randomWholePoint(random, 12);
  return placement;
}

Placement scaledAndMoved(Placement placement, double scale, const Vec3d& by) {
  return {placement.x * scale, placement.y * scale, placement.z * scale, placement.origin * scale + by};
}

TEST(ConvexPair, AgreesWithExactArithmeticAboutPlacedHullsAtAnyScaleAndFarFromTheOrigin) {
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Points a = randomWhole(random), b = randomWhole(random);
    const ConvexHull hull_a = hullOf(a), hull_b = hullOf(b);
    const double scale = std::array{1.0, 0x1p-20, 0x1p20}[random.below(3)];
    const Vec3d by = randomWholePoint(random, 3) * (seed % 2 == 0 ? 1e6 : 0.0);
    const ConvexSet first{&hull_a, scaledAndMoved(randomWholePlacement(random), scale, by)};
    ConvexSet second{&hull_b, scaledAndMoved(randomWholePlacement(random), scale, by), kKinds[seed % 3],
                     randomWholePoint(random, 40) * scale};
    second.eye_or_sweep += second.kind == Kind::kWithEye ? by : Vec3d();
    expectExact(first, a, second, b);
  }
}

// Two sets that touch as the name says, and the vector by which the second is moved away from the first.
struct Touch {
  const char* name;
  Points first, second;
  Vec3d off;
};

std::vector<Touch> touches() {
  const Points cube = shapes::cube();
  const Points needle = shapes::box({-1000, -1, -1}, {1000, 1, 1});
  const Points plate = shapes::box({-1000, -1, -1000}, {1000, 1, 1000});
  const Points square{{-2, 1, -2}, {2, 1, -2}, {2, 1, 2}, {-2, 1, 2}};
  const Points octahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  return {
      {"corner and corner", cube, shapes::moved(cube, {2, 2, 2}), {1, 1, 1}},
      {"corner and face", cube, shapes::moved(octahedron, {0.25, 2, 0.5}), {0, 1, 0}},
      {"edge and edge, crossing",
       shapes::segment({-1, 0, 0}, {1, 0, 0}),
       shapes::segment({0, 0, -1}, {0, 0, 1}),
       {0, 1, 0}},
      {"edge and edge, side by side", cube, shapes::moved(cube, {2, 2, 0}), {1, 1, 0}},
      {"edge and edge, shifted", cube, shapes::moved(cube, {2, 2, 1.5}), {1, 0, 0}},
      {"face and face", cube, shapes::moved(cube, {2, 0, 0}), {1, 0, 0}},
      {"face and face, shifted", cube, shapes::moved(cube, {2, 0.5, -0.75}), {1, 0, 0}},
      {"face and polygon", cube, square, {0, 1, 0}},
      {"face and point", cube, shapes::point({1, 0.5, 0.25}), {1, 0, 0}},
      {"corner and point", cube, shapes::point({1, 1, 1}), {1, 0, 0}},
      {"the same polygon", square, square, {0, 1, 0}},
      {"polygons in one plane, edge to edge", square, shapes::moved(square, {4, 0, 1}), {1, 0, 0}},
      {"polygons in one plane, overlapping", square, shapes::moved(square, {1, 0, 1}), {0, 1, 0}},
      {"the same segment",
       shapes::segment({0, 0, 0}, {1, 2, 3}),
       shapes::segment({0, 0, 0}, {1, 2, 3}),
       {3, 0, -1}},
      {"segments in one line",
       shapes::segment({0, 0, 0}, {1, 2, 3}),
       shapes::segment({1, 2, 3}, {2, 4, 6}),
       {1, 2, 3}},
      {"the same point", shapes::point({1, 2, 3}), shapes::point({1, 2, 3}), {0, 0, 1}},
      {"needles, end to end", needle, shapes::moved(needle, {2000, 0, 0}), {1, 0, 0}},
      {"needles, side by side", needle, shapes::moved(needle, {3, 2, 0}), {0, 1, 0}},
      {"needles, crossing",
       needle,
       shapes::turned(shapes::moved(needle, {0, 0, 2}), {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}),
       {0, 0, 1}},
      {"plates", plate, shapes::moved(plate, {10, 2, 20}), {0, 1, 0}},
      {"balls, pole to pole",
       shapes::toothpick(),
       shapes::moved(shapes::toothpick(), {0, 0.14, 0}),
       {0, 1, 0}},
  };
}

double sizeOf(const Points& points) {
  double size = 0.0;
  for (const Vec3d& p : points) {
    size = std::max(size, length(p - points[0]));
  }
  return size;
}

TEST(ConvexPair, WhatTouchesIsNotDisjointAndWhatIsOffByATenBillionthOfTheSizeIs) {
  Random random(11);
  for (const Touch& touch : touches()) {
    SCOPED_TRACE(touch.name);
    EXPECT_NE(ask(touch.first, touch.second), Intersection::kDisjoint);
    EXPECT_NE(ask(touch.second, touch.first), Intersection::kDisjoint);
    const double size = std::max({sizeOf(touch.first), sizeOf(touch.second), 1.0});
    const Vec3d off = normalized(touch.off) * (1e-10 * size);
    EXPECT_EQ(ask(touch.first, shapes::moved(touch.second, off)), Intersection::kDisjoint);
    const ConvexHull a = hullOf(touch.first), b = hullOf(touch.second);
    for (int i = 0; i < 20; ++i) {
      const shapes::Axes axes = shapes::randomAxes(random);
      const ConvexSet first{&a, {axes.x, axes.y, axes.z, {}}};
      ConvexSet second{&b, {axes.x, axes.y, axes.z, {}}};
      EXPECT_NE(ask(first, second), Intersection::kDisjoint);
      second.placement.origin = axes.turn(off);
      EXPECT_EQ(ask(first, second), Intersection::kDisjoint);
    }
  }
}

// Returns points on the side of the plane z = 0 that `sign` gives. The first few, whose mean is the origin,
// lie in the plane. shallow: other points may be as near to the plane as a billionth of the size.
Points touchingPlane(Random& random, double sign, const Vec3d& stretch, bool shallow) {
  Points points;
  Vec3d mean;
  const int on_plane = random.whole(1, 5);
  for (int i = 0; i < on_plane; ++i) {
    points.emplace_back(random.number(-1, 1) * stretch.x, random.number(-1, 1) * stretch.y, 0.0);
    mean += points.back() / on_plane;
  }
  points = shapes::moved(points, -mean);
  for (int i = random.whole(0, shallow ? 200 : 20); i > 0; --i) {
    const double depth = shallow ? std::pow(10.0, random.number(-9, 0)) : random.number(0, 1);
    points.emplace_back(random.number(-1, 1) * stretch.x, random.number(-1, 1) * stretch.y,
                        sign * depth * stretch.z);
  }
  return points;
}

TEST(ConvexPair, SetsAreFoundDisjointAtADistanceOfATenBillionthOfTheirSize) {
  const std::array<Vec3d, 4> stretches{{{1, 1, 1}, {1, 1e-3, 1e-3}, {1, 1, 1e-3}, {1e-3, 1e-3, 1}}};
  int asked = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(4000u); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Vec3d stretch = stretches[random.below(4)];
    const bool shallow = stretch == stretches[0] && seed % 2 == 0;
    const Vec3d up{0, 0, std::pow(10.0, random.number(-10, seed % 4 == 0 ? -3 : -9))};
    const shapes::Axes axes = shapes::randomAxes(random);
    const Points a = shapes::turned(touchingPlane(random, -1.0, stretch, shallow), axes);
    const Points b = shapes::turned(shapes::moved(touchingPlane(random, 1.0, stretch, shallow), up), axes);
    const ConvexHull hull_a = hullOf(a), hull_b = hullOf(b);
    // Error of farthest() on hulls with sliver faces; 3 is the sum of the axes' components.
    const double missed = 2.0 * (supportError(hull_a, 3.0) + supportError(hull_b, 3.0));
    // An eye or sweep on the second set's side of the plane does not change the result.
    const Vec3d beyond = random.point({-10, -10, seed % 2 == 0 ? 0.0 : 1.0}, {10, 10, 10});
    ConvexSet second{&hull_b, {}, kKinds[seed % 3], axes.turn(beyond)};
    second.eye_or_sweep += second.kind == Kind::kWithEye ? axes.turn(up) : Vec3d();
    if (missed < up.z) {
      EXPECT_EQ(ask(ConvexSet{&hull_a}, second), Intersection::kDisjoint);
      ++asked;
    }
  }
  EXPECT_GT(asked, test::rounds(3500));
}

TEST(ConvexPair, DeepOverlapIsFoundToIntersectNotLeftUndecided) {
  const ConvexHull needle = hullOf(shapes::toothpick()), cube = hullOf(shapes::cube());
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const ConvexHull& hull = seed % 2 == 0 ? needle : cube;
    // Both contain a ball around their centres with a radius slightly below the shortest semi-axis, 0.01 and
    // 1.
    const Vec3d offset = random.direction() * (seed % 2 == 0 ? 0.015 : 1.5) * random.number(0, 1);
    const shapes::Axes axes = shapes::randomAxes(random);
    EXPECT_EQ(ask(ConvexSet{&hull}, ConvexSet{&hull, {axes.x, axes.y, axes.z, offset}}),
              Intersection::kIntersecting);
  }
}

// A moving hull.
struct Mover {
  ConvexSet set;
  Vec3d velocity;
  shapes::Axes turn;

  void step() {
    Placement& p = set.placement;
    p = {turn.turn(p.x), turn.turn(p.y), turn.turn(p.z), p.origin + velocity};
  }
};

Mover randomMover(Random& random, const ConvexHull& hull, Kind kind) {
  const shapes::Axes axes = shapes::randomAxes(random);
  const double angle = random.number(-0.05, 0.05);
  Mover mover{{&hull, {axes.x, axes.y, axes.z, random.direction() * 0.12}}, random.direction() * 0.004};
  mover.turn = {{std::cos(angle), std::sin(angle), 0}, {-std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
  mover.set.kind = kind;
  mover.set.eye_or_sweep = random.direction() * 0.5;
  return mover;
}

TEST(ConvexPair, WhatIsKnownDoesNotChangeDecidedAnswers) {
  const std::array<ConvexHull, 4> hulls{hullOf(shapes::toothpick()), hullOf(shapes::cube({}, 0.05)),
                                        hullOf(shapes::segment({0, -0.1, 0}, {0, 0.1, 0})),
                                        hullOf(shapes::flatPolygon(9, 0.08))};
  int changes = 0, decided = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Random random(seed);
    Mover a = randomMover(random, hulls[random.below(4)], Kind::kHull);
    Mover b = randomMover(random, hulls[random.below(4)], kKinds[seed % 3]);
    PairWitness witness;
    PairCounts counts;
    Intersection last = Intersection::kUndecided;
    for (int frame = 0; frame < 60; ++frame, a.step(), b.step()) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " frame " << frame);
      const Intersection warm = testIntersection(a.set, b.set, witness, counts);
      const Intersection cold = ask(a.set, b.set);
      if (warm != Intersection::kUndecided && cold != Intersection::kUndecided) {
        EXPECT_EQ(warm, cold);
        ++decided;
      }
      changes += warm != last ? 1 : 0;
      last = warm;
    }
  }
  EXPECT_GT(changes, 100);
  EXPECT_GT(decided, 8500);
}

TEST(ConvexPair, StrangeWitnessesDoNoHarm) {
  const double inf = std::numeric_limits<double>::infinity();
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const WholePair pair(random, kKinds[seed % 3]);
    const ConvexSet &first = pair.first, &second = pair.second;
    PairWitness witness;
    witness.disjoint = random.below(2) == 0;
    witness.pairs = static_cast<std::uint8_t>(random.below(256));
    const std::array<Vec3d, 5> directions{
        {{std::nan(""), 0, 0}, {inf, -inf, 1}, {0, 0, 0}, {1e-310, 0, 0}, {1e200, 3, -1e200}}};
    witness.direction = random.below(2) == 0 ? directions[random.below(5)] : random.direction() * 5.0;
    for (std::size_t i = 0; i < 4; ++i) {
      witness.first[i] = random.below(4) == 0 ? PairWitness::kEye : static_cast<std::uint32_t>(random.bits());
      witness.second[i] =
          random.below(4) == 0 ? PairWitness::kEye : static_cast<std::uint32_t>(random.bits());
    }
    PairCounts counts;
    const Intersection answer = testIntersection(first, second, witness, counts);
    EXPECT_EQ(answer == Intersection::kDisjoint, ask(first, second) == Intersection::kDisjoint);
    EXPECT_TRUE(isFinite(witness.direction));
    EXPECT_LE(witness.pairs, 4);
  }
}

TEST(ConvexPair, AskedAgainAPairCostsOneSupportIfDisjointAndNoneIfItIntersects) {
  const ConvexHull hull = hullOf(shapes::toothpick());
  std::array<int, 2> seen{};
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Mover a = randomMover(random, hull, Kind::kHull);
    Mover b = randomMover(random, hull, kKinds[seed % 3]);
    b.set.placement.origin = a.set.placement.origin + random.direction() * random.number(0.0, 0.2);
    PairWitness witness;
    PairCounts counts;
    const Intersection answer = testIntersection(a.set, b.set, witness, counts);
    ASSERT_NE(answer, Intersection::kUndecided);
    counts = {};
    EXPECT_EQ(testIntersection(a.set, b.set, witness, counts), answer);
    EXPECT_EQ(counts.questions, 1u);
    EXPECT_EQ(counts.chung_steps, answer == Intersection::kDisjoint ? 1u : 0u);
    EXPECT_EQ(counts.gjk_steps, 0u);
    ++seen[answer == Intersection::kDisjoint ? 1 : 0];
  }
  EXPECT_GT(seen[0], 50);
  EXPECT_GT(seen[1], 50);
}

TEST(ConvexPair, AnEyeInsideOrOnAHullIntersectsIt) {
  const ConvexHull occluder = hullOf(shapes::cube());
  const ConvexHull away = hullOf(shapes::cube({9, 9, 9}));
  for (const Vec3d& eye :
       {Vec3d{0, 0, 0}, Vec3d{0.5, -0.25, 0.125}, Vec3d{-1, 0, 0}, Vec3d{-1, -1, 0.5}, Vec3d{-1, -1, -1}}) {
    EXPECT_NE(ask(ConvexSet{&occluder}, ConvexSet{&away, {}, Kind::kWithEye, eye}), Intersection::kDisjoint);
  }
}

TEST(ConvexPair, NumbersThatOverflowOrUnderflowDoNotMakeEqualSetsDisjoint) {
  const ConvexHull cube = hullOf(shapes::cube());
  for (const double scale : {1e-310, 1e-300, 1e-160, 1e160, 1e300, 1e308}) {
    const Placement placement{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, {scale, 0, scale}};
    for (const Kind kind : kKinds) {
      const ConvexSet second{&cube, placement, kind, {scale, 3 * scale, 0}};
      EXPECT_NE(ask(ConvexSet{&cube, placement}, second), Intersection::kDisjoint) << scale;
    }
  }
}

TEST(ConvexPair, WhatIsNotFiniteIsUndecidedAtOnce) {
  const ConvexHull cube = hullOf(shapes::cube());
  const ConvexHull none;
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const Kind kind : {Kind::kWithEye, Kind::kSwept}) {
      for (int entry = 0; entry < 15; ++entry) {
        ConvexSet set{&cube, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {50, 0, 0}}, kind, {9, 0, 0}};
        std::array<Vec3d*, 5> vectors{&set.placement.x, &set.placement.y, &set.placement.z,
                                      &set.placement.origin, &set.eye_or_sweep};
        (*vectors[static_cast<std::size_t>(entry) / 3])[entry % 3] = bad;
        PairWitness witness;
        PairCounts counts;
        EXPECT_EQ(testIntersection(set, ConvexSet{&cube}, witness, counts), Intersection::kUndecided)
            << entry;
        EXPECT_EQ(testIntersection(ConvexSet{&cube}, set, witness, counts), Intersection::kUndecided)
            << entry;
        EXPECT_EQ(counts.chung_steps + counts.gjk_steps, 0u);
      }
    }
  }
  EXPECT_EQ(ask(ConvexSet{&none}, ConvexSet{&cube}), Intersection::kUndecided);
  EXPECT_EQ(ask(ConvexSet{&cube}, ConvexSet{}), Intersection::kUndecided);
}

}  // namespace
}  // namespace sightline::layers
