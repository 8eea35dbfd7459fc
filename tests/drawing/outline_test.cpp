// Outlines of objects: the union of drawn triangles on the page.

#include "src/drawing/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/drawing/outline_chain.h"
#include "src/drawing/outline_union.h"
#include "tests/drawing/page_geometry.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/solids.h"

namespace sightline::drawing {
namespace {

using shapes::Random;
using test::areaOf;
using test::distanceTo;
using test::isInside;
using test::viewFromFront;

constexpr double kHeight = 400.0;

struct OneObject {
  Scene scene;

  explicit OneObject(bool double_sided = false) {
    scene.materials.push_back({.name = "m", .double_sided = double_sided});
    scene.objects.push_back({.material = MaterialId{0u}});
  }
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    for (const Vec3f& p : {a, b, c}) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.push_back(p);
    }
    scene.objects[0].index_count = static_cast<std::uint32_t>(scene.indices.size());
  }
  void add(const test::Solid& solid) {
    for (std::size_t face = 0; face < solid.faces.size(); ++face) {
      const std::vector<Vec3f> corners = solid.polygon(face);
      for (std::size_t i = 2; i < corners.size(); ++i) {
        add(corners[0], corners[i - 1], corners[i]);
      }
    }
  }
  // Adds a square across z around its middle, with its front or its back towards the viewer.
  void addSquare(const Vec3f& at, float half, bool front = true) {
    const Vec3f a(at.x - half, at.y - half, at.z), b(at.x + half, at.y - half, at.z),
        c(at.x + half, at.y + half, at.z), d(at.x - half, at.y + half, at.z);
    front ? add(a, b, c) : add(a, c, b);
    front ? add(a, c, d) : add(a, d, c);
  }
  std::vector<PagePath> outline(const View& view, double page_height = kHeight) const {
    Outliner outliner;
    EXPECT_TRUE(isDrawable(view, page_height));
    outliner.setView(view, page_height);
    std::vector<GridPath> on_grid;
    outliner.outline(scene.view(), ObjectId{0u}, on_grid);
    std::vector<PagePath> rings;
    outliner.toPage(on_grid, rings);
    return rings;
  }
};

// Whether the ray through a point of the page intersects a drawn triangle between near and far.
bool raySees(const SceneView& scene, const View& view, const PagePoint& p, double page_height) {
  const double half = view.orthographic ? view.ortho_height * 0.5 : view.tan_half_fovy;
  const double x = (p.x / page_height * 2.0 - view.aspect + view.shift_x * view.aspect) * half;
  const double y = (1.0 - p.y / page_height * 2.0 + view.shift_y) * half;
  const Vec3d across = view.right * x + view.up * y;
  const Vec3d from = view.orthographic ? view.eye + across : view.eye;
  const Vec3d along = view.orthographic ? view.forward : view.forward + across;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const Vec3d a(scene.positions[scene.indices[i]]), b(scene.positions[scene.indices[i + 1]]),
        c(scene.positions[scene.indices[i + 2]]);
    const Vec3d normal = cross(b - a, c - a);
    const double slope = dot(normal, along);
    if (slope == 0.0 || (slope > 0.0 && !scene.materials[0].double_sided)) {
      continue;
    }
    const double t = dot(normal, a - from) / slope;  // depth: along has depth 1
    const Vec3d hit = from + along * t;
    const auto isLeft = [&](const Vec3d& s, const Vec3d& e) {
      return dot(cross(e - s, hit - s), normal) >= 0;
    };
    if (t >= view.z_near && t <= view.z_far && isLeft(a, b) && isLeft(b, c) && isLeft(c, a)) {
      return true;
    }
  }
  return false;
}

