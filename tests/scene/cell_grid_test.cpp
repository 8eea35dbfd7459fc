#include "src/scene/cell_grid.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline::scene {
namespace {

Box boundsOf(const std::vector<Vec3f>& corners) {
  Box bounds;
  for (const Vec3f& corner : corners) {
    bounds.extend(corner);
  }
  return bounds;
}

bool isMarked(const CellGrid& grid, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return (grid.marked(x)[y] >> z & 1) != 0;
}

// The cell, larger by so much on all sides.
std::array<Vec3d, 2> cellOf(const CellGrid& grid, const Box& box, std::array<std::uint32_t, 3> cell,
                            double by) {
  std::array<Vec3d, 2> sides;
  for (int axis = 0; axis < 3; ++axis) {
    const Slabs& slabs = grid.slabs(axis);
    sides[0][axis] = slabs.plane[cell[axis]] - by;
    sides[1][axis] = (cell[axis] + 1 < slabs.count ? slabs.plane[cell[axis] + 1] : box.max[axis]) + by;
  }
  return sides;
}

// Whether anything of the triangle is left when it has been clipped by all sides.
bool reaches(const Vec3f* triangle, const std::array<Vec3d, 2>& sides) {
  std::vector<Vec3d> polygon{Vec3d(triangle[0]), Vec3d(triangle[1]), Vec3d(triangle[2])};
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t side = 0; side < 2; ++side) {
      const auto depth = [&](const Vec3d& p) {
        return side == 0 ? p[axis] - sides[0][axis] : sides[1][axis] - p[axis];
      };
      std::vector<Vec3d> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = depth(a), db = depth(b);
        if (da >= 0.0) {
          kept.push_back(a);
        }
        if ((da >= 0.0) != (db >= 0.0)) {
          kept.push_back(a + (b - a) * (da / (da - db)));
        }
      }
      polygon = std::move(kept);
    }
  }
  return !polygon.empty();
}

TEST(CellGrid, MarksTheCellsThatTrianglesReachAndNoOthers) {
  std::size_t marked = 0, tried = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(150u); ++seed) {
    std::mt19937 random(seed);
    // Few different coordinates, so that triangles are parallel to axes and lie in planes of the grid; or
    // many.
    const unsigned range = seed % 3 == 0 ? 5 : seed % 3 == 1 ? 40 : 100000;
    const auto coordinate = [&] {
      return static_cast<float>(random() % range) * (64.0f / static_cast<float>(range));
    };
    std::vector<Vec3f> corners;
    for (std::uint32_t i = 0; i < 3 * (1 + seed % 4); ++i) {
      const float x = coordinate(), y = coordinate(), z = coordinate();
      corners.push_back({x, y, z});
    }
    const Box box = boundsOf(corners);
    const CellGrid grid(box, corners);
    for (std::uint32_t x = 0; x < grid.slabs(0).count; ++x) {
      for (std::uint32_t y = 0; y < grid.slabs(1).count; ++y) {
        for (std::uint32_t z = 0; z < grid.slabs(2).count; ++z) {
          bool inner = false, outer = false;
          for (std::size_t t = 0; t < corners.size(); t += 3) {
            inner = inner || reaches(&corners[t], cellOf(grid, box, {x, y, z}, -1e-3));
            outer = outer || reaches(&corners[t], cellOf(grid, box, {x, y, z}, 1e-3));
          }
          const bool is = isMarked(grid, x, y, z);
          ASSERT_TRUE(is || !inner) << "seed " << seed << ", cell " << x << ' ' << y << ' ' << z;
          ASSERT_TRUE(!is || outer) << "seed " << seed << ", cell " << x << ' ' << y << ' ' << z;
          marked += is ? 1 : 0;
          ++tried;
        }
      }
    }
  }
  EXPECT_GT(marked, test::rounds(10000u));
  EXPECT_GT(tried - marked, test::rounds(10000u));
}

