#include "src/layers/pairs/part_occlusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/layers/part_world.h"
#include "tests/support/not_finite.h"

namespace sightline::layers {
namespace {

using shapes::Points;
using shapes::Random;
using test::kInfinity;
using test::kNan;

Placement at(const Vec3d& origin) {
  Placement placement;
  placement.origin = origin;
  return placement;
}

Placement randomPlacement(Random& random, int half) {
  const Placement turned{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {}};
  const Placement mirrored{{0, 0, -2}, {0, 1, 0}, {-1, 0, 0}, {}};
  const Placement sheared{{1, 0, 0}, {1, 1, 0}, {0, -1, 1}, {}};
  const Placement flat{{1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {}};
  const std::vector<Placement> kinds{{}, {}, turned, mirrored, sheared, flat};
  Placement placement = kinds[random.below(static_cast<std::uint32_t>(kinds.size()))];
  placement.origin = shapes::randomGrid(random, 1, half)[0];
  return placement;
}

PartWorld randomWorld(Random& random, std::uint32_t parts) {
  PartWorld world;
  const int spread = random.whole(2, 6);
  for (std::uint32_t part = 0; part < parts; ++part) {
    std::vector<Points> hulls;
    for (std::uint32_t hull = random.below(3) + 1; hull > 0; --hull) {
      const Vec3d centre = shapes::randomGrid(random, 1, 3)[0];
      hulls.push_back(shapes::moved(shapes::randomGrid(random, random.below(6) + 1, 2), centre));
    }
    world.addPart(hulls, randomPlacement(random, spread));
  }
  if (random.below(3) != 0) {
    world.measure();
  }
  return world;
}

void chooseView(Random& random, PartWorld& world) {
  const Vec3d at = shapes::randomGrid(random, 1, 12)[0];
  world.view = random.below(2) == 0 || at == Vec3d() ? viewFrom(at) : viewFromAfar(at);
}

void moveSome(Random& random, PartWorld& world) {
  for (std::uint32_t part = 0; part < world.placed.size(); ++part) {
    if (random.below(2) == 0) {
      Placement placement = world.store.placements[part];
      placement.origin += shapes::randomGrid(random, 1, 2)[0];
      world.place(part, placement);
    }
  }
  if (world.extents.axes() != 0) {
    world.measure();
  }
}

// Small whole coordinates, so that hulls that do not touch are separated by much more than rounding.
TEST(PartOcclusion, AnswersAreTheExactOnes) {
  int arcs = 0, questions = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    PartWorld world = randomWorld(random, 5);
    for (int frame = 0; frame < 3; ++frame) {
      chooseView(random, world);
      moveSome(random, world);
      world.beginFrame(2);
      for (std::uint32_t question = 0; question < 10; ++question) {
        const std::uint32_t front = random.below(5), back = (front + 1 + random.below(4)) % 5;
        const bool expected = world.occludesExactly(front, back);
        ASSERT_EQ(world.occlusion.occludes(front, back), expected)
            << front << " before " << back << ", frame " << frame;
        arcs += expected ? 1 : 0;
        ++questions;
      }
    }
  }
  EXPECT_GT(arcs, questions / 10);
  EXPECT_LT(arcs, questions / 2);
}

// Returns a multiple of 2^-bits in [-size, size].
Vec3d dyadic(Random& random, double size, int bits) {
  const double unit = std::ldexp(1.0, -bits);
  const Vec3d p = random.point({-size, -size, -size}, {size, size, size});
  return {std::round(p.x / unit) * unit, std::round(p.y / unit) * unit, std::round(p.z / unit) * unit};
}

// Numbers with so few bits that points of the world are exact.
Points dyadicBall(Random& random) {
  Points points;
  for (std::uint32_t i = random.below(30) + 1; i > 0; --i) {
    points.push_back(dyadic(random, 1, 10));
  }
  return points;
}

// Exact ties: turned and stretched parts, some far from the origin, of which a vertex of the front part lies
// between the eye and a vertex of the back part, or on that vertex.
TEST(PartOcclusion, AVertexOnTheWayFromAVertexToTheEyeIsAnArc) {
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    PartWorld world;
    const auto placement = [&](double far) {
      return Placement{dyadic(random, 1, 10), dyadic(random, 1, 10), dyadic(random, 1, 10),
                       dyadic(random, far, 18)};
    };
    const double far = random.below(2) == 0 ? 5 : 1e6;
    const std::uint32_t front = world.addPart({dyadicBall(random)}, placement(1));
    const std::uint32_t back = world.addPart({dyadicBall(random)}, placement(far));
    const Points& behind = world.placed[back][0];
    const Vec3d from = behind[random.below(static_cast<std::uint32_t>(behind.size()))];
    const Vec3d way = dyadic(random, 4, 18);
    const Vec3d on_the_way = from + way * (random.below(4) == 0 ? 0.0 : 1.0);
    world.view = random.below(2) == 0 ? viewFrom(from + way * 2.0) : viewFromAfar(way);
    const Points& before = world.placed[front][0];
    const Vec3d vertex = before[random.below(static_cast<std::uint32_t>(before.size()))];
    Placement there = world.store.placements[front];
    there.origin += on_the_way - vertex;
    world.place(front, there);
    ASSERT_NE(std::find(before.begin(), before.end(), on_the_way), before.end()) << "not exact";
    if (random.below(2) == 0) {
      world.measure();
    }
    world.beginFrame();
    ASSERT_TRUE(world.occlusion.occludes(front, back));
    world.beginFrame();
    ASSERT_TRUE(world.occlusion.occludes(front, back)) << "asked again";
  }
}

TEST(PartOcclusion, ListsTheCollisionsOfThePairsThatWereAskedAbout) {
  std::size_t listed = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    PartWorld world = randomWorld(random, 6);
    for (int frame = 0; frame < 2; ++frame) {
      chooseView(random, world);
      moveSome(random, world);
      world.beginFrame();
      EXPECT_TRUE(world.occlusion.collisions().empty());
      std::vector<Arc> intersecting;
      for (std::uint32_t a = 0; a < 6; ++a) {
        for (std::uint32_t b = a + 1; b < 6; ++b) {
          const std::uint32_t ways = random.below(4);  // bit 0: a before b, bit 1: b before a
          if ((ways & 1) != 0) {
            world.occlusion.occludes(a, b);
          }
          if ((ways & 2) != 0) {
            world.occlusion.occludes(b, a);
          }
          if (ways != 0 && world.meetExactly(a, b)) {
            intersecting.push_back({a, b});
          }
        }
      }
      const std::span<const Arc> found = world.occlusion.collisions();
      EXPECT_EQ(std::vector<Arc>(found.begin(), found.end()), intersecting);
      listed += intersecting.size();
    }
  }
  EXPECT_GT(listed, 150u);
}