// Points nearer to the outline than rounding may move it are not checked.
void expectCoversWhatRaysSee(const OneObject& object, const View& view, std::uint64_t seed,
                             int points = 400) {
  const std::vector<PagePath> rings = object.outline(view);
  Random random(seed);
  int seen = 0;
  for (int i = 0; i < points; ++i) {
    const PagePoint p{random.number(0, kHeight * view.aspect), random.number(0, kHeight)};
    if (distanceTo(rings, p, true) < 0.01) {
      continue;
    }
    const bool expected = raySees(object.scene.view(), view, p, kHeight);
    seen += expected ? 1 : 0;
    ASSERT_EQ(isInside(rings, p), expected) << "seed " << seed << ", point " << p.x << ", " << p.y;
  }
  EXPECT_GT(seen, 0) << "seed " << seed;
}

TEST(Outline, OfASquareIsTheSquare) {
  OneObject object;
  object.addSquare({1, 2, 0}, 1);
  for (const bool orthographic : {false, true}) {
    const std::vector<PagePath> rings = object.outline(viewFromFront(orthographic));
    ASSERT_EQ(rings.size(), 1u);
    ASSERT_EQ(rings[0].size(), 4u);
    // Both views show 10 m at the square's depth: 40 units a metre.
    for (const PagePoint& corner :
         {PagePoint{200, 80}, PagePoint{280, 80}, PagePoint{280, 160}, PagePoint{200, 160}}) {
      EXPECT_EQ(std::count(rings[0].begin(), rings[0].end(), corner), 1) << corner.x << ", " << corner.y;
    }
  }
}

TEST(Outline, LeavesOutBacksUnlessTheyAreDrawn) {
  for (const bool double_sided : {false, true}) {
    OneObject object(double_sided);
    object.addSquare({0, 0, 0}, 1, false);
    EXPECT_EQ(object.outline(viewFromFront()).size(), double_sided ? 1u : 0u);
  }
}

// The picture of a left-handed view is mirrored, and fronts stay fronts.
TEST(Outline, OfALeftHandedViewIsTheMirroredOne) {
  for (const bool orthographic : {false, true}) {
    for (const bool front : {false, true}) {
      for (const bool double_sided : {false, true}) {
        OneObject object(double_sided);
        object.addSquare({1, 2, 0}, 1, front);
        View view = viewFromFront(orthographic);
        std::vector<PagePath> rings = object.outline(view);
        ASSERT_EQ(rings.size(), front || double_sided ? 1u : 0u);
        view.right = -view.right;
        const std::vector<PagePath> mirrored = object.outline(view);
        ASSERT_EQ(mirrored.size(), rings.size());
        for (std::size_t i = 0; i < rings.size(); ++i) {
          EXPECT_EQ(areaOf(mirrored[i]), areaOf(rings[i]));
          for (const PagePoint& p : rings[i]) {
            const PagePoint there{kHeight * view.aspect - p.x, p.y};
            EXPECT_EQ(std::count(mirrored[i].begin(), mirrored[i].end(), there), 1);
          }
        }
      }
    }
  }
}

TEST(Outline, HasHoles) {
  OneObject object;
  // A frame of four bars round a hole of 2 m, with corners that do not match.
  for (const auto& [low, high] :
       {std::pair(Vec3f(-2, -2, 0), Vec3f(2, -1, 0)), std::pair(Vec3f(-2, 1, 0), Vec3f(2, 2, 0)),
        std::pair(Vec3f(-2, -1, 0), Vec3f(-1, 1, 0)), std::pair(Vec3f(1, -1, 0), Vec3f(2, 1, 0))}) {
    const Vec3f b(high.x, low.y, 0), d(low.x, high.y, 0);
    object.add(low, b, high);
    object.add(low, high, d);
  }
  const std::vector<PagePath> rings = object.outline(viewFromFront());
  ASSERT_EQ(rings.size(), 2u);
  const double first = std::abs(areaOf(rings[0])), second = std::abs(areaOf(rings[1]));
  EXPECT_NEAR(std::max(first, second), 160.0 * 160.0, 1e-6);
  EXPECT_NEAR(std::min(first, second), 80.0 * 80.0, 1e-6);
}