TEST(CellGrid, WhatTouchesAPlaneIsOnItsOwnSideAlone) {
  // A triangle within each of some cells, with all corners in the planes around it.
  std::mt19937 random(1);
  std::vector<Vec3f> corners{{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {15, 15, 15}, {16, 16, 15}, {16, 15, 16}};
  std::vector<std::array<std::uint32_t, 3>> cells{{0, 0, 0}, {15, 15, 15}};
  for (std::uint32_t i = 1; i < 15; ++i) {
    // Each coordinate occurs, so that the planes are the whole numbers.
    cells.push_back(
        {i, static_cast<std::uint32_t>(random() % 16), static_cast<std::uint32_t>(random() % 16)});
    cells.push_back(
        {static_cast<std::uint32_t>(random() % 16), i, static_cast<std::uint32_t>(random() % 16)});
    cells.push_back(
        {static_cast<std::uint32_t>(random() % 16), static_cast<std::uint32_t>(random() % 16), i});
  }
  for (const auto& [x, y, z] : cells) {
    const Vec3f at(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    corners.push_back(at);
    corners.push_back(at + Vec3f(1, 1, 0));
    corners.push_back(at + Vec3f(1, 0, 1));
  }
  const CellGrid grid({{0, 0, 0}, {16, 16, 16}}, corners);
  for (std::uint32_t x = 0; x < 16; ++x) {
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t z = 0; z < 16; ++z) {
        EXPECT_EQ(isMarked(grid, x, y, z),
                  std::find(cells.begin(), cells.end(), std::array{x, y, z}) != cells.end())
            << x << ' ' << y << ' ' << z;
      }
    }
  }
}

TEST(CellGrid, AFaceInAPlaneBelongsToTheSolidBehindIt) {
  // Two faces at height 1 of a box of height 3: one looks up, one down.
  std::vector<Vec3f> corners{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {2, 0, 1}, {3, 1, 1}, {3, 0, 1},
                             {0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {3, 3, 3}, {3, 0, 3}};
  const CellGrid grid({{0, 0, 0}, {3, 3, 3}}, corners);
  const Slabs& x = grid.slabs(0);
  const Slabs& z = grid.slabs(2);
  const auto slabAt = [](const Slabs& slabs, float plane) {
    return static_cast<std::uint32_t>(std::find(slabs.plane.begin(), slabs.plane.end(), plane) -
                                      slabs.plane.begin());
  };
  const std::uint32_t above = slabAt(z, 1.0f);
  ASSERT_LT(above, z.count);
  const std::uint32_t up = slabAt(x, 1.0f) - 1, down = slabAt(x, 2.0f);
  EXPECT_TRUE(isMarked(grid, up, 0, above - 1));
  EXPECT_FALSE(isMarked(grid, up, 0, above));
  EXPECT_TRUE(isMarked(grid, down, 0, above));
  EXPECT_FALSE(isMarked(grid, down, 0, above - 1));
}

TEST(CellGrid, PlanesAreTheCoordinatesOfCornersIfThoseAreFew) {
  std::vector<Vec3f> few, many;
  for (std::uint32_t i = 0; i <= 300; ++i) {
    few.push_back({static_cast<float>(i % 6 * i % 6), static_cast<float>(i % 2), 0.0f});
    many.push_back({static_cast<float>(i), static_cast<float>(i % 2), 0.0f});
  }
  const CellGrid grid(boundsOf(few), std::span(few).first(300));
  for (const Vec3f& corner : few) {
    const auto& planes = grid.slabs(0).plane;
    EXPECT_TRUE(corner.x == boundsOf(few).max.x ||
                std::find(planes.begin(), planes.end(), corner.x) != planes.end())
        << corner.x;
  }
  const Slabs slabs = CellGrid(boundsOf(many), std::span(many).first(300)).slabs(0);
  ASSERT_EQ(slabs.count, kMaxSlabs);
  for (std::uint32_t i = 1; i < kMaxSlabs; ++i) {
    EXPECT_NEAR(slabs.plane[i], 300.0f / kMaxSlabs * static_cast<float>(i), 0.5f) << "equal distances";
    EXPECT_EQ(slabs.plane[i], std::round(slabs.plane[i])) << "at a corner";
  }
  EXPECT_EQ(grid.slabs(2).count, 1u) << "the box is flat";
}

TEST(CellGrid, EveryInstructionSetMarksTheSameCells) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> coordinate(-1e4f, 1e4f);
  std::vector<Vec3f> corners;
  for (int i = 0; i < 60; ++i) {
    const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
    corners.push_back({x, y, z});
  }
  std::vector<SlabMasks> first;
  std::size_t targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const test::ForcedInstructionSet forced(target);
    const CellGrid grid(boundsOf(corners), corners);
    std::vector<SlabMasks> marked;
    for (std::uint32_t x = 0; x < kMaxSlabs; ++x) {
      marked.push_back(grid.marked(x));
    }
    first = first.empty() ? marked : first;
    EXPECT_EQ(first, marked) << hwy::TargetName(target);
    ++targets;
  }
  EXPECT_GE(targets, 1u);
}

}  // namespace
}  // namespace sightline::scene
