#include "src/occlusion/boxes/box_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/occlusion/random_views.h"

namespace sightline::occlusion {
namespace {

using test::randomBox, test::randomView, test::ViewRandom;

constexpr std::uint32_t kColumns = 320, kRows = 180;

// Where a point appears, in pixels from the middle of a pixel, and its depth.
struct Appearance {
  double x, y, depth;

  Appearance(const scene::PixelView& view, const Vec3d& point, const BufferPixel& pixel) {
    const Vec3d camera = view.toCamera(point - view.eye);
    x = view.pixelX(camera) - pixel.x - 0.5;
    y = view.pixelY(camera) - pixel.y - 0.5;
    depth = camera.z;
  }
  double distance() const { return std::hypot(x, y); }
};

// A box in view, and the pixel in which one of its points lies.
struct BoxAndPixel {
  explicit BoxAndPixel(std::uint64_t seed) : random(seed) {
    const View eye_view = randomView(random);
    view = scene::PixelView(eye_view, kColumns, kRows);
    box = randomBox(random, eye_view);
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = random.in(box.min[axis], box.max[axis]);
    }
    const Vec3d camera = view.toCamera(point - view.eye);
    const double x = view.pixelX(camera), y = view.pixelY(camera);
    in_view = box.wellFormed() && camera.z > 2.0 * view.near && camera.z < view.far && x > 0.0 && y > 0.0 &&
              x < kColumns && y < kRows;
    if (in_view) {
      pixel = {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    }
  }
  // The size of a pixel at a depth, metres.
  double pixelSize(double depth) const {
    return (view.orthographic ? 1.0 : depth) / std::max(view.scale_x, view.scale_y);
  }
  // How far rounding to single precision moves a point of the box, metres.
  double rounding() const {
    return 0x1p-22 * (maxComponent(abs(Vec3d(box.min))) + maxComponent(abs(Vec3d(box.max))));
  }

  ViewRandom random;
  scene::PixelView view;
  Box box;
  Vec3d point;  // of the box
  BufferPixel pixel;
  bool in_view = false;
};

TEST(PointInPixel, IsAPointOfTheBoxAndMostlyAppearsThere) {
  int there = 0, elsewhere = 0;
  for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
    const BoxAndPixel bed(seed);
    if (!bed.in_view) {
      continue;
    }
    const Vec3f found = pointInPixel(bed.view, bed.box, bed.pixel);
    EXPECT_TRUE(contains(bed.box, Box{found, found})) << "seed " << seed;
    const Appearance at(bed.view, Vec3d(found), bed.pixel);
    if (bed.rounding() > 0.1 * bed.pixelSize(at.depth)) {
      continue;
    }
    ++(std::max(std::abs(at.x), std::abs(at.y)) <= 0.5 ? there : elsewhere);
  }
  EXPECT_GT(there, 3000);
  EXPECT_LT(elsewhere, there / 10);
}

// The ray through the pixel's middle enters the box where no point of the ray before is in it.
TEST(PointInPixel, IsTheNearestOfTheBoxOnTheRay) {
  int entered = 0;
  for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
    const BoxAndPixel bed(seed);
    if (!bed.in_view) {
      continue;
    }
    const Vec3f found = pointInPixel(bed.view, bed.box, bed.pixel);
    const Appearance at(bed.view, Vec3d(found), bed.pixel);
    const double pixel_size = bed.pixelSize(at.depth);
    if (at.distance() > 0.1 || bed.rounding() > 0.01 * pixel_size) {
      continue;
    }
    ++entered;
    for (int i = 0; i < 20; ++i) {
      const double depth = at.depth * (i + 0.5) / 21.0;
      const Vec3d across = bed.view.unit_x * ((bed.pixel.x + 0.5 - bed.view.middle_x) / bed.view.scale_x) +
                           bed.view.unit_y * ((bed.pixel.y + 0.5 - bed.view.middle_y) / bed.view.scale_y);
      const Vec3d on_ray =
          bed.view.eye + (bed.view.orthographic ? across : across * depth) + bed.view.unit_z * depth;
      bool inside = depth > bed.view.near;
      for (int axis = 0; axis < 3; ++axis) {
        const double margin = bed.rounding() + 1e-3 * pixel_size;
        inside =
            inside && on_ray[axis] > bed.box.min[axis] + margin && on_ray[axis] < bed.box.max[axis] - margin;
      }
      EXPECT_FALSE(inside) << "seed " << seed;
    }
  }
  EXPECT_GT(entered, 1000);
}

}  // namespace
}  // namespace sightline::occlusion