TEST(PartOcclusion, TouchingPartsOccludeEachOther) {
  PartWorld world;
  const std::uint32_t a = world.addPart({shapes::cube({0, 0, 0})});
  const std::uint32_t b = world.addPart({shapes::cube({2, 2, 2})});  // has a corner in common with a
  for (const View& view : {viewFrom({-9, 3, 20}), viewFromAfar({1, 5, -2})}) {
    world.view = view;
    world.beginFrame();
    EXPECT_TRUE(world.occlusion.occludes(a, b));
    EXPECT_TRUE(world.occlusion.occludes(b, a));
    ASSERT_EQ(world.occlusion.collisions().size(), 1u);
    EXPECT_EQ(world.occlusion.collisions()[0], (Arc{a, b}));
  }
}

TEST(PartOcclusion, ASilhouetteThatTouchesOccludes) {
  PartWorld world;
  const std::uint32_t near = world.addPart({shapes::box({0, 0, 9}, {1, 1, 10})});
  const std::uint32_t far = world.addPart({shapes::box({1, 0, -1}, {2, 1, 0})});
  world.view = viewFromAfar({0, 0, 1});  // the images share the line x = 1
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(near, far));
  EXPECT_FALSE(world.occlusion.occludes(far, near));
  world.view = viewFrom({1, 0, 20});  // the eye is in the plane x = 1
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(near, far));
  EXPECT_FALSE(world.occlusion.occludes(far, near));
}

TEST(PartOcclusion, FromAfarTheNearestEndOfAPartCounts) {
  PartWorld world;
  const std::uint32_t front = world.addPart({shapes::segment({0.5, 0, -3}, {0, 0, 1.9})});
  const std::uint32_t back = world.addPart({shapes::point({0, 0, 0})});
  for (const double length : {1.0, 1e-3, 7.0}) {
    world.view = viewFromAfar({0, 0, length});
    world.beginFrame();
    EXPECT_TRUE(world.occlusion.occludes(front, back)) << length;
    EXPECT_FALSE(world.occlusion.occludes(back, front)) << length;
  }
}

