// Boxes that reach the near plane, against rays through every pixel in extended precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/scene/pixel_view.h"
#include "tests/occlusion/random_views.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace test;
using Wide = long double;

DepthPyramid pyramidOfWalls(std::span<const OraclePolygon> walls, const View& view,
                            const RasterSettings& raster) {
  DepthPyramid pyramid({.raster = raster});
  const OccluderSet set = setOf(walls);
  pyramid.build(view, set, all(set));
  return pyramid;
}

bool reachesNearPlane(const View& view, const DepthBufferView& buffer, const Box& box) {
  occlusion::PixelBox image;
  occlusion::projectBoxes(scene::PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height,
                          {&box, 1}, {&image, 1});
  return image.place == occlusion::BoxPlace::kUnbounded;
}

// Where the ray through a place of the picture, from -1 to 1 along each axis, is first in the box and beyond
// the near plane: the depth there, or infinity.
Wide firstDepth(const View& view, const Box& box, Wide x, Wide y) {
  const Wide half_height = view.orthographic ? Wide{0.5} * view.ortho_height : Wide{view.tan_half_fovy};
  const Wide across = (x + view.shift_x) * half_height * view.aspect,
             along = (y + view.shift_y) * half_height;
  Wide first = view.z_near, last = view.z_far;
  for (int axis = 0; axis < 3; ++axis) {
    const Wide beside = view.right[axis] * across + view.up[axis] * along;
    const Wide from = view.eye[axis] + (view.orthographic ? beside : 0);
    const Wide step = view.forward[axis] + (view.orthographic ? 0 : beside);
    const Wide low = box.min[axis] - from, high = box.max[axis] - from;
    if (step == 0) {
      if (low > 0 || high < 0) {
        return std::numeric_limits<Wide>::infinity();
      }
      continue;
    }
    first = std::max(first, std::min(low / step, high / step));
    last = std::min(last, std::max(low / step, high / step));
  }
  return first <= last ? first : std::numeric_limits<Wide>::infinity();
}

// Whether some ray of a grid over each pixel, its border included, gets to the box before the buffer's depth.
bool reached(const View& view, const DepthBufferView& buffer, const Box& box, int rays) {
  for (std::uint32_t py = 0; py < buffer.height; ++py) {
    for (std::uint32_t px = 0; px < buffer.width; ++px) {
      for (int i = 0; i <= rays * (rays + 2); ++i) {
        const Wide x = px + Wide(i % (rays + 1)) / rays, y = py + Wide(i / (rays + 1)) / rays;
        const Wide depth = firstDepth(view, box, 2 * x / buffer.width - 1, 2 * y / buffer.height - 1);
        if (std::isinf(depth)) {
          continue;
        }
        const Wide value = view.orthographic ? -depth : 1 / depth;
        if (buffer.at(px, py) < value - std::abs(value) * 1e-13L) {
          return true;
        }
      }
    }
  }
  return false;
}

TEST(NearBoxes, AWallBesideTheEyeHidesWhatRunsAlongBehindIt) {
  // The wall's near end is outside the view, and so is that of the box.
  const std::vector<OraclePolygon> walls{
      {{{0.9f, -9, -30}, {0.9f, -9, -0.5f}, {0.9f, 9, -0.5f}, {0.9f, 9, -30}}, true}};
  const DepthPyramid pyramid = pyramidOfWalls(walls, kLookingBack, {.width = 256, .height = 256});
  const auto classify = [&](const Box& box) {
    EXPECT_TRUE(reachesNearPlane(kLookingBack, pyramid.depthBuffer(), box));
    return pyramid.classify(box);
  };
  EXPECT_EQ(classify({{1.2f, -1, -9}, {3, 1, 5}}), Visibility::kHidden);
  EXPECT_EQ(classify({{1.2f, -1, -9}, {3, 1, -0.005f}}), Visibility::kHidden);
  EXPECT_EQ(classify({{1.2f, -1, -60}, {3, 1, 5}}), Visibility::kPartial) << "longer than the wall";
  EXPECT_EQ(classify({{0.85f, -1, -20}, {3, 1, 5}}), Visibility::kPartial) << "through the wall";
  EXPECT_EQ(classify({{0.9f, -1, -20}, {3, 1, 5}}), Visibility::kPartial) << "in the wall's plane";
  EXPECT_EQ(classify({{-1, -1, -20}, {3, 1, 5}}), Visibility::kPartial) << "around the eye";
  EXPECT_EQ(classify({{0, -1, -20}, {3, 1, 5}}), Visibility::kPartial) << "the eye in a side";
}

