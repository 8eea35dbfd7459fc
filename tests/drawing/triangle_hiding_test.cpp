// Hidden lines where distances differ much: long triangles near the eye, and small ones far away. What is
// expected follows from similar triangles.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sightline/drawing/hidden_lines.h"
#include "tests/drawing/sketch.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using test::kPage;
using test::quad;
using test::Sketch;
using test::squareView;

// Where a square view shows a point, in page units from the left.
double pageX(double x, double depth) {
  return 0.5 * kPage * (1.0 + x / depth);
}

// The sketch hides all of a line that is seen without it.
void expectHidden(Sketch& sketch, const View& view, const Vec3f& a, const Vec3f& b) {
  Sketch empty;
  EXPECT_EQ(empty.pieces(view, empty.line(a, b)).size(), 1u);
  EXPECT_TRUE(sketch.pieces(view, sketch.line(a, b)).empty());
}

TEST(TriangleHiding, ALongWallHidesNothingBesideItsNearEnd) {
  constexpr float kEnd = 0.25f;  // the wall lies across the view, from here to the left
  constexpr float kDepth = 1.5f;
  constexpr float kRailDepth = 4.0f;
  for (const float wall : {1e2f, 1e4f, 1e5f, 1e6f}) {
    for (const float rail : {8.0f, 1e3f, 1e4f, 1e5f}) {
      SCOPED_TRACE(::testing::Message() << "wall " << wall << " m, rail " << rail << " m");
      Sketch sketch;
      sketch.add(quad({kEnd, -1, -kDepth}, {kEnd, 1, -kDepth}, {-wall, 1, -kDepth}, {-wall, -1, -kDepth}));
      const std::vector<LinePiece> pieces =
          sketch.pieces(squareView(), sketch.line({-rail, 0.1f, -kRailDepth}, {rail, 0.1f, -kRailDepth}));
      ASSERT_EQ(pieces.size(), 1u);
      EXPECT_NEAR(pieces[0].from.x, pageX(kEnd, kDepth), 1e-7);
      EXPECT_NEAR(pieces[0].to.x, kPage, 1e-9);
    }
  }
}

TEST(TriangleHiding, AWallThatRunsFarAwayHidesNothingBesideItsNearEnd) {
  constexpr float kSide = 1.0f;  // the wall lies along the view, at this x from this depth on
  constexpr float kDepth = 2.0f;
  constexpr float kRailDepth = 4.0f;
  for (const float wall : {1e2f, 1e4f, 1e5f, 1e6f}) {
    for (const float rail : {8.0f, 1e3f, 1e4f, 1e5f}) {
      SCOPED_TRACE(::testing::Message() << "wall " << wall << " m, rail " << rail << " m");
      Sketch sketch;
      sketch.add(quad({kSide, -1, -kDepth}, {kSide, 1, -kDepth}, {kSide, 1, -wall}, {kSide, -1, -wall}));
      const std::vector<LinePiece> pieces =
          sketch.pieces(squareView(), sketch.line({-rail, 0.1f, -kRailDepth}, {rail, 0.1f, -kRailDepth}));
      ASSERT_EQ(pieces.size(), 2u);
      // The rail passes through the wall, and behind it to where the wall's near end covers it.
      const double plane = std::ldexp(std::fmax(wall, rail), -20);  // where it counts as in the wall's plane
      EXPECT_NEAR(pieces[0].to.x, pageX(kSide, kRailDepth), 0.5 * kPage * plane / kRailDepth);
      EXPECT_NEAR(pieces[1].from.x, pageX(kSide, kDepth), 1e-7);
      EXPECT_NEAR(pieces[1].to.x, kPage, 1e-9);
    }
  }
}

// A long edge with a corner of other triangles exactly on it, in views in which no product is exact.
TEST(TriangleHiding, LongTrianglesLeaveNoGap) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    test::Random random(seed);
    const auto whole = [&](double least, std::uint32_t count) { return least + random.below(count); };
    // These are in sixteenths of a metre.
    const Vec3d step{whole(-40, 33), whole(-6, 13), whole(-30, 30)};
    const Vec3d near_end{whole(10, 21), whole(-8, 17), whole(-40, 21)};
    const Vec3d far_end = near_end + step * std::ldexp(16.0, static_cast<int>(random.below(9)));
    const Vec3d corner = near_end + step * whole(1, 8);
    const auto at = [](const Vec3d& p, double up) { return Vec3f((p + Vec3d(0, up, 0)) / 16.0); };
    Sketch sketch;
    // One triangle is above the edge, three are below it.
    sketch.add({{at(near_end, 0), at(far_end, 0), at(near_end, 4000)}});
    sketch.add({{at(near_end, 0), at(near_end, -4000), at(corner, 0)},
                {at(corner, 0), at(near_end, -4000), at(far_end, -4000)},
                {at(corner, 0), at(far_end, -4000), at(far_end, 0)}});
    View view = squareView(0.25, 1e9);
    const Vec3d forward{random.in(-0.3, 0.3), random.in(-0.3, 0.3), -1};
    setOrientation(view, forward, {random.in(-1, 1), 1, 0});
    expectHidden(sketch, view, at(near_end, 0) * 2.0f, at(far_end, 0) * 2.0f);
  }
}

