// Windings in a depth buffer as wide as they come: the same bits on every instruction set, and right ones.

#include "src/occlusion/surfaces/winding_map.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/instruction_sets.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline::occlusion {
namespace {

constexpr std::uint32_t kMapWidth = 8192, kMapHeight = 8, kMapStride = kMapWidth + 8;
constexpr float kNoDepth = -std::numeric_limits<float>::max();

// A closed polygon, or a part of a boundary. The surface lies to its left, `value` times.
struct Polygon {
  std::vector<GridPoint> points;
  std::int32_t value = 1;
};

// Appends the edges of a path that matter to a buffer. Returns them as a chain.
BoundaryChain addChain(std::span<const GridPoint> points, std::int32_t value, const EdgeBuffer& buffer,
                       std::vector<BoundaryEdge>& edges) {
  const std::size_t count = points.size() - 1, first = edges.size();
  GridLines lines;
  lines.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    lines.set(i, points[i], points[i + 1]);
  }
  edges.resize(first + count);
  prepareEdges(lines, nullptr, buffer, std::span(edges).subspan(first));
  std::erase_if(edges, [](const BoundaryEdge& edge) { return !edge.matters; });
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(edges.size() - first), value};
}

// Draws polygons as one group that has one depth.
void drawGroup(WindingMap& map, std::span<const Polygon> polygons, const DepthBound& depth) {
  const EdgeBuffer buffer = map.buffer();
  std::vector<BoundaryEdge> edges;
  std::vector<BoundaryChain> chains;
  for (const Polygon& polygon : polygons) {
    chains.push_back(addChain(polygon.points, polygon.value, buffer, edges));
  }
  const PixelRectangle all{0, 0, buffer.width, buffer.height};
  const std::array depths{PartDepth{all, depth}};
  const std::array groups{WindingGroup{all, chains, depths, true}};
  std::array<WindingGain, 1> gains;
  map.draw(groups, edges, gains);
}

// What one closed polygon covers in a map.
class PolygonCover {
 public:
  const std::vector<float>& of(std::span<const GridPoint> polygon) {
    std::fill(values_.begin(), values_.end(), kNoDepth);
    map_.begin({values_.data(), kMapWidth, kMapHeight, kMapStride});
    drawGroup(map_, std::array{Polygon{{polygon.begin(), polygon.end()}}}, {.floor = 1.0f});
    for (std::uint32_t row = 0; row < kMapHeight; ++row) {
      std::fill_n(values_.begin() + kMapStride * row + kMapWidth, kMapStride - kMapWidth, kNoDepth);
    }
    return values_;
  }

 private:
  std::vector<float> values_ = std::vector<float>(std::size_t{kMapStride} * kMapHeight);
  WindingMap map_;
};

// A quad 781 pixels wide that reaches over all rows. Its right edge lies between 4096 and 8192 pixels from
// the left border, where single precision knows places to an eighth of 1/256 pixel.
std::vector<GridPoint> farQuad(std::mt19937& random) {
  const auto number = test::numbersFrom<double>(random);
  const double width = 200'000.0, right = std::nearbyint(number(0x1p20, 0x1p21)),
               lean = std::nearbyint(number(-3e5, 3e5)), low = -std::nearbyint(number(1.0, 2e4)),
               high = kMapHeight * kGridStep + std::nearbyint(number(1.0, 2e4));
  return {{right - width, low},
          {right, low},
          {right + lean, high},
          {right + lean - width, high},
          {right - width, low}};
}

// Whether a point in grid units, not on a level line through a corner, is inside a quad of farQuad().
bool isInside(const std::vector<GridPoint>& quad, std::int64_t x, std::int64_t y) {
  for (std::size_t i = 1; i < quad.size(); ++i) {
    const auto x0 = static_cast<std::int64_t>(quad[i - 1].x), y0 = static_cast<std::int64_t>(quad[i - 1].y),
               x1 = static_cast<std::int64_t>(quad[i].x), y1 = static_cast<std::int64_t>(quad[i].y);
    if ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) < 0) {
      return false;
    }
  }
  return true;
}

TEST(WindingMap, HasTheSameBitsWithEveryInstructionSetAtTheGreatestWidth) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
  std::mt19937 random(7);
  PolygonCover cover;
  std::size_t covered = 0;
  for (int n = 0; n < test::rounds(1500); ++n) {
    const std::vector<GridPoint> quad = farQuad(random);
    std::vector<float> first;
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      const std::vector<float>& values = cover.of(quad);
      if (first.empty()) {
        first = values;
        covered += static_cast<std::size_t>(std::ranges::count(values, 1.0f));
      }
      EXPECT_TRUE(std::ranges::equal(first, values)) << "quad " << n << ", " << hwy::TargetName(target);
    }
  }
  EXPECT_GT(covered, test::rounds(1'000'000u));
}