TEST(PartOcclusion, AroundTheEyeAllDirectionsCount) {
  PartWorld world;
  const std::uint32_t behind_near = world.addPart({shapes::cube({0, 0, 5})});
  const std::uint32_t behind_far = world.addPart({shapes::cube({0, 0, 15})});
  const std::uint32_t ahead = world.addPart({shapes::cube({0, 0, -5})});
  world.view = viewFrom({0, 0, 0});  // the view is along -z
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(behind_near, behind_far));
  EXPECT_FALSE(world.occlusion.occludes(behind_far, behind_near));
  EXPECT_FALSE(world.occlusion.occludes(behind_near, ahead));
  EXPECT_FALSE(world.occlusion.occludes(ahead, behind_far));
}

TEST(PartOcclusion, APartWithTheEyeInItOccludesAll) {
  PartWorld world;
  const std::uint32_t around = world.addPart({shapes::cube({0, 0, 0}, 3)});
  const std::uint32_t other = world.addPart({shapes::cube({8, 9, 7})});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(around, other));
  EXPECT_FALSE(world.occlusion.occludes(other, around));
}

TEST(PartOcclusion, WhatIsNotFiniteOccludesAndIsOccluded) {
  PartWorld world;
  const std::uint32_t a = world.addPart({shapes::cube({0, 0, 5})});
  const std::uint32_t b = world.addPart({shapes::cube({50, 0, 0})});
  const std::uint32_t lost = world.addPart({shapes::cube()}, at({kNan, 0, 0}));
  world.store.finite[lost] = 0;
  world.rules.set(a, lost, PairPlane{{{0, 0, 1}, 100}});
  world.beginFrame();
  EXPECT_FALSE(world.occlusion.occludes(a, b));
  for (const std::uint32_t part : {a, b}) {
    EXPECT_TRUE(world.occlusion.occludes(part, lost));
    EXPECT_TRUE(world.occlusion.occludes(lost, part));
  }
  for (View view : {viewFrom({0, kInfinity, 0}), viewFrom({kNan, 0, 0}), viewFromAfar({0, 0, kNan}),
                    viewFromAfar({0, 0, 0})}) {
    world.view = view;
    world.beginFrame();
    EXPECT_TRUE(world.occlusion.occludes(a, b));
    EXPECT_TRUE(world.occlusion.occludes(b, a));
  }
}

TEST(PartOcclusion, OverflowOccludes) {
  PartWorld world;
  Placement huge{{1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}, {}};
  const std::uint32_t a = world.addPart({shapes::cube()}, huge);
  const std::uint32_t b = world.addPart({shapes::cube({0, 0, 1e8})});
  for (const View& view : {viewFrom({0, 0, 1e9}), viewFromAfar({0, 0, 1})}) {
    world.view = view;
    world.beginFrame();
    EXPECT_TRUE(world.occlusion.occludes(a, b));
    EXPECT_TRUE(world.occlusion.occludes(b, a));
  }
}

// Two boxes on both sides of the plane x = 0 that overlap by 1; the eye is on the first box's side.
struct Overlapping : PartWorld {
  std::uint32_t left = addPart({shapes::box({-9, -1, -1}, {1, 1, 1})});
  std::uint32_t right = addPart({shapes::box({-1, -1, -1}, {9, 1, 1})});
  Overlapping() { view = viewFrom({-20, 0, 0}); }
};
constexpr Vec3d kLeft{-1, 0, 0};

TEST(PartOcclusion, APlaneRuleLeavesOneArcOfTwoPartsThatIntersect) {
  Overlapping world;
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right));
  EXPECT_TRUE(world.occlusion.occludes(world.right, world.left));
  world.rules.set(world.left, world.right, PairPlane{{kLeft, 0}});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right));
  EXPECT_FALSE(world.occlusion.occludes(world.right, world.left));
  EXPECT_TRUE(world.occlusion.collisions().empty()) << "pairs with a rule are not looked at";
  world.rules.set(world.right, world.left, PairPlane{{-kLeft, 0}});  // the same rule with the parts exchanged
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right));
  EXPECT_FALSE(world.occlusion.occludes(world.right, world.left));
  world.view = viewFrom({20, 0, 0});
  world.beginFrame();
  EXPECT_FALSE(world.occlusion.occludes(world.left, world.right));
  EXPECT_TRUE(world.occlusion.occludes(world.right, world.left));
  world.rules.clear(world.left, world.right);
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right));
}

