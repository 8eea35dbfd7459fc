// Parts that touch or overlap a little have an order: that of rays.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "sightline/layers/layer_sorter.h"
#include "src/layers/hull/hull_box.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using shapes::Points;
using shapes::Random;

// A box in a space of its own, placed by an affine matrix.
struct Block {
  Vec3d low, high;
  Mat4 world_from_block;
};

Points cornersOf(const Block& block) {
  Points corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back({(i & 1) != 0 ? block.high.x : block.low.x, (i & 2) != 0 ? block.high.y : block.low.y,
                       (i & 4) != 0 ? block.high.z : block.low.z});
  }
  return corners;
}

Mat4 turned(Random& random, double scale) {
  View axes;
  setOrientation(axes, random.direction(), random.direction());
  Mat4 m;
  const std::array columns{axes.right, axes.up, axes.forward * -1.0};
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      m(row, column) = columns[static_cast<std::size_t>(column)][row] * scale;
    }
  }
  return m;
}

struct Stretch {
  double enter = 0.0, leave = 0.0;
};

// Where a ray is in a block; by slabs in the block's own space.
std::optional<Stretch> hit(const Block& block, const Vec3d& from, const Vec3d& direction) {
  const Mat4& m = block.world_from_block;
  const Vec3d x{m(0, 0), m(1, 0), m(2, 0)}, y{m(0, 1), m(1, 1), m(2, 1)}, z{m(0, 2), m(1, 2), m(2, 2)};
  const double volume = dot(x, cross(y, z));
  const auto back = [&](const Vec3d& v) {
    return Vec3d(dot(cross(y, z), v), dot(cross(z, x), v), dot(cross(x, y), v)) / volume;
  };
  const Vec3d origin = back(from - Vec3d(m(0, 3), m(1, 3), m(2, 3))), way = back(direction);
  Stretch stretch{0.0, 1e30};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (block.low[axis] - origin[axis]) / way[axis],
                 b = (block.high[axis] - origin[axis]) / way[axis];
    stretch.enter = std::max(stretch.enter, std::min(a, b));
    stretch.leave = std::min(stretch.leave, std::max(a, b));
  }
  return stretch.enter < stretch.leave ? std::optional(stretch) : std::nullopt;
}

struct Blocks {
  std::vector<Block> blocks;
  LayerSorter sorter;

  explicit Blocks(double tolerance) : sorter(settingsWith(tolerance)) {}
  static LayerSettings settingsWith(double tolerance) {
    LayerSettings settings;
    settings.contact_tolerance = tolerance;
    return settings;
  }
  void add(const Block& block) {
    const HullId hull = sorter.addHull(*buildHull(cornersOf(block)));
    sorter.setTransform(sorter.addPart(std::span(&hull, 1)), block.world_from_block);
    blocks.push_back(block);
  }
  void addAll(std::span<const Block> more) {
    for (const Block& block : more) {
      add(block);
    }
  }

  std::size_t groups(const View& view) { return sorter.update(view).groups(); }

  // Rays from the eye through random points of the blocks: what a ray leaves before it enters another is not
  // drawn behind that one. slack: by which stretches may overlap, in parts of the way to them.
  std::size_t judge(const View& view, Random& random, int rays, double slack) {
    const LayerOrder& order = sorter.update(view);
    std::vector<std::size_t> group_of(blocks.size());
    for (std::size_t i = 0; i < order.groups(); ++i) {
      for (const PartId part : order.group(i)) {
        group_of[part.value] = i;
      }
    }
    std::size_t pairs = 0;
    for (int i = 0; i < rays; ++i) {
      const Block& aim =
          blocks[static_cast<std::size_t>(random.number(0.0, 0.999999) * static_cast<double>(blocks.size()))];
      const Vec3d at = transformPoint(aim.world_from_block, random.point(aim.low, aim.high));
      const Vec3d from = view.orthographic ? at - view.forward * 1000.0 : view.eye, way = at - from;
      struct Hit {
        std::size_t block;
        Stretch stretch;
      };
      std::vector<Hit> hits;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (const std::optional<Stretch> stretch = hit(blocks[b], from, way)) {
          hits.push_back({b, *stretch});
        }
      }
      for (const Hit& a : hits) {
        for (const Hit& b : hits) {
          if (a.stretch.leave <= b.stretch.enter + slack && a.stretch.leave - a.stretch.enter > 4.0 * slack &&
              b.stretch.leave - b.stretch.enter > 4.0 * slack) {
            ++pairs;
            EXPECT_LE(group_of[a.block], group_of[b.block]) << a.block << " before " << b.block;
          }
        }
      }
    }
    return pairs;
  }
};

