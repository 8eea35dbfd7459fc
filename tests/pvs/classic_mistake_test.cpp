// The union over occluders must be taken last. From each corner of a region something hides a box, and yet a
// viewer between the corners sees it through the gap between two walls, through which no corner sees the box.

#include <gtest/gtest.h>

#include "tests/pvs/convex_scenes.h"

namespace sightline {
namespace {

using namespace test;
using pvs::separated;

// A wall that faces +z.
Shape wallAt(float x0, float x1, float z) {
  Shape shape;
  shape.solid.points = {{x0, -50, z}, {x1, -50, z}, {x1, 50, z}, {x0, 50, z}};
  shape.solid.faces = {{0, 1, 2, 3}};
  return shape;
}

struct Answer {
  std::vector<bool> by_corner;  // true if something hides the box from this corner
  bool by_occluder = false;     // true if some occluder hides it from all corners
};

Answer answerOf(std::span<const Shape> shapes, std::span<const Vec3d> corners, const Box& box) {
  const ConvexOccluders all(setOf(shapes));
  EXPECT_EQ(all.size(), shapes.size());
  Answer answer;
  answer.by_corner.assign(corners.size(), false);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    EXPECT_TRUE(separated(all, all[i], corners, 0.1));
    bool from_all = true;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const bool hidden = !hiddenBoxes(all, all[i], corners[c], std::span(&box, 1)).empty();
      answer.by_corner[c] = answer.by_corner[c] || hidden;
      from_all = from_all && hidden;
    }
    answer.by_occluder = answer.by_occluder || from_all;
  }
  return answer;
}

bool anyBlocks(std::span<const Shape> shapes, const Vec3d& eye, const Vec3d& x) {
  return std::ranges::any_of(shapes, [&](const Shape& shape) { return blocks(shape, eye, x); });
}

// Tests the box exactly, from the corners and from a point between them.
void expectSeenFromBetweenOnly(std::span<const Shape> shapes, std::span<const Vec3d> corners, const Box& box,
                               const Vec3d& between) {
  Random random(1);
  for (const Vec3d& corner : corners) {
    for (int i = 0; i < 200; ++i) {
      EXPECT_TRUE(anyBlocks(shapes, corner, pointIn(box, random)));
    }
  }
  EXPECT_FALSE(anyBlocks(shapes, between, center(box)));  // the ray that reaches the box
}

TEST(ClassicMistake, TwoWallsSideBySideHideABoxFromAllCornersButNotFromBetween) {
  // Viewers have x from -4 to 4. The gap is at x from -0.5 to 0.5, 10 metres in front of them, and the box is
  // 10 metres behind it. Through the gap, one sees x = -4 from x = 4, and x = 4 from x = -4.
  const std::vector<Shape> walls{wallAt(-40, -0.5f, 0), wallAt(0.5f, 40, 0)};
  const Box region{{-4, -1, 10}, {4, 1, 12}}, box{{-0.2f, -0.2f, -10.2f}, {0.2f, 0.2f, -10}};
  const std::vector<Vec3d> corners = cornersOf(region);
  expectSeenFromBetweenOnly(walls, corners, box, {0, 0, 11});
  const Answer answer = answerOf(walls, corners, box);
  for (const bool hidden : answer.by_corner) {
    EXPECT_TRUE(hidden);  // the mistake: each corner has an occluder that hides it
  }
  EXPECT_FALSE(answer.by_occluder);
}

TEST(ClassicMistake, TwoWallsOfACornerWithAGapHideABoxFromAllCornersButNotFromBetween) {
  // A wall that faces +z and a wall that faces +x, which do not quite touch; viewers are on the diagonal in
  // front of them. The box is on the diagonal behind.
  Shape side;
  side.solid.points = {{0, -50, 1}, {0, 50, 1}, {0, 50, 40}, {0, -50, 40}};
  side.solid.faces = {{0, 1, 2, 3}};
  const std::vector<Shape> walls{wallAt(1, 40, 0), side};
  // A rhombus across the diagonal, with its corners in pairs, above and below.
  std::vector<Vec3d> corners;
  for (const double y : {-1.0, 1.0}) {
    corners.insert(corners.end(), {{12, y, 6}, {6, y, 12}, {14, y, 7}, {7, y, 14}});
  }
  const Box box{{-5.1f, -0.1f, -5.1f}, {-4.9f, 0.1f, -4.9f}};
  expectSeenFromBetweenOnly(walls, corners, box, {9, 0, 9});
  const Answer answer = answerOf(walls, corners, box);
  for (const bool hidden : answer.by_corner) {
    EXPECT_TRUE(hidden);
  }
  EXPECT_FALSE(answer.by_occluder);
}

TEST(ClassicMistake, OneWallInPlaceOfTwoHidesTheBoxFromEverywhere) {
  const std::vector<Shape> walls{wallAt(-40, 40, 0)};
  const Box region{{-4, -1, 10}, {4, 1, 12}}, box{{-0.2f, -0.2f, -10.2f}, {0.2f, 0.2f, -10}};
  EXPECT_TRUE(answerOf(walls, cornersOf(region), box).by_occluder);
}

}  // namespace
}  // namespace sightline