TEST(PartOcclusion, APlaneMovesWithTheFirstPart) {
  Overlapping world;
  world.rules.set(world.left, world.right, PairPlane{{kLeft, 0}});
  const Vec3d to{100, 0, 0};
  world.place(world.left, at(to));
  world.place(world.right, at(to));
  world.view = viewFrom({80, 0, 0});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right));
  EXPECT_FALSE(world.occlusion.occludes(world.right, world.left));
  const Placement turned{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, to};  // half a turn exchanges left and right
  world.place(world.left, turned);
  world.place(world.right, turned);
  world.beginFrame();
  EXPECT_FALSE(world.occlusion.occludes(world.left, world.right));
  EXPECT_TRUE(world.occlusion.occludes(world.right, world.left));
}

TEST(PartOcclusion, ARuleOnlyRemovesArcs) {
  PartWorld world;
  const std::uint32_t left = world.addPart({shapes::cube({-5, 0, 0})});
  const std::uint32_t right = world.addPart({shapes::cube({5, 0, 0})});
  world.rules.set(left, right, PairPlane{{kLeft, 0}});
  world.view = viewFrom({-5, 0, 50});  // the eye sees them side by side
  world.beginFrame();
  EXPECT_FALSE(world.occlusion.occludes(left, right));
  EXPECT_FALSE(world.occlusion.occludes(right, left));
}

PairOrder countAndForbid(void* user, const View& view) {
  ++*static_cast<int*>(user);
  return {view.eye.x > 0, false};
}

TEST(PartOcclusion, ACallbackIsAskedOnceAFrameAndPair) {
  Overlapping world;
  int calls = 0;
  world.rules.set(world.right, world.left, PairCallback{countAndForbid, &calls});
  world.beginFrame();
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(world.occlusion.occludes(world.left, world.right));
    EXPECT_FALSE(world.occlusion.occludes(world.right, world.left)) << "the eye's x is -20";
  }
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(world.occlusion.pairQueries(), 0u);
  world.view = viewFrom({20, 0, 0});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.right, world.left));
  EXPECT_EQ(calls, 2);
  world.rules.set(world.right, world.left, PairCallback{});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.left, world.right)) << "nobody to ask";
  EXPECT_TRUE(world.occlusion.occludes(world.right, world.left));
}

// The boxes of a sphere around 0 and of a cylinder along y, which intersect.
TEST(PartOcclusion, AJointLeavesOneArcFromMostEyes) {
  PartWorld world;
  const std::uint32_t sphere = world.addPart({shapes::cube({0, 0, 0}, 5)});
  const std::uint32_t cylinder = world.addPart({shapes::box({-3, 4, -3}, {3, 30, 3})});
  SphereCylinderJoint joint;
  joint.sphere_radius = 5;
  joint.cylinder_radius = 3;
  world.rules.set(sphere, cylinder, joint);
  world.view = viewFrom({20, 20, 0});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(cylinder, sphere));
  EXPECT_FALSE(world.occlusion.occludes(sphere, cylinder));
  world.view = viewFrom({0, -20, 0});
  world.beginFrame();
  EXPECT_FALSE(world.occlusion.occludes(cylinder, sphere));
  EXPECT_TRUE(world.occlusion.occludes(sphere, cylinder));
  world.view = viewFrom({20, 0, 0});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(cylinder, sphere));
  EXPECT_TRUE(world.occlusion.occludes(sphere, cylinder));
}

// A placed shell of half size 8 with a front and a back.
struct Container : PartWorld {
  std::uint32_t front = 0, back = 0;
  explicit Container(const Placement& placement = {}, const Points& shape = shapes::cube({0, 0, 0}, 8)) {
    const std::uint32_t hull = addHull(shape);
    front = addPart(std::vector{hull}, placement);
    back = addPart(std::vector{hull}, placement);
    rules.setContainer(front, back);
  }
  // Returns the answers for all ordered pairs of the shell's parts and another part.
  void expectBetween(std::uint32_t part) {
    EXPECT_TRUE(occlusion.occludes(front, part));
    EXPECT_FALSE(occlusion.occludes(part, front));
    EXPECT_TRUE(occlusion.occludes(part, back));
    EXPECT_FALSE(occlusion.occludes(back, part));
  }
  void expectTangled(std::uint32_t part) {
    for (const std::uint32_t shell : {front, back}) {
      EXPECT_TRUE(occlusion.occludes(shell, part));
      EXPECT_TRUE(occlusion.occludes(part, shell));
    }
  }
};