TEST(NearBoxes, AboveAndBelowAndInAnOrthographicView) {
  View view = viewFrom({0, 0, 0}, {0, -0.3, -1});
  const std::vector<OraclePolygon> walls{{{{-50, -1, 5}, {50, -1, 5}, {50, -1, -90}, {-50, -1, -90}}, true}};
  const RasterSettings raster{.width = 128, .height = 64};
  EXPECT_EQ(pyramidOfWalls(walls, view, raster).classify({{-3, -4, -6}, {3, -1.5f, 9}}), Visibility::kHidden);
  EXPECT_EQ(pyramidOfWalls(walls, view, raster).classify({{-3, -4, -6}, {3, -0.5f, 9}}),
            Visibility::kPartial);
  view.orthographic = true;
  view.ortho_height = 1.0;
  EXPECT_EQ(pyramidOfWalls(walls, view, raster).classify({{-3, -6, -9}, {3, -4, 9}}), Visibility::kHidden);
  EXPECT_EQ(pyramidOfWalls(walls, view, raster).classify({{-3, -6, -9}, {3, 0, 9}}), Visibility::kPartial);
}

TEST(NearBoxes, WhereTheyAreHiddenNoRayReachesThem) {
  const RasterSettings sizes[] = {
      {.width = 24, .height = 18}, {.width = 9, .height = 40}, {.width = 65, .height = 3}};
  int hidden = 0, open = 0, unclear = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(400u); ++seed) {
    ViewRandom random(seed);
    View view = randomView(random);
    view.z_near = random.sized(1e-4, 0.1);
    const double size = view.orthographic ? view.ortho_height : 1.0;
    // Walls all around, in any position, not all of which overlap.
    std::vector<OraclePolygon> walls;
    for (int i = 0; i < 6; ++i) {
      const Vec3d away =
          normalized(random.below(2) == 0 ? random.point(1.0) : view.forward + random.point(0.8));
      const Vec3d u = normalized(cross(away, Vec3d(0.3, 0.5, 0.8))) * (size * random.sized(2.0, 60.0));
      const Vec3d v = normalized(cross(away, u)) * (size * random.sized(2.0, 60.0));
      const Vec3d middle = view.eye + away * (size * random.sized(0.3, 4.0));
      walls.push_back(
          {{Vec3f(middle - u - v), Vec3f(middle + u - v), Vec3f(middle + u + v), Vec3f(middle - u + v)},
           true});
    }
    const DepthPyramid pyramid = pyramidOfWalls(walls, view, sizes[seed % 3]);
    const DepthBufferView buffer = pyramid.depthBuffer();
    if (std::ranges::none_of(buffer.reciprocal_depth, [](float depth) { return depth > kUncovered; })) {
      continue;  // an empty buffer hides nothing
    }
    for (int b = 0; b < 40; ++b) {
      // From anywhere behind the near plane to anywhere beyond it.
      const Vec3d from =
          view.eye - view.forward * (size * random.sized(1e-3, 20.0)) + random.point(size * 6.0);
      const Vec3d to = view.eye + view.forward * (size * random.sized(0.1, 40.0)) + random.point(size * 20.0);
      Box box{Vec3f(min(from, to)), Vec3f(max(from, to))};
      if (random.below(6) == 0) {
        // One of its sides is next to the eye, or in it.
        const auto axis = static_cast<int>(random.below(3));
        box.min[axis] = static_cast<float>(view.eye[axis]) +
                        (random.below(2) == 0 ? 0.0f : static_cast<float>(size * 1e-6));
        box.max[axis] = std::max(box.max[axis], box.min[axis]);
      }
      if (!reachesNearPlane(view, buffer, box)) {
        continue;
      }
      if (pyramid.classify(box) == Visibility::kHidden) {
        ++hidden;
        EXPECT_FALSE(reached(view, buffer, box, 4)) << "seed " << seed << ", box " << b;
      } else {
        ++(reached(view, buffer, box, 4) ? open : unclear);
      }
    }
  }
  EXPECT_GT(hidden, test::rounds(300));
  EXPECT_GT(open, test::rounds(300));
  // The greatest values of two planes within a pixel need not be in the same place of it.
  EXPECT_LT(unclear, (hidden + open) / 10);
}

}  // namespace
}  // namespace sightline
