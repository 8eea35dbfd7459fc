#include "sightline/drawing/hidden_lines.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/drawing/sketch.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using test::flatView;
using test::kPage;
using test::quad;
using test::Sketch;
using test::squareView;
using test::Triangle;

// A wall across the view at a depth, from x0 to x1.
std::vector<Triangle> wall(float x0, float x1, float depth) {
  return quad({x0, -50, -depth}, {x1, -50, -depth}, {x1, 50, -depth}, {x0, 50, -depth});
}

void expectShares(const std::vector<LinePiece>& pieces, const std::vector<std::array<double, 2>>& expected) {
  ASSERT_EQ(pieces.size(), expected.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    EXPECT_NEAR(pieces[i].from_share, expected[i][0], 1e-12);
    EXPECT_NEAR(pieces[i].to_share, expected[i][1], 1e-12);
  }
}

TEST(HiddenLines, AreOnThePageWhereTheCameraSeesThem) {
  Sketch sketch;
  const FeatureLine line = sketch.line({-1, 1, -2}, {4, -2, -8});
  const std::vector<LinePiece> pieces = sketch.pieces(squareView(), line);
  expectShares(pieces, {{0, 1}});
  EXPECT_DOUBLE_EQ(pieces[0].from.x, 25.0);  // -1/2 of the way from the middle to the left
  EXPECT_DOUBLE_EQ(pieces[0].from.y, 25.0);
  EXPECT_DOUBLE_EQ(pieces[0].to.x, 75.0);
  EXPECT_DOUBLE_EQ(pieces[0].to.y, 62.5);
  EXPECT_EQ(pieces[0].line, line);
  View wide = flatView(10);
  wide.aspect = 2.0;
  const std::vector<LinePiece> flat = sketch.pieces(wide, line);
  EXPECT_DOUBLE_EQ(flat.at(0).from.x, 90.0);
  EXPECT_DOUBLE_EQ(flat.at(0).from.y, 40.0);
  EXPECT_DOUBLE_EQ(flat.at(0).to.x, 140.0);
}

TEST(HiddenLines, EndAtTheBordersOfTheView) {
  Sketch sketch;
  expectShares(sketch.pieces(squareView(), sketch.line({-4, 0, -2}, {4, 0, -2})), {{0.25, 0.75}});
  // From behind the eye to beyond the far plane.
  expectShares(sketch.pieces(squareView(), sketch.line({0, 0.5, 99}, {0, 0.5, -101})), {{0.5, 0.995}});
  View endless = squareView();
  endless.z_far = std::numeric_limits<double>::infinity();
  expectShares(sketch.pieces(endless, sketch.line({0, 0.5, 99}, {0, 0.5, -101})), {{0.5, 1}});
  expectShares(sketch.pieces(squareView(), sketch.line({0, 0, 5}, {3, 0, 2})), {});
  expectShares(sketch.pieces(squareView(), sketch.line({5, 0, -2}, {3, 0, -2})), {});
  // Along the border itself.
  const std::vector<LinePiece> border = sketch.pieces(squareView(), sketch.line({2, 0, -2}, {8, 2, -8}));
  expectShares(border, {{0, 1}});
  EXPECT_EQ(border[0].to.x, kPage);
}

TEST(HiddenLines, EndAtTheBordersOfAnOffCentreView) {
  Sketch sketch;
  View view = squareView();
  view.shift_x = 0.5;
  view.shift_y = -0.25;
  // The page shows x / depth from -0.5 to 1.5 and y / depth from -1.25 to 0.75.
  const std::vector<LinePiece> level = sketch.pieces(view, sketch.line({-4, 0, -2}, {4, 0, -2}));
  expectShares(level, {{0.375, 0.875}});
  EXPECT_NEAR(level[0].from.x, 0.0, 1e-9);
  EXPECT_NEAR(level[0].to.x, kPage, 1e-9);
  EXPECT_NEAR(level[0].from.y, 0.375 * kPage, 1e-9);
  const std::vector<LinePiece> upright = sketch.pieces(view, sketch.line({1, -4, -2}, {1, 4, -2}));
  expectShares(upright, {{0.1875, 0.6875}});
  EXPECT_NEAR(upright[0].from.x, 0.5 * kPage, 1e-9);
  EXPECT_NEAR(upright[0].from.y, kPage, 1e-9);
  EXPECT_NEAR(upright[0].to.y, 0.0, 1e-9);
}