// n x n x n blocks, each of this size, on a lattice of steps of 1, placed together.
std::vector<Block> lattice(int n, double size, const Mat4& world) {
  std::vector<Block> blocks;
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3d low{static_cast<double>(i % n), static_cast<double>(i / n % n),
                    static_cast<double>(i / n / n)};
    blocks.push_back({low, low + Vec3d(size, size, size), world});
  }
  return blocks;
}

View viewTo(const Vec3d& eye, const Vec3d& forward, bool orthographic) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, {0.1, 1.0, 0.2});
  view.orthographic = orthographic;
  return view;
}

TEST(ContactTolerance, HundredsOfCubesThatTouchAreAsManyGroups) {
  Random random(1);
  for (const bool orthographic : {false, true}) {
    const Mat4 world = turned(random, 1.5);
    Blocks parted(1e-6), strict(0.0);
    parted.addAll(lattice(7, 1.0, world));
    strict.addAll(lattice(7, 1.0, world));
    for (const Vec3d& from : {Vec3d(-20, 3, 5), Vec3d(6.3, 30, 2.1), Vec3d(20.5, 21.5, 40.5)}) {
      const View view = viewTo(transformPoint(world, from), random.direction(), orthographic);
      EXPECT_EQ(parted.groups(view), 7u * 7 * 7);
      EXPECT_GT(parted.judge(view, random, 200, 1e-9), 500u);
      EXPECT_TRUE(parted.sorter.update(view).collisions.empty());
      EXPECT_EQ(strict.groups(view), 1u);
    }
  }
}

TEST(ContactTolerance, CubesThatOverlapMoreThanTheToleranceStayTogether) {
  Random random(2);
  const Mat4 world = turned(random, 1.0);
  for (const double overlap : {1e-5, 1e-4}) {
    for (const double tolerance : {1e-6, 3e-5, 3e-4, 3e-3}) {
      Blocks blocks(tolerance);
      blocks.addAll(lattice(3, 1.0 + overlap, world));
      const View view = viewTo({-9, 4, 12}, {1, 0, -1}, false);
      // A quarter of the tolerance is surely enough, all of it surely is not needed.
      if (overlap > tolerance) {
        EXPECT_EQ(blocks.groups(view), 1u) << overlap << " " << tolerance;
        EXPECT_FALSE(blocks.sorter.update(view).collisions.empty());
      } else if (overlap < 0.5 * tolerance) {
        EXPECT_EQ(blocks.groups(view), 27u) << overlap << " " << tolerance;
        EXPECT_GT(blocks.judge(view, random, 300, 3.0 * overlap), 300u);
      }
    }
  }
}

// Walls on a slab, a thin pane against each of them, a post in a corner: all touch, none overlaps.
TEST(ContactTolerance, AHouseOfTouchingPartsIsSorted) {
  Random random(3);
  std::vector<Block> house{
      {{-10, -0.5, -10}, {10, 0, 10}, {}},  // slab
      {{-10, 0, -10}, {10, 3, -9.75}, {}},  // walls
      {{-10, 0, -9.75}, {-9.75, 3, 10}, {}},  {{9.75, 0, -9.75}, {10, 3, 10}, {}},
      {{-9.75, 0, 9.75}, {9.75, 3, 10}, {}},  {{-10, 3, -10}, {10, 3.25, 10}, {}},  // roof
      {{-5, 1, -9.75}, {5, 2, -9.7499}, {}},                                        // pane on a wall
      {{-9.75, 0, -9.75}, {-9, 3, -9}, {}},                                         // post
      {{-1, 0, -1}, {1, 1, 1}, {}},                                                 // table
      {{-0.5, 1, -0.5}, {0.5, 1.5, 0.5}, {}},                                       // something on it
  };
  for (int place = 0; place < 4; ++place) {
    const Mat4 world = place == 0 ? Mat4() : turned(random, place == 1 ? 0.01 : 30.0);
    Blocks blocks(place == 1 ? 1e-6 : 1e-4);
    for (Block block : house) {
      block.world_from_block = world;
      blocks.add(block);
    }
    for (int i = 0; i < 12; ++i) {
      const Vec3d eye = transformPoint(world, random.point({-30, -10, -30}, {30, 20, 30}));
      const View view = viewTo(eye, random.direction(), i % 3 == 0);
      EXPECT_EQ(blocks.groups(view), house.size()) << place << " " << i;
      EXPECT_GT(blocks.judge(view, random, 400, 1e-7), 50u);
    }
  }
}