TEST(PartContainer, FrontOccludesBackAndNotTheReverse) {
  Container world;
  for (const View& view : {viewFrom({0, 0, 50}), viewFrom({0, 0, 0}), viewFromAfar({0, 1, 0})}) {
    world.view = view;
    world.beginFrame();
    EXPECT_TRUE(world.occlusion.occludes(world.front, world.back));
    EXPECT_FALSE(world.occlusion.occludes(world.back, world.front));
    EXPECT_TRUE(world.occlusion.collisions().empty());
  }
}

TEST(PartContainer, ContentLiesBetweenItsFrontAndBack) {
  const Placement mirrored{{0, 2, 0}, {1, 1, 0}, {0, 0, 3}, {70, -40, 5}};
  for (const Placement& placement : {Placement{}, at({100, 200, 300}), mirrored}) {
    Container world(placement);
    const std::uint32_t content = world.addPart(
        {shapes::cube({0, 0, 0}, 2), shapes::cube({5, 5, 5}, 2), shapes::point({-7, 7, -7})}, placement);
    world.measure();
    for (const View& view : {viewFrom({1000, 20, 50}), viewFrom(placement.point({4, -4, 2})),
                             viewFromAfar({3, 1, -2}), viewFrom(placement.point({8, 3, 3}))}) {
      world.view = view;
      world.beginFrame();
      world.expectBetween(content);
    }
  }
}

// Unlike a cube, a tetrahedron changes when it is mirrored, which would turn its faces inside out.
TEST(PartContainer, AMirroredShellHoldsWhatLiesInItsCorner) {
  for (const double side : {1.0, -1.0}) {
    const Placement placement{{side, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
    Container world(placement, shapes::tetrahedron({0, 0, 0}, 8));
    const std::uint32_t content = world.addPart({shapes::cube({5, 5, 5}, 0.5)}, placement);
    world.view = viewFrom({40, 50, 60});
    world.beginFrame();
    world.expectBetween(content);
  }
}

TEST(PartContainer, WhatReachesThroughOrTouchesTheShellIsTangledWithIt) {
  Container world;
  const std::uint32_t through = world.addPart({shapes::cube({8, 0, 0}, 2)});
  const std::uint32_t touching = world.addPart({shapes::cube({0, 6, 0}, 2)});
  const std::uint32_t half_out = world.addPart({shapes::cube(), shapes::cube({20, 0, 0})});
  const std::uint32_t nearly = world.addPart({shapes::cube({0, 0, 0}, 8 - 1e-13)});
  for (const View& view : {viewFrom({50, 20, 50}), viewFromAfar({3, 1, -2})}) {
    world.view = view;
    world.beginFrame();
    for (const std::uint32_t part : {through, touching, half_out, nearly}) {
      SCOPED_TRACE(part);
      world.expectTangled(part);
    }
  }
}

TEST(PartContainer, FarFromTheOriginContentMustBeClearByMoreThanRounding) {
  const Placement there = at({1e6, -1e6, 1e6});
  Container world(there);
  const std::uint32_t close = world.addPart({shapes::cube({0, 0, 0}, 8 - 1e-9)}, there);
  const std::uint32_t clear = world.addPart({shapes::cube({0, 0, 0}, 8 - 1e-3)}, there);
  world.beginFrame();
  world.expectTangled(close);
  world.expectBetween(clear);
}

TEST(PartContainer, WhatLiesOutsideIsSortedAsUsual) {
  Container world;
  const std::uint32_t outside = world.addPart({shapes::cube({0, 0, 20}, 2)});
  world.view = viewFrom({0, 0, 50});
  world.beginFrame();
  for (const std::uint32_t shell : {world.front, world.back}) {
    EXPECT_TRUE(world.occlusion.occludes(outside, shell));
    EXPECT_FALSE(world.occlusion.occludes(shell, outside));
  }
}

TEST(PartContainer, TwoContentsAreSortedAsUsual) {
  Container world;
  const std::uint32_t near = world.addPart({shapes::cube({0, 0, 4})});
  const std::uint32_t far = world.addPart({shapes::cube({0, 0, -4})});
  world.view = viewFrom({0, 0, 50});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(near, far));
  EXPECT_FALSE(world.occlusion.occludes(far, near));
}

TEST(PartContainer, ContainersLieInContainers) {
  Container world;
  const std::uint32_t hull = world.addHull(shapes::cube({0, 0, 0}, 4));
  const std::uint32_t inner_front = world.addPart(std::vector{hull});
  const std::uint32_t inner_back = world.addPart(std::vector{hull});
  world.rules.setContainer(inner_front, inner_back);
  const std::uint32_t content = world.addPart({shapes::cube()});
  const std::vector<std::uint32_t> order{world.front, inner_front, content, inner_back, world.back};
  world.view = viewFrom({30, 40, 50});
  world.beginFrame();
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      EXPECT_TRUE(world.occlusion.occludes(order[i], order[j])) << i << ' ' << j;
      EXPECT_FALSE(world.occlusion.occludes(order[j], order[i])) << i << ' ' << j;
    }
  }
}