TEST(WindingMap, CoversOnlyPixelsInsideAFarQuadAndMostOfThem) {
  std::mt19937 random(11);
  PolygonCover cover;
  for (int n = 0; n < 300; ++n) {
    const std::vector<GridPoint> quad = farQuad(random);
    const std::vector<float>& values = cover.of(quad);
    std::size_t covered = 0, inside = 0, wrong = 0;
    for (std::uint32_t row = 0; row < kMapHeight; ++row) {
      for (std::uint32_t column = 0; column < kMapWidth; ++column) {
        const std::int64_t x = kGridStep * std::int64_t{column}, y = kGridStep * std::int64_t{row};
        const bool whole = isInside(quad, x, y) && isInside(quad, x + kGridStep, y) &&
                           isInside(quad, x, y + kGridStep) && isInside(quad, x + kGridStep, y + kGridStep);
        const bool said = values[std::size_t{kMapStride} * row + column] > kNoDepth;
        covered += said ? 1 : 0;
        inside += whole ? 1 : 0;
        wrong += said && !whole ? 1 : 0;
      }
    }
    EXPECT_EQ(wrong, 0u) << "quad " << n;
    // An edge that leans by many pixels in a row leaves a few at either side open.
    EXPECT_GE(covered + std::size_t{16} * kMapHeight, inside) << "quad " << n;
  }
}

// A map of any size.
class SmallMap {
 public:
  SmallMap(std::uint32_t width, std::uint32_t height)
      : target_{nullptr, width, height, (width + 15) / 8 * 8}, values_(std::size_t{target_.stride} * height) {
    target_.reciprocal_depth = values_.data();
    clear();
  }

  void clear() {
    std::fill(values_.begin(), values_.end(), kNoDepth);
    map_.begin(target_);
  }
  // Draws polygons as one group.
  void draw(std::span<const std::vector<GridPoint>> polygons, std::int32_t value, float depth) {
    std::vector<Polygon> group;
    for (const std::vector<GridPoint>& polygon : polygons) {
      group.push_back({polygon, value});
    }
    drawGroup(map_, group, {.at_origin = depth, .floor = depth});
  }
  float at(std::uint32_t x, std::uint32_t y) const { return values_[std::size_t{target_.stride} * y + x]; }
  bool covered(std::uint32_t x, std::uint32_t y) const { return at(x, y) > kNoDepth; }
  const std::vector<float>& values() const { return values_; }
  WindingMap& map() { return map_; }
  const DepthTarget& target() const { return target_; }

 private:
  DepthTarget target_;
  std::vector<float> values_;
  WindingMap map_;
};

// A rectangle between points in pixels, counter-clockwise.
std::vector<GridPoint> box(double x0, double y0, double x1, double y1) {
  const double s = kGridStep;
  return {{x0 * s, y0 * s}, {x1 * s, y0 * s}, {x1 * s, y1 * s}, {x0 * s, y1 * s}, {x0 * s, y0 * s}};
}

TEST(WindingMap, CoversAllPixelsInsideARectangleAndNoOthersInAMapOfAnySize) {
  for (const std::uint32_t width : {1u, 7u, 8u, 31u, 32u, 33u, 100u, 4096u}) {
    for (const std::uint32_t height : {1u, 7u, 8u, 9u, 40u}) {
      SmallMap map(width, height);
      // Its borders lie an eighth of a pixel outside of whole pixels.
      const double x1 = std::floor(0.75 * width), y1 = std::floor(0.75 * height);
      map.draw(std::array{box(-0.125, -0.125, x1 + 0.125, y1 + 0.125)}, 1, 1.0f);
      std::size_t wrong = 0;
      for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
          wrong += map.covered(x, y) != (x < x1 && y < y1) ? 1 : 0;
        }
      }
      EXPECT_EQ(wrong, 0u) << width << " x " << height;
    }
  }
}

// Edges that come to a border of the map, from within or from outside, leave the pixels there open.
TEST(WindingMap, EdgesAtItsBordersCount) {
  constexpr double kUnit = 1.0 / kGridStep;
  for (const auto& [width, height] : {std::pair{1u, 1u}, {33u, 9u}, {64u, 16u}, {8u, 7u}}) {
    for (const bool in_runs : {true, false}) {
      for (int side = 0; side < 4; ++side) {
        for (const int beyond : {-2, -1, 0, 8}) {
          // The borders of the box: left, lower, right, upper.
          std::array<double, 4> at{-3.0, -3.0, width + 3.0, height + 3.0};
          at[static_cast<std::size_t>(side)] = side < 2   ? -beyond * kUnit
                                               : side < 3 ? width + beyond * kUnit
                                                          : height + beyond * kUnit;
          std::vector<std::vector<GridPoint>> polygons{box(at[0], at[1], at[2], at[3])};
          if (!in_runs) {
            // Two edges begin the group at the same height.
            polygons.push_back(box(-30.0, -9.0, -20.0, height + 9.0));
          }
          SmallMap map(width, height);
          map.draw(polygons, 1, 1.0f);
          for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
              const bool beside =
                  std::array{x == 0, y == 0, x + 1 == width, y + 1 == height}[static_cast<std::size_t>(side)];
              EXPECT_EQ(map.covered(x, y), beyond > 0 || !beside)
                  << width << " x " << height << ", side " << side << ", " << beyond << " beyond, pixel " << x
                  << ", " << y;
            }
          }
        }
      }
    }
  }
}

