// Visible pieces of lines, joined to strokes.

#include "src/drawing/polylines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "tests/drawing/page_geometry.h"
#include "tests/support/layer_shapes.h"

namespace sightline::drawing {
namespace {

using shapes::Random;
using test::lengthOf;

constexpr double kTolerance = 0.005;

LinePiece piece(const std::vector<PagePoint>& corners, std::uint32_t a, std::uint32_t b, double from = 0.0,
                double to = 1.0) {
  const auto at = [&](double share) {
    return PagePoint{corners[a].x + (corners[b].x - corners[a].x) * share,
                     corners[a].y + (corners[b].y - corners[a].y) * share};
  };
  return {.from = from == 0.0 ? corners[a] : at(from),
          .to = to == 1.0 ? corners[b] : at(to),
          .from_share = from,
          .to_share = to,
          .line = {.a = a, .b = b}};
}

std::vector<PagePath> joined(const std::vector<LinePiece>& pieces) {
  std::vector<PagePath> strokes;
  joinPieces(pieces, kTolerance, strokes);
  return strokes;
}

const std::vector<PagePoint> kSquare{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {20, 0}};

TEST(Polylines, ALoopIsOneClosedStroke) {
  const std::vector<PagePath> strokes =
      joined({piece(kSquare, 0, 1), piece(kSquare, 0, 3), piece(kSquare, 1, 2), piece(kSquare, 2, 3)});
  ASSERT_EQ(strokes.size(), 1u);
  EXPECT_EQ(strokes[0].size(), 5u);
  EXPECT_EQ(strokes[0].front(), strokes[0].back());
  EXPECT_NEAR(lengthOf(strokes[0]), 40.0, 1e-12);
}

TEST(Polylines, AHiddenEndBreaksTheStroke) {
  // The side from 0 to 1 is hidden in its middle, the one from 1 to 2 at the corner that they share.
  const std::vector<PagePath> strokes =
      joined({piece(kSquare, 0, 1, 0.0, 0.4), piece(kSquare, 0, 1, 0.6, 1.0), piece(kSquare, 0, 3),
              piece(kSquare, 1, 2, 0.1, 1.0), piece(kSquare, 2, 3)});
  ASSERT_EQ(strokes.size(), 2u);
  EXPECT_EQ(std::min(strokes[0].size(), strokes[1].size()), 2u);
  EXPECT_EQ(std::max(strokes[0].size(), strokes[1].size()), 5u);
  EXPECT_NEAR(lengthOf(strokes[0]) + lengthOf(strokes[1]), 40.0 - 2.0 - 1.0, 1e-12);
}

TEST(Polylines, AtACornerOfThreeTheStraightestGoesOn) {
  // Corner 1: from 0, to 4 straight on, and to 2 across.
  const std::vector<PagePath> strokes =
      joined({piece(kSquare, 0, 1), piece(kSquare, 1, 2), piece(kSquare, 1, 4)});
  ASSERT_EQ(strokes.size(), 2u);
  const bool first_is_long = lengthOf(strokes[0]) > 15.0;
  // The point between two parts of a straight line is not needed.
  EXPECT_EQ(strokes[first_is_long ? 0 : 1], (PagePath{{0, 0}, {20, 0}}));
  EXPECT_EQ(strokes[first_is_long ? 1 : 0], (PagePath{{10, 0}, {10, 10}}));
}

TEST(Polylines, BreakNoMoreThanTheyMust) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    std::vector<PagePoint> corners;
    for (int i = 0; i < 30; ++i) {
      corners.push_back({random.number(0, 100), random.number(0, 100)});
    }
    std::vector<LinePiece> pieces;
    std::map<std::uint32_t, int> ends;
    double total = 0.0;
    for (std::uint32_t a = 0; a < corners.size(); ++a) {
      for (std::uint32_t b = a + 1; b < corners.size(); ++b) {
        if (random.below(seed % 2 == 0 ? 3 : 15) == 0) {
          pieces.push_back(piece(corners, a, b));
          ++ends[a];
          ++ends[b];
          total += std::hypot(corners[a].x - corners[b].x, corners[a].y - corners[b].y);
        }
      }
    }
    std::size_t odd = 0;
    for (const auto& [corner, count] : ends) {
      odd += count % 2;
    }
    const std::vector<PagePath> strokes = joined(pieces);
    std::size_t open = 0;
    double drawn = 0.0;
    for (const PagePath& stroke : strokes) {
      open += stroke.front() == stroke.back() ? 0 : 1;
      drawn += lengthOf(stroke);
    }
    // Each corner of an odd number of lines ends one stroke.
    EXPECT_EQ(2 * open, odd) << "seed " << seed;
    EXPECT_NEAR(drawn, total, 0.05 * static_cast<double>(pieces.size())) << "seed " << seed;
  }
}