TEST(PartContainer, PartsThatAreNotOneSurfaceAreSortedAsUsual) {
  Container world;
  const std::uint32_t content = world.addPart({shapes::cube()});
  world.place(world.back, at({1, 0, 0}));
  world.view = viewFrom({30, 40, 50});
  world.beginFrame();
  EXPECT_TRUE(world.occlusion.occludes(world.front, world.back));
  EXPECT_TRUE(world.occlusion.occludes(world.back, world.front));
  world.expectTangled(content);
}

TEST(PartOcclusion, KnownPairsExpire) {
  PartWorld world;
  const std::uint32_t a = world.addPart({shapes::cube({0, 0, 5})});
  const std::uint32_t b = world.addPart({shapes::cube({0, 0, 15})});
  for (const std::uint32_t expiry : {0u, 1u, 3u}) {
    world.beginFrame(expiry);
    EXPECT_EQ(world.occlusion.knownPairs(), 0u);
    world.occlusion.occludes(a, b);
    const std::size_t known = world.occlusion.knownPairs();
    EXPECT_GT(known, 0u);
    for (std::uint32_t frame = 0; frame < expiry; ++frame) {
      world.beginFrame(expiry);
      EXPECT_EQ(world.occlusion.knownPairs(), known);
    }
    world.beginFrame(expiry);
    EXPECT_EQ(world.occlusion.knownPairs(), 0u);
  }
}

TEST(PartOcclusion, AskingAgainCostsAtMostAStepAQuestion) {
  PartWorld world;
  Random random(5);
  const std::uint32_t a = world.addPart({shapes::randomBall(random, 100, {0, 0, 5})});
  const std::uint32_t b = world.addPart({shapes::randomBall(random, 100, {1.5, 0.3, 15})});
  world.view = viewFrom({9, 1, 0});
  world.beginFrame();
  const bool answer = world.occlusion.occludes(a, b);
  world.beginFrame();
  EXPECT_EQ(world.occlusion.occludes(a, b), answer);
  const PairCounts& counts = world.occlusion.counts();
  EXPECT_GT(counts.questions, 0u);
  EXPECT_LE(counts.chung_steps + counts.gjk_steps, counts.questions);
}

TEST(PartOcclusion, AskingTwiceInAFrameTestsOnce) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    PartWorld world;
    const std::uint32_t a = world.addPart({shapes::randomGrid(random, 20, 3), shapes::cube({4, 0, 0})});
    const std::uint32_t b = world.addPart({shapes::randomGrid(random, 20, 3), shapes::cube({0, 0, 9})});
    world.view = seed % 2 == 0 ? viewFrom(random.direction() * 8.0) : viewFromAfar(random.direction());
    world.measure();
    world.beginFrame();
    const bool first = world.occlusion.occludes(a, b), reverse = world.occlusion.occludes(b, a);
    const std::uint64_t questions = world.occlusion.counts().questions;
    EXPECT_EQ(world.occlusion.occludes(a, b), first) << "seed " << seed;
    EXPECT_EQ(world.occlusion.occludes(b, a), reverse) << "seed " << seed;
    EXPECT_EQ(world.occlusion.counts().questions, questions) << "seed " << seed;
  }
}

TEST(PartOcclusion, CountsBeginAnewWithEachFrame) {
  PartWorld world;
  const std::uint32_t a = world.addPart({shapes::cube({0, 0, 5})});
  const std::uint32_t b = world.addPart({shapes::cube({0, 0, 15})});
  world.beginFrame();
  world.occlusion.occludes(a, b);
  world.occlusion.occludes(b, a);
  EXPECT_EQ(world.occlusion.pairQueries(), 2u);
  EXPECT_GT(world.occlusion.counts().questions, 0u);
  world.beginFrame();
  EXPECT_EQ(world.occlusion.pairQueries(), 0u);
  EXPECT_EQ(world.occlusion.counts().questions, 0u);
}

}  // namespace
}  // namespace sightline::layers