// Edges to the left of a group's rectangle count in its first tile, and nothing of them is left behind.
TEST(WindingMap, DrawsOnlyTheTilesOfTheRectangle) {
  for (const bool in_runs : {true, false}) {
    SmallMap map(200, 16);
    std::vector<std::vector<GridPoint>> polygons{box(3.5, -1.0, 150.0, 17.0)};
    if (!in_runs) {
      polygons.push_back(box(160.0, -1.0, 170.0, 17.0));
    }
    std::vector<BoundaryEdge> edges;
    for (const std::vector<GridPoint>& polygon : polygons) {
      addChain(polygon, 1, map.map().buffer(), edges);
    }
    const std::array boundary{BoundaryChain{0, static_cast<std::uint32_t>(edges.size()), 1}};
    const PixelRectangle rectangle{70, 8, 100, 16};
    const std::array depths{PartDepth{rectangle, {.floor = 1.0f}}};
    std::array<WindingGain, 1> gains;
    map.map().draw(std::array{WindingGroup{rectangle, boundary, depths, true}}, edges, gains);
    map.draw(std::array{box(178.5, -1.0, 190.5, 17.0), box(194.5, -1.0, 199.0, 17.0)}, 1, 2.0f);
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t x = 0; x < 178; ++x) {
        EXPECT_EQ(map.covered(x, y), x >= 64 && x < 128 && y >= 8) << in_runs << ", pixel " << x << ", " << y;
      }
    }
  }
}

TEST(WindingMap, SumsUpEdgesOfAnyValueAsFarAsItCanHold) {
  // Sheets over each other, of which one or all face away.
  for (const int sheets : {1, 2, 7, 8, 15, 16, 40}) {
    const std::vector<std::vector<GridPoint>> polygons(static_cast<std::size_t>(sheets),
                                                       box(3.5, 1.5, 70.5, 20.5));
    SmallMap map(100, 24);
    map.draw(polygons, -1, 1.0f);
    EXPECT_FALSE(map.covered(40, 10)) << sheets;
    EXPECT_FALSE(map.covered(80, 10)) << sheets;
    map.draw(polygons, 1, 1.0f);
    EXPECT_TRUE(map.covered(40, 10)) << sheets << ", in a tile to the right of the edges";
    EXPECT_EQ(map.covered(10, 10), sheets < 8) << sheets << ", in the tile of the edges";
    EXPECT_FALSE(map.covered(80, 10)) << sheets;
    EXPECT_FALSE(map.covered(3, 10)) << sheets;
    EXPECT_FALSE(map.covered(70, 10)) << sheets;
    // What was not known is forgotten with the group.
    map.draw(std::array{box(3.5, 1.5, 70.5, 20.5)}, 1, 2.0f);
    EXPECT_EQ(map.at(10, 10), 2.0f) << sheets;
    // One polygon of that value is as many polygons. The one beside it keeps it from being drawn in runs.
    SmallMap once(100, 24);
    drawGroup(once.map(), std::array{Polygon{box(3.5, 1.5, 70.5, 20.5), sheets}, Polygon{box(80, 1, 90, 21)}},
              {.floor = 1.0f});
    SmallMap in_runs(100, 24);
    in_runs.draw(std::array{box(3.5, 1.5, 70.5, 20.5)}, sheets, 1.0f);
    for (std::uint32_t x = 0; x < 75; ++x) {
      EXPECT_EQ(once.covered(x, 10), x > 3 && x < 70 && (sheets < 8 || x >= 32)) << sheets << ", pixel " << x;
      EXPECT_EQ(in_runs.covered(x, 10), x > 3 && x < 70) << sheets << ", pixel " << x;
    }
  }
}