TEST(HiddenLines, SharesAreOfTheLineInSpace) {
  Sketch sketch;
  const ObjectId object = sketch.add(wall(-1, 0.5, 2));
  // At (t 12 - 4, 0, -4 - t 12): behind the wall while -1/2 <= x / depth <= 1/4.
  const FeatureLine line = sketch.line({-4, 0, -4}, {8, 0, -16});
  expectShares(sketch.pieces(squareView(), line), {{0, 1.0 / 9.0}, {5.0 / 9.0, 1}});
  // Without the wall among the occluders it is whole.
  HiddenLines hidden;
  hidden.setView(sketch.scene.view(), squareView(), kPage);
  std::vector<LinePiece> pieces;
  hidden.visiblePieces({&line, 1}, {}, pieces);
  expectShares(pieces, {{0, 1}});
  hidden.visiblePieces({&line, 1}, {&object, 1}, pieces);  // appends
  EXPECT_EQ(pieces.size(), 3u);
}

TEST(HiddenLines, AreCutWhereTheyPassThroughAFace) {
  Sketch sketch;
  sketch.add(wall(-20, 20, 4));
  expectShares(sketch.pieces(squareView(), sketch.line({1, 0, -2}, {2, 1, -6})), {{0, 0.5}});
  expectShares(sketch.pieces(flatView(20), sketch.line({1, 0, -2}, {2, 1, -6})), {{0, 0.5}});
}

TEST(HiddenLines, OnlyWhatIsDrawnHides) {
  for (const View& view : {squareView(), flatView(20)}) {
    for (std::uint32_t material = 0; material < 4; ++material) {
      for (const bool front : {true, false}) {
        Sketch sketch;
        std::vector<Triangle> triangles = wall(-20, 20, 4);
        for (Triangle& triangle : triangles) {
          if (!front) {
            std::swap(triangle[0], triangle[1]);
          }
        }
        sketch.add(triangles, material);
        const bool hides = material == 0 || (material == 1 && front);
        EXPECT_EQ(sketch.pieces(view, sketch.line({0, 0, -8}, {1, 1, -9})).empty(), hides) << material;
      }
    }
  }
}

TEST(HiddenLines, InAFacesPlaneOrOnItsBordersAreNotHiddenByIt) {
  for (const View& view : {squareView(), flatView(20)}) {
    Sketch sketch;
    sketch.add(quad({-3, -3, -4}, {3, -3, -4}, {3, 3, -4}, {-3, 3, -4}));
    expectShares(sketch.pieces(view, sketch.line({-3, -3, -4}, {3, -3, -4})), {{0, 1}});
    expectShares(sketch.pieces(view, sketch.line({-2, -1, -4}, {2, 2, -4})), {{0, 1}});
    expectShares(sketch.pieces(view, sketch.line({0, 0, -2}, {1, 1, -4})), {{0, 1}});  // ends on it
    expectShares(sketch.pieces(view, sketch.line({0, 0, -4}, {1, 1, -5})), {});        // begins on it
    expectShares(sketch.pieces(view, sketch.line({-3, -3, -4}, {1, 1, -5})), {});      // at a corner
  }
}

// Walls of other objects continue the plane, rounded to single precision, in any orientation.
TEST(HiddenLines, AreNotHiddenByCoplanarNeighbours) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto number = test::numbersFrom<double>(random);
    View view = squareView();
    view.orthographic = seed % 3 == 0;
    view.ortho_height = 60;
    view.eye = Vec3d(number(-300, 300), number(-300, 300), number(-300, 300));
    const Vec3d u = normalized(Vec3d(number(-1, 1), number(-1, 1), number(-1, 1)));
    const Vec3d v = normalized(cross(u, Vec3d(number(-1, 1), number(-1, 1), number(-1, 1))));
    const Vec3d at = view.eye + Vec3d(number(-3, 3), number(-3, 3), -12);
    const auto place = [&](double x, double y) { return Vec3f(at + u * x + v * y); };
    Sketch sketch;
    for (int i = 0; i < 40; ++i) {
      const double x = number(-6, 6);
      const double y = number(-6, 6);
      sketch.add(
          {{place(x, y), place(x + number(0.01, 5), y + number(-1, 1)), place(x, y + number(0.01, 4))}});
    }
    for (int i = 0; i < 10; ++i) {
      const FeatureLine line =
          sketch.line(place(number(-6, 6), number(-6, 6)), place(number(-6, 6), number(-6, 6)));
      const std::vector<LinePiece> pieces = sketch.pieces(view, line);
      ASSERT_EQ(pieces.size(), 1u);
    }
  }
}