TEST(Outline, OfManyTrianglesCoversWhatRaysSee) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    OneObject object(seed % 2 == 0);
    for (int i = 0; i < 30; ++i) {
      const Vec3d at = random.point({-4, -4, -4}, {4, 4, 4});
      const auto corner = [&] { return Vec3f(at + random.point({-2, -2, -2}, {2, 2, 2})); };
      const Vec3f a = corner(), b = corner(), c = corner();
      object.add(a, b, c);
    }
    expectCoversWhatRaysSee(object, viewFromFront(seed % 3 == 0), seed);
  }
}

TEST(Outline, OfClosedSolidsFromAnywhereCoversWhatRaysSee) {
  const std::vector<test::Solid> solids{test::block({-1, -2, -1}, {2, 1, 1}), test::octahedron(),
                                        test::prism(7), test::lShape(),
                                        test::dicedBlock({-1, -1, -1}, {1, 1, 1}, 5)};
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    Random random(seed);
    OneObject object;
    object.add(solids[seed % solids.size()]);
    View view = viewFromFront(seed % 4 == 0);
    view.eye = random.direction() * random.number(4, 9);
    view.ortho_height = 8.0;
    view.aspect = random.number(0.5, 2.0);
    setOrientation(view, -view.eye + random.point({-1, -1, -1}, {1, 1, 1}), {0, 1, 0});
    if (seed % 2 == 0) {
      view.shift_x = random.number(-1, 1);
      view.shift_y = random.number(-1, 1);
    }
    expectCoversWhatRaysSee(object, view, seed);
  }
}

TEST(Outline, IsCutAtTheNearPlaneAndAtThePageBorders) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    OneObject object(true);
    for (int i = 0; i < 12; ++i) {
      const auto corner = [&] { return Vec3f(random.point({-30, -30, -5}, {30, 30, 15})); };
      const Vec3f a = corner(), b = corner(), c = corner();
      object.add(a, b, c);
    }
    const View view = viewFromFront(seed % 2 == 0);
    expectCoversWhatRaysSee(object, view, seed);
    const double margin = kHeight * Outliner::kMargin + 1e-3;
    for (const PagePath& ring : object.outline(view)) {
      for (const PagePoint& p : ring) {
        ASSERT_TRUE(p.x >= -margin && p.x <= kHeight + margin && p.y >= -margin && p.y <= kHeight + margin)
            << "seed " << seed << ": " << p.x << ", " << p.y;
      }
    }
  }
}

TEST(Outline, IsOnThePageWhereTheNearPlaneIsNearerThanRoundingTells) {
  OneObject square(true);
  square.addSquare({2, 0, 0}, 1);
  OneObject both = square;
  both.add({0, 0, 12}, {0, 0, 8}, {1, 1, 8});  // one side goes through the eye: it is seen edge on
  View view = viewFromFront();
  view.z_near = 1e-300;
  EXPECT_EQ(both.outline(view), square.outline(view));
}

TEST(Outline, EndsAtTheFarPlane) {
  OneObject object(true);
  object.addSquare({0, 0, -95}, 5);
  View view = viewFromFront();
  EXPECT_EQ(object.outline(view).size(), 0u);
  view.z_far = 110.0;
  EXPECT_EQ(object.outline(view).size(), 1u);
}

TEST(Outline, ReachesBeyondTheBordersOfThePage) {
  OneObject object;
  object.addSquare({0, 0, 0}, 50);
  const std::vector<PagePath> rings = object.outline(viewFromFront());
  ASSERT_EQ(rings.size(), 1u);
  const auto [low, high] = std::minmax_element(
      rings[0].begin(), rings[0].end(), [](const PagePoint& a, const PagePoint& b) { return a.x < b.x; });
  EXPECT_NEAR(low->x, -kHeight * Outliner::kMargin, 1e-3);
  EXPECT_NEAR(high->x, kHeight * (1.0 + Outliner::kMargin), 1e-3);
}

TEST(Outline, DropsSliversThatRoundingLeaves) {
  OneObject object;
  object.addSquare({0, 0, 0}, 1);
  // A needle of 200 units and a thousandth of a unit beside it, and a speck.
  object.add({-2, 2, 0}, {3, 2, 0}, {3, 2.00005f, 0});
  object.addSquare({3, -3, 0}, 0.00002f);
  EXPECT_EQ(object.outline(viewFromFront()).size(), 1u);
}