TEST(WindingMap, HandsOnLargeSumsAndCoversNothingWhereTheyMightNotFit) {
  for (const std::int32_t value : {16'000, 1 << 20, 1 << 27, 1 << 29}) {
    SmallMap map(100, 24);
    // The box beside it keeps the other one from being drawn in runs.
    drawGroup(map.map(), std::array{Polygon{box(3.5, 1.5, 70.5, 20.5), value}, Polygon{box(80, 1, 90, 21)}},
              {.floor = 1.0f});
    for (std::uint32_t x = 0; x < 80; ++x) {
      EXPECT_EQ(map.covered(x, 10), value < 1 << 29 && x >= 32 && x < 70) << value << ", pixel " << x;
    }
    // What was not drawn is not left behind.
    map.draw(std::array{box(3.5, 1.5, 70.5, 20.5), box(80, 1, 90, 21)}, 1, 2.0f);
    EXPECT_EQ(map.at(10, 10), 2.0f) << value;
    EXPECT_EQ(map.at(72, 10), kNoDepth) << value;
  }
}

// Sheets over each other, most of which face away: however many they are, the windings that they leave are
// known to be none that covers anything, or not known.
TEST(WindingMap, CoversNothingWhereMoreSheetsFaceAwayThanDoNot) {
  using Values = std::vector<std::int32_t>;
  for (const Values& values :
       {Values{7, -20, 3}, {12, -20}, {12, -13}, {8, -9, 1}, {30, -62, 31}, {1 << 20, -(1 << 20)}}) {
    // The box beside them keeps them from being drawn in runs.
    std::vector<Polygon> group{{box(96.5, 1, 99.5, 21)}};
    for (const std::int32_t value : values) {
      group.push_back({box(3.5, 1.5, 70.5, 20.5), value});
    }
    SmallMap map(100, 24);
    drawGroup(map.map(), group, {.floor = 1.0f});
    for (std::uint32_t x = 0; x < 80; ++x) {
      EXPECT_FALSE(map.covered(x, 10)) << values[0] << ", " << values[1] << ", pixel " << x;
    }
    EXPECT_TRUE(map.covered(98, 10));
  }
}

// The least value of a bound in the pixels of a block, and whether the part may be in one of them.
struct BlockBound {
  bool touched = false;
  double least = std::numeric_limits<double>::infinity();
};
BlockBound blockBound(const PartDepth& part, std::int32_t x0, std::int32_t y0) {
  BlockBound bound;
  const PixelRectangle& r = part.rectangle;
  for (std::int32_t y = y0; y < y0 + FarDepths::kHeight; ++y) {
    for (std::int32_t x = x0; x < x0 + FarDepths::kWidth; ++x) {
      bound.touched = bound.touched || (x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1);
      const DepthBound& depth = part.depth;
      const double plane = double{depth.along_x} * x + double{depth.along_y} * y + double{depth.at_origin};
      bound.least = std::min(bound.least, std::max(plane, double{depth.floor}));
    }
  }
  return bound;
}

TEST(WindingMap, GivesPixelsTheFarthestDepthInTheirBlockAndCountsThoseThatComeNearer) {
  std::mt19937 random(29);
  const auto number = test::numbersFrom<float>(random);
  for (int n = 0; n < 60; ++n) {
    const auto width = static_cast<std::int32_t>(1 + random() % 40) * 8,
               height = static_cast<std::int32_t>(1 + random() % 60);
    const PixelRectangle all{0, 0, width, height};
    std::array<std::vector<PartDepth>, 3> parts;
    for (std::vector<PartDepth>& of_group : parts) {
      for (std::size_t k = 1 + random() % 6; k > 0; --k) {
        const auto x = static_cast<std::int32_t>(number(-20.0f, static_cast<float>(width))),
                   y = static_cast<std::int32_t>(number(-20.0f, static_cast<float>(height)));
        of_group.push_back({{x, y, x + static_cast<std::int32_t>(random() % 300),
                             y + static_cast<std::int32_t>(random() % 60)},
                            {number(-0.01f, 0.01f), number(-0.02f, 0.02f), number(1.0f, 3.0f), 0.5f}});
      }
    }
    // The first and the last group are drawn in runs, the second is not: two of its edges begin at one
    // height.
    const double far = 4096.0, right = width + 9.0, top = height + 9.0;
    const std::array polygons{box(-9.0, -9.0, right, top), box(-far, -9.0, 9.0 - far, top)};
    std::vector<float> first;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      SmallMap map(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
      std::vector<BoundaryEdge> edges;
      for (const std::vector<GridPoint>& polygon : polygons) {
        addChain(polygon, 1, map.map().buffer(), edges);
      }
      const auto count = static_cast<std::uint32_t>(edges.size());
      // The right edge of the first polygon lies beyond the map, so that one edge begins it and none ends it.
      const std::array both{BoundaryChain{0, count, 1}};
      const std::array one{BoundaryChain{0, 1, 1}};
      std::vector<float> values;
      for (std::size_t group = 0; group < parts.size(); ++group) {
        std::vector<float> before;
        for (std::int32_t i = 0; i < width * height; ++i) {
          before.push_back(
              map.at(static_cast<std::uint32_t>(i % width), static_cast<std::uint32_t>(i / width)));
        }
        const std::span<const BoundaryChain> boundary =
            group == 1 ? std::span<const BoundaryChain>(both) : std::span<const BoundaryChain>(one);
        std::array<WindingGain, 1> gains;
        map.map().draw(std::array{WindingGroup{all, boundary, parts[group], false}}, edges, gains);
        std::uint32_t nearer = 0;
        values.clear();
        for (std::int32_t y = 0; y < height; ++y) {
          for (std::int32_t x = 0; x < width; ++x) {
            const float old = before[static_cast<std::size_t>(y * width + x)],
                        now = map.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            values.push_back(now);
            double expected = std::numeric_limits<double>::infinity();
            bool some = false;
            for (const PartDepth& part : parts[group]) {
              const BlockBound bound =
                  blockBound(part, x & ~(FarDepths::kWidth - 1), y & ~(FarDepths::kHeight - 1));
              if (bound.touched) {
                some = true;
                expected = std::min(expected, bound.least);
              }
            }
            const double nearest = some ? std::max(expected, double{old}) : double{old};
            ASSERT_NEAR(now, nearest, 1e-5 * std::max(1.0, std::abs(nearest)))
                << n << ", group " << group << ", pixel " << x << ", " << y << ", "
                << hwy::TargetName(target);
            nearer += now > old && now > old * 1.125f ? 1 : 0;
          }
        }
        EXPECT_EQ(gains[0].nearer, nearer) << n << ", " << hwy::TargetName(target);
      }
      first = first.empty() ? values : first;
      ASSERT_EQ(values, first) << n << ", " << hwy::TargetName(target);
    }
  }
}

TEST(WindingMap, CountsOnlyPixelsWhoseChangeHidesSomethingWhereThatIsAskedFor) {
  constexpr std::int32_t kWidth = 72, kHeight = 40, kSquare = SquareDepths::kSize;
  const PixelRectangle all{0, 0, kWidth, kHeight};
  const std::array polygon{Polygon{box(-9.0, -9.0, kWidth + 9.0, kHeight + 9.0)}};
  std::mt19937 random(31);
  const auto number = test::numbersFrom<float>(random);
  for (int n = 0; n < 100; ++n) {
    std::vector<float> old(std::size_t{kWidth + 8} * kHeight);
    std::ranges::generate(old, [&] { return number(0.0f, 4.0f); });
    std::vector<std::array<float, 2>> to_hide;  // by square: reciprocal depths of two boxes
    for (std::int32_t i = 0; i < kWidth * kHeight / (kSquare * kSquare); ++i) {
      to_hide.push_back({number(0.0f, 4.0f), number(0.0f, 4.0f)});
    }
    const float depth = number(1.0f, 4.0f);
    std::uint32_t expected = 0;
    for (std::int32_t y = 0; y < kHeight; ++y) {
      for (std::int32_t x = 0; x < kWidth; ++x) {
        const float before = old[static_cast<std::size_t>(y * (kWidth + 8) + x)];
        const auto [a, b] = to_hide[static_cast<std::size_t>(y / kSquare * (kWidth / kSquare) + x / kSquare)];
        expected += depth > before * 1.125f && depth > std::min(a, b) && before < std::max(a, b) ? 1u : 0u;
      }
    }
    for (const std::int64_t instructions : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(instructions);
      std::vector<float> values = old;
      const DepthTarget target{values.data(), kWidth, kHeight, kWidth + 8};
      WindingMap map;
      map.begin(target);
      std::vector<BoundaryEdge> edges;
      const std::array chains{addChain(polygon[0].points, 1, map.buffer(), edges)};
      const std::array depths{PartDepth{all, {.at_origin = depth, .floor = depth}}};
      // Pixels of squares in which a surface at this depth may gain something.
      const auto wanted = [&] {
        std::uint32_t pixels = 0;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(to_hide.size()); ++i) {
          const std::int32_t x0 = i % (kWidth / kSquare) * kSquare, y0 = i / (kWidth / kSquare) * kSquare;
          const auto [a, b] = to_hide[static_cast<std::size_t>(i)];
          float least = std::numeric_limits<float>::infinity();
          for (std::int32_t y = y0; y < y0 + kSquare; ++y) {
            const auto row = values.begin() + y * (kWidth + 8) + x0;
            least = std::min(least, *std::min_element(row, row + kSquare));
          }
          pixels += least < std::max(a, b) && depth > std::max(std::min(a, b), least) ? kSquare * kSquare : 0;
        }
        return pixels;
      };
      for (const bool flat : {false, true}) {
        values = old;
        NeedMap needs;
        needs.clear(target);
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(to_hide.size()); ++i) {
          const std::int32_t x = i % (kWidth / kSquare) * kSquare, y = i / (kWidth / kSquare) * kSquare;
          for (const float nearest : to_hide[static_cast<std::size_t>(i)]) {
            needs.add({x, y, x + kSquare, y + kSquare}, nearest);
          }
        }
        map.begin(target);
        map.aimAt(&needs);
        EXPECT_EQ(map.wanted(all, depth), wanted()) << "at first";
        std::array<WindingGain, 1> gains;
        map.draw(std::array{WindingGroup{all, chains, depths, flat}}, edges, gains);
        EXPECT_EQ(gains[0].nearer, expected) << n << ", " << flat << ", " << hwy::TargetName(instructions);
        EXPECT_EQ(map.wanted(all, depth), wanted()) << "where it is drawn";
        for (std::size_t i = 0; i < old.size(); ++i) {
          if (i % (kWidth + 8) < kWidth) {
            ASSERT_EQ(values[i], std::max(old[i], depth)) << "all that is covered is drawn";
          }
        }
      }
    }
  }
}