TEST(HiddenLines, SeenEndOnOrWithoutLengthGiveNone) {
  Sketch sketch;
  EXPECT_TRUE(sketch.pieces(squareView(), sketch.line({1, 0.5, -2}, {2, 1, -4})).empty());
  EXPECT_TRUE(sketch.pieces(flatView(20), sketch.line({1, 0.3f, -2}, {1, 0.3f, -4})).empty());
  EXPECT_TRUE(sketch.pieces(squareView(), sketch.line({1, 1, -2}, {1, 1, -2})).empty());
}

TEST(HiddenLines, AreSeenThroughAGap) {
  Sketch sketch;
  sketch.add(wall(-20, 0, 4));
  sketch.add(wall(0.001f, 20, 4));
  const std::vector<LinePiece> pieces = sketch.pieces(squareView(), sketch.line({-4, 0, -8}, {4, 0, -8}));
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].from_share, 0.5, 1e-12);
  EXPECT_NEAR(pieces[0].to_share, 0.5 + 0.002 / 8, 1e-9);
}

TEST(HiddenLines, AreHiddenByWhatReachesBehindTheEyeButNotByWhatTheNearPlaneCutsOff) {
  Sketch sketch;
  // A floor from behind the eye to a depth of 60, 2 below; below it everything beyond depth 2 is on the page.
  sketch.add(quad({-80, -2, 30}, {80, -2, 30}, {80, -2, -60}, {-80, -2, -60}));
  expectShares(sketch.pieces(squareView(), sketch.line({0, -3, -4}, {1, -4, -20})), {});
  // A ramp that comes up to the eye: at depth d it is at -d / 8; before the near plane it is not drawn.
  Sketch ramp;
  ramp.add(quad({-9, 4, 8}, {9, 4, 8}, {9, -5, -10}, {-9, -5, -10}));
  ramp.scene.positions[0].y += 1;  // not through the eye
  for (Vec3f& p : ramp.scene.positions) {
    p.y = -0.25f + 0.5f * p.z;
  }
  // y = z / 2 - 1/4: a sight of slope s (down) meets it at depth 1 / (4 (s - 1/2)): beyond the near plane if
  // s <= 3/4. The line at depth 8 goes from slope 1/2 to 1; before slope 17/32 it is above the ramp.
  const std::vector<LinePiece> pieces = ramp.pieces(squareView(), ramp.line({1, -4, -8}, {1, -8, -8}));
  expectShares(pieces, {{0, 1.0 / 16}, {0.5, 1}});
}

// Watertight sheets between eye and line, the lines also exactly behind the sheet's edges and corners.
TEST(HiddenLines, LeaveNoSpeckBehindTrianglesThatAdjoin) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto number = test::numbersFrom<float>(random);
    const bool orthographic = seed % 2 == 0;
    constexpr int kCells = 8;
    Vec3f at[kCells + 1][kCells + 1];
    for (int i = 0; i <= kCells; ++i) {
      for (int j = 0; j <= kCells; ++j) {
        at[i][j] = Vec3f(static_cast<float>(i - 4) * 2.0f + number(-0.7f, 0.7f),
                         static_cast<float>(j - 4) * 2.0f + number(-0.7f, 0.7f), number(-4.5f, -3.0f));
      }
    }
    Sketch sketch;
    std::vector<Triangle> sheet;
    for (int i = 0; i < kCells; ++i) {
      for (int j = 0; j < kCells; ++j) {
        const std::vector<Triangle> two = quad(at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]);
        sheet.insert(sheet.end(), two.begin(), two.end());
        if (random() % 4 == 0) {
          sketch.add(sheet);  // adjoining objects too
          sheet.clear();
        }
      }
    }
    sketch.add(sheet);
    const auto behind = [&](const Vec3f& p) {
      return orthographic ? p - Vec3f(0, 0, 8) : p * 4.0f;  // exact
    };
    for (int i = 1; i < kCells; ++i) {
      for (int j = 1; j < kCells; ++j) {
        for (const Vec3f& other : {at[i + 1][j], at[i][j + 1], at[i + 1][j + 1], at[1][1]}) {
          EXPECT_TRUE(sketch
                          .pieces(orthographic ? flatView(8) : squareView(),
                                  sketch.line(behind(at[i][j]), behind(other)))
                          .empty());
        }
      }
    }
  }
}