// The edge of one lies on the edge of the other, crosswise; a corner stands on a face.
TEST(ContactTolerance, EdgesAndCornersThatTouchArePartedToo) {
  const double r = std::sqrt(0.5);
  Mat4 about_x, about_z;  // turned by 45 degrees
  about_x(1, 1) = r, about_x(1, 2) = r, about_x(2, 1) = -r, about_x(2, 2) = r;
  about_z(0, 0) = r, about_z(0, 1) = -r, about_z(1, 0) = r, about_z(1, 1) = r;
  const Block beam{{-5, 0, 0}, {5, 1, 1}, about_x};    // its lowest edge is the x axis
  Block cross_beam{{-1, -1, -5}, {0, 0, 5}, about_z};  // its highest edge is the z axis
  Random random(4);
  std::size_t pairs = 0;
  for (int i = 0; i < 20; ++i) {
    Blocks blocks(1e-5);
    blocks.add(beam);
    blocks.add(cross_beam);
    blocks.add({{-9, -3 - std::sqrt(2.0), -9}, {9, -std::sqrt(2.0), 9}, {}});  // the ground under it
    const View view = viewTo(random.point({-20, -1, -20}, {20, 10, 20}), random.direction(), i % 4 == 0);
    EXPECT_EQ(blocks.groups(view), 3u) << i;
    pairs += blocks.judge(view, random, 300, 1e-6);
  }
  EXPECT_GT(pairs, 500u);
}

TEST(ContactTolerance, PanelsWithoutThicknessMayTouchAtTheirEdges) {
  Random random(5);
  const Mat4 world = turned(random, 2.0);
  Blocks blocks(1e-6);
  for (int i = 0; i < 25; ++i) {
    const Vec3d low{static_cast<double>(i % 5), static_cast<double>(i / 5), 0.0};
    blocks.add({low, low + Vec3d(1, 1, 0), world});
  }
  EXPECT_EQ(blocks.groups(viewTo(transformPoint(world, {2, 2, 5}), {0, 0, -1}, false)), 25u);
  // Seen along them too.
  EXPECT_EQ(blocks.groups(viewTo(transformPoint(world, {-7, 2.2, 0}), {0, 0, -1}, false)), 25u);
}

TEST(ContactTolerance, TheEyeMayBeInThePlaneOfContact) {
  for (const double offset : {0.0, 1e-15, -1e-15, 1e-9, -1e-9}) {
    Blocks blocks(1e-6);
    blocks.addAll(lattice(4, 1.0, Mat4()));
    const View view = viewTo({-5, 2.0 + offset, 1.0}, {1, 0, 0}, false);
    EXPECT_EQ(blocks.groups(view), 64u);
    Random random(6);
    EXPECT_GT(blocks.judge(view, random, 200, 1e-6), 100u);
  }
}

// Blocks that come together and part again: results that start from the last frame are those from scratch.
TEST(ContactTolerance, WhatWasFoundInTheLastFrameChangesNothing) {
  Random random(7);
  Blocks moving(1e-4);
  moving.add({{0, 0, 0}, {1, 1, 1}, {}});
  moving.add({{0, 0, 0}, {1, 1, 1}, {}});
  for (int frame = 0; frame < 60; ++frame) {
    const double gap = 3e-4 * std::sin(0.4 * frame);
    Mat4 m;
    m(0, 3) = 1.0 + gap;
    moving.sorter.setTransform(PartId(1u), m);
    Blocks anew(1e-4);
    anew.add({{0, 0, 0}, {1, 1, 1}, {}});
    anew.add({{0, 0, 0}, {1, 1, 1}, m});
    const View view = viewTo({-3, 0.4, 0.3}, {1, 0, 0}, false);
    // Within rounding of what is just enough, either may be found.
    if (gap > -1e-4 * 0.25 || gap < -1e-4) {
      EXPECT_EQ(moving.groups(view), gap > -1e-4 * 0.25 ? 2u : 1u) << gap;
      EXPECT_EQ(moving.groups(view), anew.groups(view)) << gap;
    }
  }
}

// The groups of the parts in their order, where each has one part.
std::vector<std::uint32_t> orderOf(const LayerOrder& order) {
  std::vector<std::uint32_t> parts;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    EXPECT_EQ(order.group(i).size(), 1u) << "group " << i;
    parts.push_back(order.group(i)[0].value);
  }
  return parts;
}