// A triangle or a convex quad of up to a thousand pixels.
Polygon convexPolygon(std::mt19937& random, double width, double height) {
  const auto number = test::numbersFrom<double>(random);
  const double x = number(0.0, width), y = number(0.0, height), reach = std::pow(10.0, number(-0.5, 3.0));
  std::array<double, 4> angles{};
  for (double& angle : angles) {
    angle = number(0.0, 6.283185307179586);
  }
  std::ranges::sort(angles);
  // Corners on an ellipse.
  const double flat = number(0.05, 1.0);
  Polygon polygon;
  for (std::size_t i = random() % 2; i < angles.size(); ++i) {
    polygon.points.push_back({std::nearbyint(kGridStep * (x + reach * std::cos(angles[i]))),
                              std::nearbyint(kGridStep * (y + flat * reach * std::sin(angles[i])))});
  }
  polygon.points.push_back(polygon.points.front());
  return polygon;
}

// However much has been drawn before, and whatever the depths are: nothing that comes nearer is passed over.
TEST(WindingMap, DrawsOverOtherGroupsWhatItDrawsAloneWhereThatIsNearer) {
  std::mt19937 random(37);
  const auto number = test::numbersFrom<float>(random);
  const std::vector<std::int64_t> sets = hwy::SupportedAndGeneratedTargets();
  std::size_t nearer_in_all = 0, not_nearer = 0;
  for (int n = 0; n < 250; ++n) {
    const auto width = static_cast<std::uint32_t>(number(1.0f, 120.0f)),
               height = static_cast<std::uint32_t>(number(1.0f, 40.0f));
    SmallMap map(width, height);
    for (std::size_t group = 0; group < 12; ++group) {
      const test::ForcedInstructionSet forced(sets[group % sets.size()]);
      const std::array polygon{convexPolygon(random, width, height)};
      std::vector<BoundaryEdge> edges;
      const std::array chains{addChain(polygon[0].points, 1, map.map().buffer(), edges)};
      const PixelRectangle all{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
      const DepthBound depth{number(-0.05f, 0.05f), number(-0.05f, 0.05f), number(0.0f, 4.0f), 0.1f};
      const std::array depths{PartDepth{all, depth}};
      const std::array groups{WindingGroup{all, chains, depths, random() % 2 == 0}};
      const std::vector<float> before = map.values();
      SmallMap alone(width, height);
      std::array<WindingGain, 1> gains, gains_alone;
      alone.map().draw(groups, edges, gains_alone);
      map.map().draw(groups, edges, gains);
      std::uint32_t nearer = 0;
      for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
          const float old = before[std::size_t{map.target().stride} * y + x], drawn = alone.at(x, y);
          ASSERT_EQ(map.at(x, y), std::max(old, drawn)) << n << ", group " << group;
          nearer += drawn > old && drawn > old * 1.125f ? 1 : 0;
          not_nearer += alone.covered(x, y) && drawn <= old ? 1 : 0;
        }
      }
      EXPECT_EQ(gains[0].nearer, nearer) << n << ", group " << group;
      nearer_in_all += nearer;
    }
  }
  EXPECT_GT(nearer_in_all, 100'000u);
  EXPECT_GT(not_nearer, 100'000u);
}

TEST(WindingMap, CoversTheSameOfConvexPolygonsInRunsAndInTiles) {
  std::mt19937 random(17);
  std::size_t covered = 0;
  for (int n = 0; n < 20'000; ++n) {
    const auto width = static_cast<std::uint32_t>(1 + random() % 140),
               height = static_cast<std::uint32_t>(1 + random() % 40);
    const Polygon polygon = convexPolygon(random, width, height);
    // One like it to the left of the map begins at the same heights, and adds to no winding here.
    Polygon beside = polygon;
    for (GridPoint& point : beside.points) {
      point.x -= 4096.0 * kGridStep;
    }
    SmallMap runs(width, height), tiles(width, height);
    drawGroup(runs.map(), std::array{polygon}, {.along_x = 0.01f, .along_y = -0.02f, .at_origin = 3.0f});
    drawGroup(tiles.map(), std::array{polygon, beside},
              {.along_x = 0.01f, .along_y = -0.02f, .at_origin = 3.0f});
    std::size_t lost = 0, different = 0;
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        covered += runs.covered(x, y) ? 1 : 0;
        lost += tiles.covered(x, y) && !runs.covered(x, y) ? 1 : 0;
        different += runs.covered(x, y) && tiles.covered(x, y) && runs.at(x, y) != tiles.at(x, y) ? 1 : 0;
      }
    }
    EXPECT_EQ(lost, 0u) << "polygon " << n;
    EXPECT_EQ(different, 0u) << "polygon " << n;
  }
  EXPECT_GT(covered, 1'000'000u);
}