// Two faces share an edge with one: the edge has a corner that the face on its other side lacks.
TEST(HiddenLines, LeaveNoSpeckBehindTJunctions) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto number = test::numbersFrom<float>(random);
    const float x = number(-1, 1);
    const float y = number(-2, 2);
    const float depth = number(3, 5);
    Sketch sketch;
    sketch.add({{Vec3f(x, -19, -depth), Vec3f(x, 17, -depth), Vec3f(-90, 0, -depth)}});
    const Vec3f corner(x, y, -depth);
    const Vec3f low(number(3, 9), -9, -depth);
    const Vec3f high(number(3, 9), 9, -depth);
    sketch.add(
        {{Vec3f(x, -19, -depth), corner, low}, {corner, Vec3f(x, 17, -depth), high}, {corner, low, high}});
    // The line lies exactly behind the shared edge, and slightly turned.
    for (const float turn : {0.0f, 1e-7f, 1e-3f}) {
      for (View view : {squareView(), flatView(4)}) {
        setOrientation(view, {0, 0, -1}, {number(-1, 1), 1, 0});  // so that nothing is exact
        const float scale = view.orthographic ? 1.0f : 2.0f;
        const Vec3f a(scale * x - turn, -0.9f, -2 * depth);
        const Vec3f b(scale * x + turn, 0.8f, -2 * depth);
        EXPECT_TRUE(sketch.pieces(view, sketch.line(a, b)).empty()) << turn << view.orthographic;
      }
    }
  }
}

TEST(HiddenLines, TakeWhatIsNotFiniteForNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Sketch sketch;
  sketch.add({{Vec3f(-9, -9, -4), Vec3f(9, nan, -4), Vec3f(0, 9, -4)},
              {Vec3f(-9, -9, -4), Vec3f(9, -9, -infinity), Vec3f(0, 9, -4)},
              {Vec3f(-9, -9, -4), Vec3f(9, 9, -4), Vec3f(0, 0, -4)},
              {Vec3f(-1e38f, -1e38f, -4), Vec3f(-2e38f, 3e38f, 3), Vec3f(-1e38f, 0, -4)}});
  const FeatureLine line = sketch.line({-1, 0, -8}, {1, 1, -8});
  expectShares(sketch.pieces(squareView(), line), {{0, 1}});
  EXPECT_TRUE(sketch.pieces(squareView(), sketch.line({-1, nan, -8}, {1, 1, -8})).empty());
  EXPECT_TRUE(sketch.pieces(squareView(), sketch.line({-1, 0, -8}, {1, infinity, -8})).empty());
  EXPECT_TRUE(sketch.pieces(squareView(), {5, 1000000, LineKind::kCrease}).empty());
  std::vector<View> views(8, squareView());
  views[0].eye.x = nan;
  views[1].z_near = -1e-9;
  views[2].z_far = views[2].z_near;
  views[3].tan_half_fovy = infinity;
  views[4].aspect = 0.0;
  views[5].forward.y = nan;
  views[6].right = {};
  views[7].z_near = 0.0;
  views[7].z_far = 1e-20;
  for (const View& view : views) {
    EXPECT_TRUE(sketch.pieces(view, line).empty());
  }
  HiddenLines hidden;  // without a view
  std::vector<LinePiece> pieces;
  hidden.visiblePieces({&line, 1}, sketch.all(), pieces);
  EXPECT_TRUE(pieces.empty());
  const ObjectId nothing;
  hidden.setView(sketch.scene.view(), squareView(), kPage);
  hidden.visiblePieces({&line, 1}, {&nothing, 1}, pieces);
  EXPECT_EQ(pieces.size(), 1u);
}

TEST(HiddenLines, BeginAtTheEyeIfTheNearDistanceIsZero) {
  Sketch sketch;
  sketch.add(wall(-1, 1, 4));
  // The last line but one lies in the plane of the eye, the last one comes from behind it, below the eye.
  const FeatureLine lines[] = {sketch.line({-3, 0, -8}, {3, 0, -8}),
                               sketch.line({-0.25f, 0.125f, -1}, {0.25f, 0.125f, -1}),
                               sketch.line({-4, -3, 0}, {4, -3, 0}), sketch.line({-1, -1, 3}, {1, -1, -3})};
  for (const bool orthographic : {false, true}) {
    View view = orthographic ? flatView(8) : squareView();
    for (const double z_near : {0.0, 1e-300}) {
      view.z_near = z_near;
      const auto sharesOf = [&](const FeatureLine& line) { return sketch.pieces(view, line); };
      view.z_near = 0.01;
      const std::vector<LinePiece> behind = sharesOf(lines[0]), before = sharesOf(lines[1]);
      view.z_near = z_near;
      ASSERT_EQ(sharesOf(lines[0]).size(), 2u);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(sharesOf(lines[0])[i].from, behind[i].from);
        EXPECT_EQ(sharesOf(lines[0])[i].to, behind[i].to);
      }
      expectShares(before, {{0, 1}});
      expectShares(sharesOf(lines[1]), {{0, 1}});
      EXPECT_EQ(sharesOf(lines[2]).size(), orthographic && z_near == 0.0 ? 1u : 0u);
      // From the lower border of the picture on, or from the plane of the eye on.
      expectShares(sharesOf(lines[3]), {{orthographic ? 0.5 : 4.0 / 6.0, 1.0}});
    }
  }
}