TEST(Polylines, ShorterThanTheToleranceAreLeftOut) {
  EXPECT_TRUE(joined({piece(kSquare, 0, 1, 0.5, 0.5004)}).empty());
  EXPECT_EQ(joined({piece(kSquare, 0, 1, 0.5, 0.51)}).size(), 1u);
  EXPECT_TRUE(joined({}).empty());
}

TEST(Polylines, PiecesThatLieOnOneBeforeAreTakenOut) {
  DrawnPieces drawn(kTolerance);
  std::vector<LinePiece> first{piece(kSquare, 0, 1), piece(kSquare, 1, 2, 0.25, 1.0)};
  drawn.leaveNew(first);
  EXPECT_EQ(first.size(), 2u);
  // The same there and back, half of it, the rest of the other, and a neighbour.
  std::vector<LinePiece> second{piece(kSquare, 0, 1), piece(kSquare, 1, 0), piece(kSquare, 0, 1, 0.0, 0.5),
                                piece(kSquare, 1, 2, 0.0, 0.25), piece(kSquare, 1, 4)};
  drawn.leaveNew(second);
  ASSERT_EQ(second.size(), 3u);
  EXPECT_EQ(second[0].to_share, 0.5);
  EXPECT_EQ(second[1].to_share, 0.25);
  EXPECT_EQ(second[2].line.b, 4u);
}

TEST(Polylines, SimplifiedLinesStayWithinTheTolerance) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    // Walks of steps far below and far above the tolerance, with turns back.
    PagePath line{{0, 0}};
    double angle = 0.0;
    for (int i = 0; i < 3000; ++i) {
      angle += random.number(-0.3, 0.3) + (random.below(100) == 0 ? 3.0 : 0.0);
      const double step = std::exp(random.number(std::log(1e-5), std::log(0.05)));
      line.push_back({line.back().x + step * std::cos(angle), line.back().y + step * std::sin(angle)});
    }
    PagePath simple = line;
    simplify(simple, kTolerance);
    EXPECT_LT(simple.size(), line.size() / 2) << "seed " << seed;
    EXPECT_EQ(simple.front(), line.front());
    EXPECT_EQ(simple.back(), line.back());
    for (const PagePoint& p : line) {
      ASSERT_LE(test::distanceTo({simple}, p, false), kTolerance * 1.001) << "seed " << seed;
    }
  }
}

TEST(Polylines, ACircleOfManyPointsKeepsTheFewThatItNeeds) {
  PagePath circle;
  for (int i = 0; i <= 20000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 20000;
    circle.push_back({50 * std::cos(angle), 50 * std::sin(angle)});
  }
  circle.back() = circle.front();
  simplify(circle, kTolerance);
  EXPECT_EQ(circle.front(), circle.back());
  // A chord of a 50-unit circle that is a tolerance away spans 2 acos(1 - 0.005 / 50): about 223 of them.
  EXPECT_LT(circle.size(), 450u);
  EXPECT_GT(circle.size(), 110u);
}

}  // namespace
}  // namespace sightline::drawing