// A view from far away, in a direction that is no axis, that shows a metre around the scene's origin. Its
// points are given by coordinates to the right, up and forwards, in units of 5 m, 1 m and 5 m.
struct FarEye {
  View view;
  double distance = 0.0;

  FarEye(double away, bool orthographic) : distance(away) {
    setOrientation(view, {3, 0, -4}, {0, 1, 0});
    view.eye = Vec3d(-3, 0, 4) * (away / 5);
    view.aspect = 1.0;
    view.orthographic = orthographic;
    view.ortho_height = 1.0;
    view.tan_half_fovy = 0.5 / away;
    view.z_near = 1.0;
    view.z_far = 1e9;
  }
  Vec3f point(double right, double up, double forwards) const {
    return Vec3f(Vec3d(4 * right + 3 * forwards, up, 3 * right - 4 * forwards));
  }
  // A point that `p` hides, farther away by a share of its distance, a power of two; exact.
  Vec3f behind(const Vec3f& p, double share) const {
    const Vec3d q = Vec3d(p) + (view.orthographic ? Vec3d(3, 0, -4) : (Vec3d(p) - view.eye) * share);
    EXPECT_EQ(Vec3d(Vec3f(q)), q);
    return Vec3f(q);
  }
  double rounding() const { return 0x1p-46 * distance; }  // more than that of a point, metres
};

TEST(TriangleHiding, SmallTrianglesFarAwayHideNothingBesideThem) {
  for (const bool orthographic : {true, false}) {
    for (const double away : {5e2, 5e3, 5e4, 5e5}) {
      for (const double size : {0x1p-6, 0x1p-9, 0x1p-12}) {
        SCOPED_TRACE(::testing::Message() << (orthographic ? "orthographic, " : "") << away
                                          << " m away, edges of " << size << " m");
        const FarEye eye(away, orthographic);
        Sketch sketch;
        sketch.add(quad(eye.point(size, -size, 0), eye.point(size, size, 0), eye.point(-size, size, 0),
                        eye.point(-size, -size, 0)));
        const FeatureLine line =
            sketch.line(eye.point(-0.0625, 0.25 * size, 1), eye.point(0.0625, 0.25 * size, 1));
        const std::vector<LinePiece> pieces = sketch.pieces(eye.view, line);
        ASSERT_EQ(pieces.size(), 2u);
        // The view shows a metre at the triangles' depth.
        EXPECT_NEAR(pieces[0].to.x, kPage * (0.5 - 5 * size), kPage * eye.rounding());
        EXPECT_NEAR(pieces[1].from.x, kPage * (0.5 + 5 * size), kPage * eye.rounding());
      }
    }
  }
}

// Far away, a corner that lies exactly on an edge is beside it by the rounding of its distance.
TEST(TriangleHiding, SmallTrianglesFarAwayLeaveNoGap) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    test::Random random(seed);
    const bool orthographic = seed % 2 == 0;
    const int scale = static_cast<int>(random.below(10));
    const FarEye eye(5.0 * std::ldexp(32.0 + random.below(32), scale), orthographic);
    const double x = random.below(9) - 4.0;
    const double y = random.below(33) - 16.0;
    const auto at = [&](double right, double up) { return eye.point((x + right) / 128, (y + up) / 64, 0); };
    Sketch sketch;
    // One triangle is to the left of the long edge in the middle, three are to its right.
    sketch.add({{at(0, -4), at(1, 4), at(-4, 0)}});
    sketch.add({{at(0, -4), at(0.5, 0), at(4, -3)}, {at(0.5, 0), at(1, 4), at(4, 3)}});
    sketch.add({{at(0.5, 0), at(4, -3), at(4, 3)}});
    const auto behind = [&](const Vec3f& p) { return eye.behind(p, std::ldexp(1.0, -scale)); };
    expectHidden(sketch, eye.view, behind(at(0, -4)), behind(at(1, 4)));
    // What is exactly behind a border is hidden too.
    expectHidden(sketch, eye.view, behind(at(-4, 0)), behind(at(1, 4)));
    expectHidden(sketch, eye.view, behind(at(4, -3)), behind(at(4, 3)));
  }
}

}  // namespace
}  // namespace sightline