TEST(HiddenLines, DoNotDependOnTheLengthOfAxes) {
  Sketch sketch;
  sketch.add(wall(-1, 1, 4));
  const FeatureLine line = sketch.line({-3, 0.5, -8}, {3, -0.5, -8});
  for (const bool orthographic : {false, true}) {
    const View view = orthographic ? flatView(8) : squareView();
    const std::vector<LinePiece> expected = sketch.pieces(view, line);
    ASSERT_EQ(expected.size(), 2u);
    for (const double factor : {2.0, 100.0, 1e-200, 1e200}) {
      View scaled = view;
      scaled.right = view.right * factor;
      scaled.up = view.up * (0.5 * factor);
      for (const double depth_factor : {1.0, factor}) {
        scaled.forward = view.forward * depth_factor;
        const std::vector<LinePiece> pieces = sketch.pieces(scaled, line);
        ASSERT_EQ(pieces.size(), 2u) << factor;
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_EQ(pieces[i].from, expected[i].from) << factor;
          EXPECT_EQ(pieces[i].to, expected[i].to) << factor;
        }
      }
    }
  }
}

TEST(HiddenLines, LookAtNothingThatLiesBesideOrBehind) {
  Sketch sketch;
  sketch.add(wall(-20, 20, 30));
  for (int i = 0; i < 200; ++i) {
    const float x = static_cast<float>(i % 20 - 10);
    const float y = static_cast<float>(i / 20 - 5);
    sketch.add({{Vec3f(x, y, -12), Vec3f(x + 0.5f, y, -12), Vec3f(x, y + 0.5f, -12)}});
  }
  const FeatureLine before = sketch.line({-5, -4, -10}, {6, 5, -11});
  const FeatureLine behind = sketch.line({0.1f, 0.1f, -13}, {0.3f, 0.1f, -13});
  HiddenLines hidden;
  hidden.setView(sketch.scene.view(), squareView(), kPage);
  std::vector<LinePiece> pieces;
  hidden.visiblePieces({&before, 1}, sketch.all(), pieces);
  EXPECT_EQ(hidden.stats().tests, 0u);
  hidden.visiblePieces({&behind, 1}, sketch.all(), pieces);
  EXPECT_GE(hidden.stats().tests, 1u);
  EXPECT_LE(hidden.stats().tests, 8u);
  EXPECT_EQ(hidden.stats().lines, 2u);
  EXPECT_EQ(hidden.stats().pieces, pieces.size());
}

TEST(HiddenLines, AllocateNothingOnceTheyHaveGrown) {
  std::mt19937 random(5);
  const auto number = test::numbersFrom<float>(random);
  Sketch sketch;
  std::vector<FeatureLine> lines;
  for (int i = 0; i < 50; ++i) {
    const float x = number(-5, 5);
    sketch.add({{Vec3f(x, -6, number(-9, -3)), Vec3f(x + 1, -6, -4), Vec3f(x, 6, number(-9, -3))}});
    lines.push_back(sketch.line({-6, number(-6, 6), -10}, {6, number(-6, 6), number(-12, -2)}));
  }
  const std::vector<ObjectId> all = sketch.all();
  HiddenLines hidden;
  std::vector<LinePiece> pieces;
  std::vector<LinePiece> first;
  for (int round = 0; round < 3; ++round) {
    pieces.clear();
    const std::size_t count = allocations;
    hidden.setView(sketch.scene.view(), squareView(), kPage);
    hidden.visiblePieces(lines, all, pieces);
    EXPECT_EQ(allocations == count, round > 0);
    first = round == 0 ? pieces : first;
  }
  ASSERT_EQ(pieces.size(), first.size());
  EXPECT_GT(pieces.size(), lines.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    EXPECT_EQ(pieces[i].from_share, first[i].from_share);
    EXPECT_EQ(pieces[i].to_share, first[i].to_share);
  }
}

}  // namespace
}  // namespace sightline