// The mean width of all is that of a sliver.
TEST(OutlineUnion, AWidePieceThatHangsOnALongSliverIsKept) {
  std::vector<GridPath> needle{{{0, 0}, {10'000'000, 0}, {10'000'000, 1}, {0, 1}}};
  std::vector<GridPath> needle_with_block{
      {{0, 0}, {10'000'000, 0}, {10'000'000, 1}, {1000, 1}, {1000, 1000}, {0, 1000}}};
  std::vector<GridPath> hole{{{-10, -10}, {20'000'000, -10}, {20'000'000, 20'000'000}, {-10, 20'000'000}},
                             {{0, 0}, {0, 1000}, {1000, 1000}, {1000, 1}, {10'000'000, 1}, {10'000'000, 0}}};
  uniteLoops(needle, 4.0);
  EXPECT_TRUE(needle.empty());
  uniteLoops(needle_with_block, 4.0);
  EXPECT_EQ(needle_with_block.size(), 1u);
  uniteLoops(hole, 4.0);
  EXPECT_EQ(hole.size(), 2u);
}

TEST(Outline, KeepsAThousandthOfAUnitOnPagesOfAnySize) {
  OneObject object;
  object.addSquare({0.3f, 0.1f, 0}, 1);
  object.addSquare({1.1f, 0.7f, -1}, 1);  // a union of two
  const std::vector<PagePath> expected = object.outline(viewFromFront());
  ASSERT_EQ(expected.size(), 1u);
  for (const double height : {1e-12, 1e-3, 1.0, 720.0, 1e5, 1e7, 1e12, 1e15}) {
    const std::vector<PagePath> rings = object.outline(viewFromFront(), height);
    ASSERT_EQ(rings.size(), 1u) << height;
    ASSERT_EQ(rings[0].size(), expected[0].size()) << height;
    // Beyond 1e11 units, single precision ends before thousandths do.
    const double allowed = std::max(std::min(1e-3, height * 1e-6), height * 1e-14);
    for (const PagePoint& p : rings[0]) {
      double least = 1e300;
      for (const PagePoint& q : expected[0]) {
        least = std::min(least, std::hypot(p.x - q.x * height / kHeight, p.y - q.y * height / kHeight));
      }
      // Corners of `expected` are themselves rounded.
      EXPECT_LE(least, allowed + 1e-3 * height / kHeight) << height;
    }
  }
}