// A sheet inside a container, closer to its far or its near wall than the tolerance, from both sides.
TEST(ContactTolerance, ContentStaysBetweenTheFrontAndTheBackOfItsContainer) {
  for (const double tolerance : {0.0, 1e-6, 0.01, 5.0}) {
    for (const double depth : {0.002, 0.5, 1.998}) {
      LayerSorter sorter(Blocks::settingsWith(tolerance));
      const HullId shell = sorter.addHull(*buildHull(cornersOf({{-1, -1, -1}, {1, 1, 1}, {}})));
      const HullId sheet =
          sorter.addHull(*buildHull(cornersOf({{-0.5, -0.5, depth - 1}, {0.5, 0.5, depth - 1}, {}})));
      const PartId front = sorter.addPart(std::span(&shell, 1)), back = sorter.addPart(std::span(&shell, 1));
      sorter.addPart(std::span(&sheet, 1));
      sorter.setContainer(front, back);
      const std::vector<std::uint32_t> expected{0, 2, 1};
      for (const bool orthographic : {false, true}) {
        for (const double side : {-1.0, 1.0}) {
          SCOPED_TRACE(testing::Message() << tolerance << " " << depth << " " << side);
          const View view = viewTo({0.1, 0.2, 6 * side}, {0, 0, -side}, orthographic);
          EXPECT_EQ(orderOf(sorter.update(view)), expected);
          EXPECT_EQ(orderOf(sorter.update(view)), expected) << "in the next frame";
        }
      }
    }
  }
}

// What a container stands on touches it from outside: the tolerance holds there.
TEST(ContactTolerance, AContainerMayStandOnWhatItTouches) {
  LayerSorter sorter(Blocks::settingsWith(0.01));
  const HullId shell = sorter.addHull(*buildHull(cornersOf({{-1, -1, -1}, {1, 1, 1}, {}})));
  const HullId table = sorter.addHull(*buildHull(cornersOf({{-9, -2, -9}, {9, -0.999, 9}, {}})));
  const PartId front = sorter.addPart(std::span(&shell, 1)), back = sorter.addPart(std::span(&shell, 1));
  sorter.addPart(std::span(&table, 1));
  sorter.setContainer(front, back);
  EXPECT_EQ(orderOf(sorter.update(viewTo({3, 4, 20}, {0, 0, -1}, false))),
            (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(ContactTolerance, OddTolerancesAreNone) {
  for (const double odd : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    Blocks blocks(odd);
    blocks.addAll(lattice(2, 1.0, Mat4()));
    EXPECT_EQ(blocks.groups(viewTo({-3, 0.4, 0.3}, {1, 0, 0}, false)), 1u);
  }
}

// Points of any hull, under any placement, move by no more than they may, towards the middle; and the sides
// of a box by a good part of it.
TEST(HullBox, ErosionMovesNoPointTooFar) {
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    Points points;
    const Vec3d size{random.number(0.0, 1.0), i % 3 == 0 ? 0.0 : random.number(0.0, 1.0),
                     i % 5 == 0 ? 0.0 : random.number(0.0, 1e-3)};
    for (int k = 0; k < 20; ++k) {
      points.push_back(random.point(size * -1.0, size));
    }
    const ConvexHull hull = *buildHull(points);
    Mat4 m = turned(random, random.number(0.1, 10.0));
    for (int row = 0; row < 3; ++row) {
      m(row, 1) *= random.number(-3.0, 3.0);
      m(row, 3) = random.number(-50.0, 50.0);
    }
    const Placement placement = placementOf(m);
    const double by = std::pow(10.0, random.number(-6.0, 0.0));
    const Placement smaller = eroded(placement, boxOf(hull), by);
    for (const Vec3d& v : hull.vertices) {
      EXPECT_LE(length(smaller.point(v) - placement.point(v)), by * (1.0 + 1e-6) + 1e-12);
    }
  }
  // A wide and thin box, turned in its own space.
  const Mat4 turn = turned(random, 1.0);
  Points corners;
  for (const Vec3d& corner : cornersOf({{-5, -5, -0.01}, {5, 5, 0.01}, {}})) {
    corners.push_back(transformPoint(turn, corner));
  }
  const ConvexHull pane = *buildHull(corners);
  const Placement smaller = eroded(Placement(), boxOf(pane), 1e-3);
  const Vec3d normal = transformPoint(turn, {0, 0, 1});
  double top = -1.0;
  for (const Vec3d& v : pane.vertices) {
    top = std::max(top, dot(smaller.point(v), normal));
  }
  EXPECT_LT(top, 0.01 - 0.5e-3);
}

}  // namespace
}  // namespace sightline::layers