TEST(WindingMap, LosesNoRowToALevelStep) {
  // A wall with a step on its left side, one on its right side, and its lower and upper borders, all of which
  // lie on the grid of pixels.
  const double s = kGridStep;
  SmallMap map(64, 24);
  map.draw(std::array{std::vector<GridPoint>{{10 * s, 4 * s},
                                             {50 * s, 4 * s},
                                             {50 * s, 12 * s + 9},
                                             {40 * s, 12 * s + 9},
                                             {40 * s, 20 * s},
                                             {20 * s, 20 * s},
                                             {20 * s, 9 * s + 77},
                                             {10 * s, 9 * s + 77},
                                             {10 * s, 4 * s}}},
           1, 1.0f);
  for (std::uint32_t y = 5; y < 19; ++y) {
    for (std::uint32_t x = 21; x < 39; ++x) {
      EXPECT_TRUE(map.covered(x, y)) << x << ", " << y;
    }
  }
}

TEST(WindingMap, CoversTheBarsOfAGrilleAndNotWhatIsBetweenThem) {
  SmallMap map(200, 30);
  std::vector<std::vector<GridPoint>> bars;
  for (int i = 0; i < 40; ++i) {
    bars.push_back(box(5.0 * i + 0.5, -3.0, 5.0 * i + 3.5, 40.0));
  }
  map.draw(bars, 1, 1.0f);
  for (std::uint32_t x = 0; x < 200; ++x) {
    EXPECT_EQ(map.covered(x, 17), x % 5 == 1 || x % 5 == 2) << x;
  }
}