TEST(Outline, OfTrianglesThatAreNotFiniteIsThatOfTheOthers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  OneObject object(true);
  object.addSquare({0, 0, 0}, 1);
  object.add({0, 0, 0}, {kNan, 1, 1}, {1, 2, 0});
  object.add({0, 0, 0}, {3, kInf, 1}, {1, 2, 0});
  object.add({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(object.outline(viewFromFront()).size(), 1u);
  OneObject huge = object;
  object.add({-1e8f, -1e8f, 5}, {1e8f, -1e8f, 5}, {0, 1e8f, 5});
  const std::vector<PagePath> rings = object.outline(viewFromFront());
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_GE(std::abs(areaOf(rings[0])), kHeight * kHeight);
  // Beyond what double precision can cut: any outline, on the page.
  huge.add({-3e38f, -3e38f, 5}, {3e38f, -3e38f, 5}, {0, 3e38f, 5});
  for (const PagePath& ring : huge.outline(viewFromFront())) {
    for (const PagePoint& p : ring) {
      EXPECT_TRUE(std::abs(p.x) < 2 * kHeight && std::abs(p.y) < 2 * kHeight) << p.x << ", " << p.y;
    }
  }
}

TEST(Outline, OfNoTriangleIsEmpty) {
  EXPECT_TRUE(OneObject().outline(viewFromFront()).empty());
}

TEST(Outline, RefusesPagesAndViewsWithoutSize) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const View view = viewFromFront();
  for (const double height : {0.0, -1.0, kNan, 1e-20, 1e20, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(isDrawable(view, height)) << height;
  }
  for (const auto change : {+[](View& v) { v.aspect = 0; }, +[](View& v) { v.aspect = kNan; },
                            +[](View& v) { v.tan_half_fovy = kNan; }, +[](View& v) { v.z_near = -1; },
                            +[](View& v) { v.z_far = v.z_near; }, +[](View& v) { v.eye.x = kNan; },
                            +[](View& v) { v.up = {}; }}) {
    View changed = view;
    change(changed);
    EXPECT_FALSE(isDrawable(changed, kHeight));
  }
  for (const bool orthographic : {false, true}) {
    View from_the_eye = viewFromFront(orthographic);
    from_the_eye.z_near = 0.0;
    EXPECT_TRUE(isDrawable(from_the_eye, kHeight));
  }
}

// The winding number at a point, counted by crossings to its right.
int windingOf(const std::vector<GridPath>& rings, double x, double y) {
  int winding = 0;
  for (const GridPath& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const GridPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const auto ax = static_cast<double>(a.x), ay = static_cast<double>(a.y);
      const auto bx = static_cast<double>(b.x), by = static_cast<double>(b.y);
      if ((ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)) {
        winding += by > ay ? 1 : -1;
      }
    }
  }
  return winding;
}

TEST(OutlineChain, LoopsCountHowManyRingsCoverAPoint) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    OutlineChain chain;
    std::vector<GridPath> rings;
    for (int i = 0; i < 40; ++i) {
      // Few places, so that many edges are shared.
      const auto corner = [&] { return GridPoint{random.whole(0, 4), random.whole(0, 4)}; };
      GridPath ring{corner(), corner(), corner()};
      const int turn = orientationOf(ring);
      if (turn == 0) {
        continue;
      }
      if (turn < 0) {
        std::swap(ring[1], ring[2]);
      }
      chain.add(ring);
      rings.push_back(ring);
    }
    std::vector<GridPath> loops;
    chain.takeLoops(loops);
    for (int i = 0; i < 100; ++i) {
      const double x = random.number(-1, 5), y = random.number(-1, 5);
      ASSERT_EQ(windingOf(loops, x, y), windingOf(rings, x, y)) << "seed " << seed;
    }
  }
}

TEST(OutlineChain, OfAMeshIsItsBorderAlone) {
  OutlineChain chain;
  for (std::int64_t y = 0; y < 10; ++y) {
    for (std::int64_t x = 0; x < 10; ++x) {
      chain.add(GridPath{{x, y}, {x + 1, y}, {x + 1, y + 1}});
      chain.add(GridPath{{x, y}, {x + 1, y + 1}, {x, y + 1}});
    }
  }
  std::vector<GridPath> loops;
  chain.takeLoops(loops);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
  EXPECT_TRUE(isConvexRing(loops[0]));
}

TEST(OutlineChain, TurnsOfLargeCoordinatesAreExact) {
  constexpr std::int64_t kFar = std::int64_t{1} << 60;
  EXPECT_EQ(turnOf({-kFar, -kFar}, {0, 0}, {kFar, kFar + 1}), 1);
  EXPECT_EQ(turnOf({-kFar, -kFar}, {0, 0}, {kFar, kFar}), 0);
  EXPECT_EQ(turnOf({-kFar, -kFar}, {0, 0}, {kFar, kFar - 1}), -1);
}

TEST(OutlineUnion, AStarIsNotConvexThoughItTurnsOneWay) {
  GridPath star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi * 2 * i / 5;
    star.push_back({std::llround(1000 * std::cos(angle)), std::llround(1000 * std::sin(angle))});
  }
  EXPECT_FALSE(isConvexRing(star));
  EXPECT_TRUE(isConvexRing({{0, 0}, {10, 0}, {0, 10}}));
  EXPECT_FALSE(isConvexRing({{0, 0}, {0, 10}, {10, 0}}));
  std::vector<GridPath> loops{star};
  uniteLoops(loops, 1.0);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 10u);  // the pentagon inside is covered twice, and no hole
}

}  // namespace
}  // namespace sightline::drawing
