// How far edges are swept as the eye moves, against points of them as viewers of a region see them.

#include "src/occlusion/surfaces/swept_lines.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "src/occlusion/surfaces/winding_map.h"
#include "tests/occlusion/random_views.h"
#include "tests/support/instruction_sets.h"

namespace sightline::occlusion {
namespace {

constexpr std::size_t kLines = 29;  // in each region; not a multiple of the lanes

struct SweptCase {
  View view;
  scene::PixelView pixels;
  double clip_depth = 0.0;
  CameraLines lines;
};

View perspectiveView(test::ViewRandom& random) {
  View view = test::randomView(random);
  view.orthographic = false;
  const double most = random.below(2) == 0 ? 0.0 : 1.5;
  view.shift_x = std::clamp(view.shift_x, -most, most);
  view.shift_y = std::clamp(view.shift_y, -most, most);
  return view;
}

// Regions of one point, a line, a triangle or around them: sideways, forwards and backwards.
ViewerRegion randomRegion(test::ViewRandom& random, const View& view) {
  ViewerRegion region;
  const double reach = random.sized(1e-4, 30.0);
  for (Vec3d& offset : region.offsets) {
    const Vec3d axes[] = {view.right, view.up, view.forward};
    const std::uint32_t kind = random.below(8);
    offset = kind == 0  ? Vec3d()
             : kind < 4 ? axes[kind - 1] * random.in(-reach, reach)
                        : view.right * random.in(-reach, reach) + view.up * random.in(-reach, reach) +
                              view.forward * random.in(-reach, reach);
  }
  region.radius = random.below(2) == 0 ? 0.0 : reach * random.sized(1e-4, 2.0);
  region.near_distance = 1e-6;  // so that it is a region also where it is one point
  return region;
}

// A point not nearer than the clip depth; camera space. Some are at the clip depth, at a place in the buffer,
// or far beside the eye.
Vec3d randomPoint(test::ViewRandom& random, const View& view, double clip_depth) {
  const double z = random.below(6) == 0   ? clip_depth
                   : random.below(3) == 0 ? clip_depth * random.sized(1.0, 10.0)
                                          : random.sized(clip_depth, 1e4);
  if (random.below(3) == 0) {
    const double x = random.sized(0.01, 100.0), y = random.sized(0.01, 100.0);
    return {random.below(2) == 0 ? x : -x, random.below(2) == 0 ? y : -y, z};
  }
  const double wide = random.below(3) == 0 ? 4.0 : 1.0;
  return {(random.in(-wide, wide) + view.shift_x) * view.tan_half_fovy * view.aspect * z,
          (random.in(-wide, wide) + view.shift_y) * view.tan_half_fovy * z, z};
}

SweptCase randomCase(std::uint64_t seed) {
  test::ViewRandom random(seed);
  SweptCase made;
  made.view = perspectiveView(random);
  constexpr std::uint32_t kSizes[][2] = {{320, 180}, {16, 9}, {1, 1}, {1024, 64}};
  const std::uint32_t(&size)[2] = kSizes[random.below(4)];
  made.pixels = scene::PixelView(made.view, size[0], size[1], randomRegion(random, made.view));
  made.clip_depth = made.view.z_near * (1.0 + 1e-6);
  made.lines.reserve(kLines);
  for (std::size_t i = 0; i < kLines; ++i) {
    const Vec3d from = randomPoint(random, made.view, made.clip_depth);
    Vec3d to = randomPoint(random, made.view, made.clip_depth);
    const std::uint32_t kind = random.below(6);
    if (kind < 2) {  // a short one
      to = from + random.point(0.1 * from.z);
      to.z = std::max(to.z, made.clip_depth);
    }
    if (kind == 2) {  // level in the buffer
      to.y = from.y / from.z * to.z;
    } else if (kind == 3) {  // upright in it
      to.x = from.x / from.z * to.z;
    }
    made.lines.set(i, from, to);
  }
  return made;
}

// In 256ths of a pixel.
GridPoint imageOf(const scene::PixelView& view, const Vec3d& point) {
  return {(view.middle_x + view.scale_x * point.x / point.z) * kGridStep,
          (view.middle_y + view.scale_y * point.y / point.z) * kGridStep};
}
GridPoint rounded(const GridPoint& p) {
  return {std::nearbyint(p.x), std::nearbyint(p.y)};
}

// A viewer of the region, from the eye; camera space.
Vec3d viewerOf(test::ViewRandom& random, const ViewerRegion& region) {
  double first = random.in(0.0, 1.0), second = random.in(0.0, 1.0 - first);
  const std::uint32_t kind = random.below(4);
  if (kind < 3) {
    first = kind == 1 ? 1.0 : 0.0;
    second = kind == 2 ? 1.0 : 0.0;
  }
  const Vec3d around = random.point(1.0);
  return region.offsets[0] * first + region.offsets[1] * second +
         around * (region.radius * (1.0 - 1e-12) / std::max(length(around), 1e-3));
}

GridLines imagesOf(const scene::PixelView& view, const CameraLines& lines, std::size_t count) {
  GridLines images;
  images.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    images.set(i, rounded(imageOf(view, lines.from.point(i))), rounded(imageOf(view, lines.to.point(i))));
  }
  return images;
}

struct Counts {
  std::size_t points = 0, unswept = 0, passed = 0;
};

// Between which places of a row a prepared edge may touch the pixels of a buffer; none of them, if the first
// is the greater one. See EdgeRows.
std::pair<double, double> placesIn(const BoundaryEdge& edge, double width, std::int32_t row) {
  if (!edge.matters || row < edge.first_row || row > edge.last_row) {
    return {1.0, 0.0};
  }
  const std::pair<double, double> whole{edge.left, edge.right};
  if (edge.kind == EdgeSlope::kLevel) {
    return whole;
  }
  const double origin = edge.first_row >> kTileHeightShift << kTileHeightShift;
  const auto place = [&](double rows) {
    return std::clamp(edge.x + (rows - origin) * kGridStep * edge.slope, -1.0 * BoundaryEdge::kBeyond,
                      width * kGridStep + BoundaryEdge::kBeyond);
  };
  const double below = place(row), above = place(row + 1.0);
  return {std::max(whole.first, std::min(below, above) - static_cast<double>(edge.reach_left)),
          std::min(whole.second, std::max(below, above) + static_cast<double>(edge.reach_right))};
}

// Looks where points of a line are in the buffer as they move. `edge` was prepared from its line on the grid.
void judge(const SweptCase& made, std::size_t i, const GridSweeps& sweeps, const BoundaryEdge& edge,
           test::ViewRandom& random, Counts& counts, const std::string& where) {
  const scene::PixelView& view = made.pixels;
  const Vec3d from = made.lines.from.point(i), to = made.lines.to.point(i);
  const GridPoint begin = rounded(imageOf(view, from)), end = rounded(imageOf(view, to));
  const double height = end.y - begin.y, slope = (end.x - begin.x) / height;
  // What double precision may take away of these places.
  const double rounding =
      1e-9 * (1.0 + std::max({std::abs(begin.x), std::abs(end.x), std::abs(begin.y), std::abs(end.y)}));
  for (int n = 0; n < 60; ++n) {
    const double along = n % 4 == 0 ? 0.0 : n % 4 == 1 ? 1.0 : random.in(0.0, 1.0);
    const Vec3d point = from + (to - from) * along -
                        viewerOf(random, view.viewers) * (n % 3 == 0 ? 1.0 : random.in(0.0, 1.0));
    if (!(point.z > 0.0)) {
      continue;
    }
    const GridPoint at = imageOf(view, point);
    if (!(at.x >= 0.0 && at.x < view.width * kGridStep && at.y >= 0.0 && at.y < view.height * kGridStep)) {
      continue;
    }
    ++counts.points;
    EXPECT_GE(at.x, std::min(begin.x, end.x) - sweeps.left[i] - rounding) << where;
    EXPECT_LE(at.x, std::max(begin.x, end.x) + sweeps.right[i] + rounding) << where;
    EXPECT_GE(at.y, std::min(begin.y, end.y) - sweeps.down[i] - rounding) << where;
    EXPECT_LE(at.y, std::max(begin.y, end.y) + sweeps.up[i] + rounding) << where;
    if (height != 0.0) {
      const double up = (at.y - begin.y) / height, across = at.x - begin.x - (end.x - begin.x) * up;
      const double of_slope = rounding * (1.0 + std::abs(slope)) * (1.0 + std::abs(up));
      EXPECT_GE(across, -sweeps.left_of_line[i] - of_slope) << where;
      EXPECT_LE(across, sweeps.right_of_line[i] + of_slope) << where;
    }
    const auto [least, most] =
        placesIn(edge, view.width, static_cast<std::int32_t>(std::floor(at.y / kGridStep)));
    EXPECT_TRUE(at.x >= least && at.x <= most) << where;
  }
}

TEST(SweptLines, AreWithinTheirSweepsForAllViewers) {
  Counts counts;
  for (std::uint64_t seed = 0; seed < 3000 && !::testing::Test::HasFailure(); ++seed) {
    const SweptCase made = randomCase(seed);
    if (!made.pixels.sane()) {
      continue;
    }
    const GridLines grid = imagesOf(made.pixels, made.lines, kLines);
    GridSweeps sweeps;
    findSweeps(made.pixels, made.clip_depth, made.lines, grid, kLines, sweeps);
    std::vector<BoundaryEdge> edges(kLines);
    prepareEdges(
        grid, &sweeps,
        {static_cast<std::int32_t>(made.pixels.width), static_cast<std::int32_t>(made.pixels.height)}, edges);
    test::ViewRandom random(~seed);
    for (std::size_t i = 0; i < kLines; ++i) {
      const bool unswept = sweeps.left[i] == 0.0 && sweeps.right[i] == 0.0 && sweeps.down[i] == 0.0 &&
                           sweeps.up[i] == 0.0 && sweeps.left_of_line[i] == 0.0 &&
                           sweeps.right_of_line[i] == 0.0;
      counts.unswept += unswept ? 1 : 0;
      counts.passed += sweeps.left_of_line[i] > BoundaryEdge::kBeyond ? 1 : 0;
      const std::size_t before = counts.points;
      judge(made, i, sweeps, edges[i], random, counts,
            "seed " + std::to_string(seed) + ", line " + std::to_string(i));
      EXPECT_TRUE(!unswept || counts.points == before) << "seed " << seed << ", line " << i;
    }
  }
  EXPECT_GT(counts.points, 400'000u);
  EXPECT_GT(counts.unswept, 5'000u);
  EXPECT_GT(counts.passed, 2'000u);
}

// Beyond the ends of an edge its line is known the less the farther it goes, and may lie between a pixel's
// centre and other points of it. Rows that the edge crosses from border to border, wherever its ends really
// are, are another matter.
TEST(SweptEdges, LinesThatMeetAPixelBeyondTheirEndsAreTooNearToItsCentre) {
  constexpr std::int32_t kSize = 24;
  constexpr double kEnd = kSize * kGridStep, kMargin = BoundaryEdge::kMargin;
  std::size_t met = 0, level = 0;
  for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
    test::ViewRandom random(seed);
    const auto place = [&] {
      return GridPoint{std::floor(random.in(0, kEnd)), std::floor(random.in(0, kEnd))};
    };
    const GridPoint from = place();
    GridPoint to = place();
    if (random.below(2) == 0) {  // shorter than a pixel or two
      const double size = random.sized(2.0, 600.0);
      to = rounded({from.x + random.in(-size, size), from.y + random.in(-size, size)});
    }
    to.y = random.below(6) == 0 ? from.y : to.y;
    if (from.x == to.x && from.y == to.y) {
      continue;
    }
    const double most = random.sized(1.0, 4000.0);
    GridSweeps sweeps;
    sweeps.reserve(1);
    sweeps.left[0] = random.in(1.0, most);
    sweeps.right[0] = random.in(1.0, most);
    sweeps.down[0] = random.in(1.0, most);
    sweeps.up[0] = random.in(1.0, most);
    sweeps.left_of_line[0] = sweeps.right_of_line[0] = 3.0 * most;
    GridLines lines;
    lines.reserve(1);
    lines.set(0, from, to);
    std::vector<BoundaryEdge> edges(1);
    prepareEdges(lines, &sweeps, {kSize, kSize}, edges);
    const BoundaryEdge& edge = edges[0];
    // A line through ends that are off by up to the margin.
    const auto moved = [&](const GridPoint& p) {
      return GridPoint{p.x + random.in(-kMargin, kMargin), p.y + random.in(-kMargin, kMargin)};
    };
    const GridPoint a = moved(from), b = moved(to);
    const auto sideOf = [&](double x, double y) { return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x); };
    for (std::int32_t row = edge.first_row; row <= std::min<std::int32_t>(edge.last_row, kSize - 1); ++row) {
      if (row >= edge.first_whole && row < edge.end_whole) {
        EXPECT_GE(row * kGridStep, std::min(from.y, to.y) + kMargin) << "seed " << seed;
        EXPECT_LE((row + 1) * kGridStep, std::max(from.y, to.y) - kMargin) << "seed " << seed;
        continue;
      }
      for (std::int32_t column = 0; column < kSize; ++column) {
        const double x = column * kGridStep, y = row * kGridStep, middle_x = x + 0.5 * kGridStep,
                     middle_y = y + 0.5 * kGridStep;
        if (x > edge.right || x + kGridStep < edge.left) {
          continue;  // the edge cannot touch it
        }
        const double corners[] = {sideOf(x, y), sideOf(x + kGridStep, y), sideOf(x, y + kGridStep),
                                  sideOf(x + kGridStep, y + kGridStep)};
        if (*std::ranges::min_element(corners) > 0.0 || *std::ranges::max_element(corners) < 0.0) {
          continue;
        }
        ++met;
        if (edge.kind == EdgeSlope::kLevel) {
          ++level;
          EXPECT_LE(std::abs(middle_y - edge.x), static_cast<double>(edge.end_doubt)) << "seed " << seed;
        } else {
          const double crossing = from.x + (middle_y - from.y) * edge.slope;
          EXPECT_LE(std::abs(middle_x - crossing), static_cast<double>(edge.end_doubt)) << "seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(met, 50'000u);
  EXPECT_GT(level, 5'000u);
}

// A surface that covers the whole buffer, with a slit whose two sides are one edge there and back: its
// windings are everywhere 1, and in a pixel that the edge may touch it takes away 1 in one of its directions.
TEST(SweptEdges, ThePixelsThatAreNotCoveredAreThoseThatTheEdgeMayTouch) {
  constexpr std::int32_t kWidth = 200, kHeight = 20, kStride = kWidth + 8;
  constexpr std::size_t kThere = 8, kBack = 9, kEdges = 10;
  constexpr double kEndX = kWidth * kGridStep, kEndY = kHeight * kGridStep, kRounding = 4.0, kAround = 1000.0;
  const float open = -std::numeric_limits<float>::max();
  std::vector<float> values(std::size_t{kStride} * kHeight);
  WindingMap map;
  // Around the buffer, and once more to its left: two edges that begin the group at one height, so that it is
  // not drawn in runs, which may leave more open.
  const auto rectangle = [&](double left, double right) {
    return std::array{GridPoint{left, -kAround}, GridPoint{right, -kAround},
                      GridPoint{right, kEndY + kAround}, GridPoint{left, kEndY + kAround}};
  };
  const std::array borders{rectangle(-kAround, kEndX + kAround), rectangle(-3.0 * kAround, -2.0 * kAround)};
  std::size_t touched = 0, untouched = 0, far = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    test::ViewRandom random(seed);
    const auto about = [&](double end) {
      const double beyond = random.below(3) == 0 ? random.sized(1.0, 1e7) : 0.0;
      return std::floor(random.in(-beyond, end + beyond));
    };
    const GridPoint from{about(kEndX), about(kEndY)};
    const GridPoint to{about(kEndX), random.below(8) == 0 ? from.y : about(kEndY)};
    GridSweeps sweeps;
    sweeps.reserve(kEdges);
    const double least_sweep = random.below(3) == 0 ? 1e6 : 1.0;
    for (std::vector<double>* side : {&sweeps.left, &sweeps.right, &sweeps.down, &sweeps.up,
                                      &sweeps.left_of_line, &sweeps.right_of_line}) {
      std::fill_n(side->begin(), kEdges, 0.0);
      (*side)[kThere] = (*side)[kBack] = random.below(6) == 0 ? 0.0 : random.sized(least_sweep, 1e8);
    }
    GridLines lines;
    lines.reserve(kEdges);
    for (std::size_t i = 0; i < kThere; ++i) {
      lines.set(i, borders[i / 4][i % 4], borders[i / 4][(i + 1) % 4]);
    }
    lines.set(kThere, from, to);
    lines.set(kBack, to, from);
    std::vector<BoundaryEdge> edges(kEdges);
    prepareEdges(lines, &sweeps, {kWidth, kHeight}, edges);
    const BoundaryEdge edge = edges[kThere];
    std::erase_if(edges, [](const BoundaryEdge& e) { return !e.matters; });
    const std::array chains{BoundaryChain{0, static_cast<std::uint32_t>(edges.size()), 1}};
    const PixelRectangle all{0, 0, kWidth, kHeight};
    const std::array depths{PartDepth{all, {.floor = 1.0f}}};
    const std::array groups{WindingGroup{all, chains, depths, true}};
    std::array<WindingGain, 1> gains;
    std::ranges::fill(values, open);
    map.begin({values.data(), kWidth, kHeight, kStride});
    map.draw(groups, edges, gains);
    // Far beside the buffer an edge may be drawn into tiles that it does not touch.
    const double at_end = from.x + (kEndY - from.y) * edge.slope, at_begin = from.x - from.y * edge.slope;
    const bool near = std::max(std::abs(at_end), std::abs(at_begin)) < BoundaryEdge::kBeyond;
    far += near ? 0 : 1;
    for (std::int32_t row = 0; row < kHeight; ++row) {
      const auto [least, most] = placesIn(edge, kWidth, row);
      for (std::int32_t column = 0; column < kWidth; ++column) {
        const double x = column * kGridStep;
        const bool covered = values[static_cast<std::size_t>(row * kStride + column)] > open;
        if (x + kGridStep - kRounding >= least && x + kRounding <= most) {
          ++touched;
          EXPECT_FALSE(covered) << "seed " << seed << ", pixel " << column << ' ' << row;
        } else if (near && (x + kGridStep + kRounding < least || x - kRounding > most)) {
          ++untouched;
          EXPECT_TRUE(covered) << "seed " << seed << ", pixel " << column << ' ' << row;
        }
      }
    }
  }
  EXPECT_GT(touched, 1'000'000u);
  EXPECT_GT(untouched, 1'000'000u);
  EXPECT_GT(far, 300u);
}

// Otherwise, sweeps that are large everywhere would pass the test above.
TEST(SweptLines, AreTightAroundWhatIsSeenFarAway) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 1.0;
  view.aspect = 1.0;
  view.z_near = 0.1;
  constexpr std::uint32_t kSize = 200;
  // The viewer may be up to a metre to the right: what is 10 metres away is swept by 10 pixels to the left.
  const scene::PixelView pixels(view, kSize, kSize, {.offsets = {Vec3d(1, 0, 0), Vec3d()}});
  CameraLines lines;
  lines.reserve(2);
  lines.set(0, {0, -1, 10}, {0, 1, 10});
  lines.set(1, {30, -1, 10}, {30, 1, 10});  // to the right of the buffer for all of them
  GridSweeps sweeps;
  findSweeps(pixels, 0.1, lines, imagesOf(pixels, lines, 2), 2, sweeps);
  constexpr double kSpare = 2.0;  // 256ths of a pixel, for rounding
  for (const std::vector<double>* side : {&sweeps.left, &sweeps.left_of_line}) {
    EXPECT_GE((*side)[0], 10.0 * kGridStep);
    EXPECT_LE((*side)[0], 10.0 * kGridStep + kSpare);
  }
  for (const std::vector<double>* side : {&sweeps.right, &sweeps.right_of_line, &sweeps.down, &sweeps.up}) {
    EXPECT_LE((*side)[0], kSpare);
  }
  for (const std::vector<double>* side :
       {&sweeps.left, &sweeps.right, &sweeps.down, &sweeps.up, &sweeps.left_of_line, &sweeps.right_of_line}) {
    EXPECT_EQ((*side)[1], 0.0);
  }
}

TEST(SweptLines, AreTheSameWithEveryInstructionSet) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
  const auto bitsOf = [](const GridSweeps& sweeps) {
    std::vector<std::uint64_t> bits;
    for (const std::vector<double>* side : {&sweeps.left, &sweeps.right, &sweeps.down, &sweeps.up,
                                            &sweeps.left_of_line, &sweeps.right_of_line}) {
      for (std::size_t i = 0; i < kLines; ++i) {
        bits.push_back(std::bit_cast<std::uint64_t>((*side)[i]));
      }
    }
    return bits;
  };
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const SweptCase made = randomCase(seed);
    const GridLines grid = imagesOf(made.pixels, made.lines, kLines);
    GridSweeps sweeps;
    findSweeps(made.pixels, made.clip_depth, made.lines, grid, kLines, sweeps);
    const std::vector<std::uint64_t> first = bitsOf(sweeps);
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      findSweeps(made.pixels, made.clip_depth, made.lines, grid, kLines, sweeps);
      EXPECT_EQ(bitsOf(sweeps), first) << "seed " << seed << ", " << hwy::TargetName(target);
    }
  }
}

}  // namespace
}  // namespace sightline::occlusion