// A closed polygon of any form, from a tenth of a pixel to a million pixels wide and high, some of whose
// corners lie on borders and middles of rows and columns.
Polygon anyPolygon(std::mt19937& random, double width, double height) {
  const auto number = test::numbersFrom<double>(random);
  const auto size = [&] { return kGridStep * std::pow(10.0, number(-1.0, random() % 3 == 0 ? 6.0 : 3.0)); };
  const double x = number(0.0, width * kGridStep), y = number(0.0, height * kGridStep), size_x = size(),
               size_y = size();
  const auto near = [&](double middle, double reach, double unit) {
    const double at = std::nearbyint(middle + number(-reach, reach));
    return random() % 3 == 0 ? std::nearbyint(at / unit) * unit : at;
  };
  Polygon polygon;
  const std::size_t corners = 3 + random() % 3;
  for (std::size_t i = 0; i < corners; ++i) {
    polygon.points.push_back({near(x, size_x, kGridStep), near(y, size_y, 0.5 * kGridStep)});
  }
  polygon.points.push_back(polygon.points.front());
  polygon.value = random() % 4 == 0 ? -1 : random() % 4 == 0 ? 2 : 1;
  return polygon;
}

TEST(WindingMap, DrawsTheSameHoweverItsRowsAreDivided) {
  std::mt19937 random(23);
  const auto divided = [&random](std::uint32_t count, const RangeBody& body) {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t i = 1; i <= count; ++i) {
      ends.insert(ends.end(), random() % 3, i);  // twice: a range may be empty
    }
    ends.push_back(count);
    for (std::size_t i = ends.size(); i > 0; --i) {  // the last ones first
      body(i > 1 ? ends[i - 2] : 0, ends[i - 1]);
    }
  };
  for (int n = 0; n < 300; ++n) {
    const auto width = static_cast<std::uint32_t>(1 + random() % 140),
               height = static_cast<std::uint32_t>(1 + random() % 90);
    SmallMap whole(width, height), bands(width, height);
    std::vector<BoundaryEdge> edges;
    std::vector<BoundaryChain> chains;
    const PixelRectangle all{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    for (std::uint32_t k = 0; k < 6; ++k) {
      const Polygon polygon =
          k % 2 == 0 ? convexPolygon(random, width, height) : anyPolygon(random, width, height);
      chains.push_back(addChain(polygon.points, polygon.value, whole.map().buffer(), edges));
    }
    const std::array depths{PartDepth{all, {.along_x = 0.01f, .at_origin = 1.0f}},
                            PartDepth{all, {.along_y = 0.02f, .at_origin = 1.0f}}};
    const std::span<const BoundaryChain> boundary(chains);
    const std::array groups{WindingGroup{all, boundary.subspan(0, 1), depths, true},
                            WindingGroup{all, boundary.subspan(1, 2), depths, false},
                            WindingGroup{all, boundary.subspan(3, 3), std::span(depths).subspan(1), true}};
    std::array<WindingGain, 3> gains, other_gains;
    whole.map().draw(groups, edges, gains);
    bands.map().draw(groups, edges, other_gains, divided);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      EXPECT_EQ(gains[i].nearer, other_gains[i].nearer) << n;
      EXPECT_EQ(gains[i].tiles, other_gains[i].tiles) << n;
    }
    for (std::uint32_t i = 0; i < width * height; ++i) {
      ASSERT_EQ(whole.at(i % width, i / width), bands.at(i % width, i / width)) << n;
    }
  }
}

// The winding of polygons about a point halfway between grid points, exactly.
std::int32_t windingOf(std::span<const Polygon> polygons, std::int64_t x, std::int64_t y) {
  std::int32_t winding = 0;
  for (const Polygon& polygon : polygons) {
    for (std::size_t i = 1; i < polygon.points.size(); ++i) {
      // In halves of grid units, from the point.
      const std::int64_t ax = 2 * static_cast<std::int64_t>(polygon.points[i - 1].x) - (2 * x + 1),
                         ay = 2 * static_cast<std::int64_t>(polygon.points[i - 1].y) - (2 * y + 1),
                         bx = 2 * static_cast<std::int64_t>(polygon.points[i].x) - (2 * x + 1),
                         by = 2 * static_cast<std::int64_t>(polygon.points[i].y) - (2 * y + 1);
      if ((ay < 0) != (by < 0)) {
        // The edge passes the point's row to its left.
        const bool left = (ax * by - bx * ay < 0) == (by > 0);
        winding += left ? (by < 0 ? polygon.value : -polygon.value) : 0;
      }
    }
  }
  return winding;
}

TEST(WindingMap, CoversOnlyPixelsInWhichTheWindingOfAnyPolygonsIsPositive) {
  std::mt19937 random(3);
  std::size_t covered = 0, wrong = 0;
  for (int n = 0; n < 30'000; ++n) {
    const auto width = static_cast<std::uint32_t>(1 + random() % 70),
               height = static_cast<std::uint32_t>(1 + random() % 12);
    SmallMap map(width, height);
    std::vector<Polygon> polygons;
    for (std::size_t k = 1 + random() % 3; k > 0; --k) {
      polygons.push_back(anyPolygon(random, width, height));
    }
    drawGroup(map.map(), polygons, {.floor = 1.0f});
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        if (!map.covered(x, y)) {
          continue;
        }
        ++covered;
        for (const std::int64_t within_x : {0, 60, 127, 200, 255}) {
          for (const std::int64_t within_y : {0, 60, 127, 200, 255}) {
            wrong += windingOf(polygons, std::int64_t{kGridStep} * x + within_x,
                               std::int64_t{kGridStep} * y + within_y) < 1
                         ? 1
                         : 0;
          }
        }
      }
    }
    ASSERT_EQ(wrong, 0u) << "map " << n;
  }
  EXPECT_GT(covered, 100'000u);
}

TEST(WindingMap, HasTheSameBitsOfAnyPolygonsWithEveryInstructionSet) {
  std::mt19937 random(4);
  for (int n = 0; n < 3'000; ++n) {
    const auto width = static_cast<std::uint32_t>(1 + random() % 70),
               height = static_cast<std::uint32_t>(1 + random() % 12);
    const std::array polygons{anyPolygon(random, width, height), anyPolygon(random, width, height)};
    std::vector<float> first;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      SmallMap map(width, height);
      drawGroup(map.map(), polygons, {.along_x = 0.1f, .along_y = -0.3f, .at_origin = 1.0f, .floor = 0.5f});
      std::vector<float> values;
      for (std::uint32_t i = 0; i < width * height; ++i) {
        values.push_back(map.at(i % width, i / width));
      }
      first = first.empty() ? values : first;
      ASSERT_EQ(values, first) << "map " << n << ", " << hwy::TargetName(target);
    }
  }
}

TEST(WindingMap, HidesARectangleIfAllItsValuesAreNearer) {
  std::mt19937 random(5);
  const auto number = test::numbersFrom<double>(random);
  for (int n = 0; n < 60; ++n) {
    SmallMap map(static_cast<std::uint32_t>(number(1.0, 150.0)),
                 static_cast<std::uint32_t>(number(1.0, 60.0)));
    const double width = map.target().width, height = map.target().height;
    // In every second map the depths differ little.
    const double farthest = n % 2 == 0 ? 3.0 : 1.1;
    std::size_t hidden = 0;
    for (int step = 0; step < 40; ++step) {
      const double x0 = number(-20.0, width), y0 = number(-20.0, height);
      map.draw(std::array{box(std::floor(x0), std::floor(y0), std::ceil(x0 + number(1.0, 90.0)),
                              std::ceil(y0 + number(1.0, 60.0)))},
               1, static_cast<float>(number(1.0, farthest)));
      for (int query = 0; query < 5; ++query) {
        const auto from_x = static_cast<std::int32_t>(number(0.0, width)),
                   from_y = static_cast<std::int32_t>(number(0.0, height));
        const PixelRectangle r{from_x, from_y, static_cast<std::int32_t>(number(from_x + 1.0, width + 1.0)),
                               static_cast<std::int32_t>(number(from_y + 1.0, height + 1.0))};
        const auto than = static_cast<float>(number(0.9, 0.5 + 0.5 * farthest));
        bool all = true;
        for (std::int32_t y = r.y0; y < r.y1; ++y) {
          for (std::int32_t x = r.x0; x < r.x1; ++x) {
            all = all && map.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)) > than;
          }
        }
        hidden += all ? 1 : 0;
        ASSERT_EQ(map.map().hides(r, than), all) << "map " << n << ", step " << step;
      }
    }
    EXPECT_GT(hidden, 0u) << n;
    map.clear();
    EXPECT_FALSE(map.map().hides({0, 0, 1, 1}, 0.5f)) << n;
  }
}

}  // namespace
}  // namespace sightline::occlusion
