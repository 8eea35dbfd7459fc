#include "src/occlusion/boxes/pixel_boxes.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/occlusion/random_views.h"
#include "tests/support/instruction_sets.h"

namespace sightline::occlusion {
namespace {

using test::randomBox, test::randomView, test::ViewRandom;

constexpr std::uint32_t kPixelsWide = 320, kPixelsHigh = 180;

using Wide = long double;

// The extent of a box in the buffer, computed corner by corner with 64 bits of precision.
struct Exact {
  Wide x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY,
       y1 = -INFINITY;                 // in the buffer; where all depths are > 0
  Wide z0 = INFINITY, z1 = -INFINITY;  // depth
  Wide reach = 0;                      // sum of the largest magnitudes relative to the eye
  Wide beyond_side = -INFINITY;  // metres, about, that all of it is beyond one side of the view's volume

  Exact(const scene::PixelView& view, const Box& box) {
    const auto dotted = [](const Vec3d& a, const Wide* d) { return a.x * d[0] + a.y * d[1] + a.z * d[2]; };
    const Wide left = view.middle_x / static_cast<Wide>(view.scale_x);
    const Wide right = (view.width - view.middle_x) / static_cast<Wide>(view.scale_x);
    const Wide bottom = view.middle_y / static_cast<Wide>(view.scale_y);
    const Wide top = (view.height - view.middle_y) / static_cast<Wide>(view.scale_y);
    Wide beyond[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    for (int axis = 0; axis < 3; ++axis) {
      reach += std::max(std::abs(static_cast<Wide>(box.min[axis]) - view.eye[axis]),
                        std::abs(static_cast<Wide>(box.max[axis]) - view.eye[axis]));
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
      Wide d[3];
      for (int axis = 0; axis < 3; ++axis) {
        d[axis] =
            static_cast<Wide>((corner >> axis & 1u) != 0 ? box.max[axis] : box.min[axis]) - view.eye[axis];
      }
      const Wide x = dotted(view.right, d), y = dotted(view.up, d), z = dotted(view.forward, d);
      const Wide by = view.orthographic ? 1 : z;
      z0 = std::min(z0, z);
      z1 = std::max(z1, z);
      x0 = std::min(x0, view.middle_x + view.scale_x * (x / by));
      x1 = std::max(x1, view.middle_x + view.scale_x * (x / by));
      y0 = std::min(y0, view.middle_y + view.scale_y * (y / by));
      y1 = std::max(y1, view.middle_y + view.scale_y * (y / by));
      const Wide out[4] = {-x - left * by, x - right * by, -y - bottom * by, y - top * by};
      for (int side = 0; side < 4; ++side) {
        beyond[side] = std::min(beyond[side], out[side]);
      }
    }
    beyond_side = *std::max_element(beyond, beyond + 4);
  }
};

// Rounding of a depth or position that is always allowed, metres.
Wide roundingOf(const scene::PixelView& view, const Exact& exact) {
  const Vec3d eye = abs(view.eye);
  return 0x1p-19L * exact.reach + 0x1p-44L * (eye.x + eye.y + eye.z);
}

std::uint32_t pixelOf(Wide at, std::uint32_t size) {
  return static_cast<std::uint32_t>(std::clamp<Wide>(std::floor(at), 0, size - 1));
}

PixelBox projectOne(const scene::PixelView& view, const Box& box) {
  PixelBox image;
  projectBoxes(view, kPixelsWide, kPixelsHigh, {&box, 1}, {&image, 1});
  return image;
}

TEST(PixelBoxes, RectangleAndDepthsHoldTheExactOnesAndAreTight) {
  int on_buffer = 0, whole = 0, outside = 0, unbounded = 0;
  for (std::uint64_t seed = 1; seed <= 60000; ++seed) {
    ViewRandom random(seed);
    const View eye_view = randomView(random);
    const scene::PixelView view(eye_view, kPixelsWide, kPixelsHigh);
    const Box box = randomBox(random, eye_view);
    const PixelBox image = projectOne(view, box);
    const Exact exact(view, box);
    const Wide rounding = roundingOf(view, exact);
    if (image.place == BoxPlace::kUnbounded) {
      ++unbounded;
      // The box reaches the near plane, or almost does in relation to its size.
      const bool near = exact.z0 <= view.near * (1 + 0x1p-20L) + rounding;
      EXPECT_TRUE(near || (!view.orthographic && exact.z0 < 200 * rounding)) << "seed " << seed;
      EXPECT_LT(exact.beyond_side,
                rounding * (1 + view.reachX() / view.scale_x + view.reachY() / view.scale_y))
          << "seed " << seed;
      continue;
    }
    if (image.place == BoxPlace::kOutside) {
      ++outside;
      const bool off = exact.beyond_side > 0 || exact.z1 < view.near || exact.z0 > view.far;
      EXPECT_TRUE(off) << "seed " << seed;
      continue;
    }
    ++on_buffer;
    ASSERT_GT(exact.z0, view.near) << "seed " << seed;
    // The allowed error of a position, pixels.
    const Wide ratio = view.orthographic ? 0 : rounding / exact.z0;
    const auto slack = [&](Wide at, double scale, double middle) {
      const Wide q = std::abs(at - middle) / scale;
      return scale * (view.orthographic ? rounding : ratio * (1 + q)) +
             0x1p-18L * (std::abs(middle) + std::abs(at));
    };
    const Wide left = slack(exact.x0, view.scale_x, view.middle_x);
    const Wide right = slack(exact.x1, view.scale_x, view.middle_x);
    const Wide bottom = slack(exact.y0, view.scale_y, view.middle_y);
    const Wide top = slack(exact.y1, view.scale_y, view.middle_y);
    EXPECT_LE(image.x0, pixelOf(exact.x0, kPixelsWide)) << "seed " << seed;
    EXPECT_GE(image.x1, pixelOf(exact.x1, kPixelsWide)) << "seed " << seed;
    EXPECT_LE(image.y0, pixelOf(exact.y0, kPixelsHigh)) << "seed " << seed;
    EXPECT_GE(image.y1, pixelOf(exact.y1, kPixelsHigh)) << "seed " << seed;
    EXPECT_GE(image.x0, pixelOf(exact.x0 - left, kPixelsWide)) << "seed " << seed;
    EXPECT_LE(image.x1, pixelOf(exact.x1 + right, kPixelsWide)) << "seed " << seed;
    EXPECT_GE(image.y0, pixelOf(exact.y0 - bottom, kPixelsHigh)) << "seed " << seed;
    EXPECT_LE(image.y1, pixelOf(exact.y1 + top, kPixelsHigh)) << "seed " << seed;
    EXPECT_FALSE(exact.x1 + right < 0 || exact.x0 - left > kPixelsWide || exact.y1 + top < 0 ||
                 exact.y0 - bottom > kPixelsHigh || exact.z0 > view.far * (1 + 0x1p-20L) + rounding)
        << "seed " << seed << ": surely outside";

    const Wide nearest = view.orthographic ? -exact.z0 : 1 / exact.z0;
    const Wide farthest = view.orthographic ? -exact.z1 : 1 / exact.z1;
    const auto reciprocal_depth_slack = [&](Wide depth) {
      return view.orthographic ? rounding : (1.1L * rounding / depth + 0x1p-20L) / depth;
    };
    EXPECT_GE(image.nearest, nearest) << "seed " << seed;
    EXPECT_LE(image.nearest, nearest + reciprocal_depth_slack(exact.z0)) << "seed " << seed;
    EXPECT_LE(image.farthest, farthest) << "seed " << seed;
    EXPECT_GE(image.farthest, farthest - reciprocal_depth_slack(exact.z1)) << "seed " << seed;

    const bool inside = exact.x0 >= 0 && exact.x1 <= kPixelsWide && exact.y0 >= 0 &&
                        exact.y1 <= kPixelsHigh && exact.z1 <= view.far;
    const bool well_inside = exact.x0 > left && exact.x1 + right < kPixelsWide && exact.y0 > bottom &&
                             exact.y1 + top < kPixelsHigh && exact.z1 * (1 + 0x1p-20L) + rounding < view.far;
    EXPECT_TRUE(!image.whole || inside) << "seed " << seed;
    EXPECT_TRUE(image.whole || !well_inside) << "seed " << seed;
    whole += image.whole ? 1 : 0;
  }
  EXPECT_GT(on_buffer, 10000);
  EXPECT_GT(whole, 3000);
  EXPECT_GT(outside, 1000);
  EXPECT_GT(unbounded, 1000);
}

TEST(PixelBoxes, ABoxBesideTheEyeIsOutsideThoughItCrossesTheNearPlane) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  const scene::PixelView pixels(view, kPixelsWide, kPixelsHigh);
  EXPECT_EQ(projectOne(pixels, {{5, -1, -2}, {6, 1, 2}}).place, BoxPlace::kOutside);
  EXPECT_EQ(projectOne(pixels, {{-1, -30, -2}, {1, -20, 2}}).place, BoxPlace::kOutside);
  EXPECT_EQ(projectOne(pixels, {{-1, -1, 1}, {1, 1, 2}}).place, BoxPlace::kOutside) << "behind the eye";
  EXPECT_EQ(projectOne(pixels, {{-1, -1, -3000}, {1, 1, -2000}}).place, BoxPlace::kOutside) << "too far";
  EXPECT_EQ(projectOne(pixels, {{0.5f, -1, -2}, {6, 1, 2}}).place, BoxPlace::kUnbounded);
  EXPECT_EQ(projectOne(pixels, {{-1, -1, -1}, {1, 1, 1}}).place, BoxPlace::kUnbounded) << "around the eye";
}

TEST(PixelBoxes, ABoxWhoseEdgesLieOnPixelBordersHasThePixelsOnBothSides) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.orthographic = true;
  view.ortho_height = 180.0;  // a pixel is a metre, the middle of the buffer the eye
  view.aspect = 320.0 / 180.0;
  const scene::PixelView pixels(view, kPixelsWide, kPixelsHigh);
  const PixelBox image = projectOne(pixels, {{-10, -20, -6}, {30, 5, -5}});
  ASSERT_EQ(image.place, BoxPlace::kOnBuffer);
  EXPECT_TRUE(image.whole);
  EXPECT_EQ(image.x0, 149);
  EXPECT_EQ(image.x1, 190);
  EXPECT_EQ(image.y0, 69);
  EXPECT_EQ(image.y1, 95);
}

TEST(PixelBoxes, BoxesThatAreNotWellFormedAndViewsThatSayNothingGiveNoRectangle) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Box bad[] = {Box{},
                     {{nan, 0, -5}, {1, 1, -4}},
                     {{0, 0, -5}, {1, inf, -4}},
                     {{-inf, -inf, -inf}, {inf, inf, inf}},
                     {{2, 0, -5}, {1, 1, -4}},
                     {{0, 0, -5}, {1, 1, nan}},
                     {{-3e38f, -3e38f, -3e38f}, {3e38f, 3e38f, 3e38f}}};
  View view;
  setOrientation(view, {0.1, 0.2, -1}, {0, 1, 0});
  for (const bool orthographic : {false, true}) {
    view.orthographic = orthographic;
    for (const Box& box : bad) {
      EXPECT_EQ(projectOne(scene::PixelView(view, kPixelsWide, kPixelsHigh), box), PixelBox{});
    }
  }
  const Box good{{-1, -1, -5}, {1, 1, -4}};
  for (double View::*member : {&View::tan_half_fovy, &View::aspect, &View::z_near}) {
    const double no_size = member == &View::z_near ? -1.0 : 0.0;
    for (const double value : {no_size, static_cast<double>(inf), static_cast<double>(nan)}) {
      View strange;
      setOrientation(strange, {0, 0, -1}, {0, 1, 0});
      strange.*member = value;
      EXPECT_EQ(projectOne(scene::PixelView(strange, kPixelsWide, kPixelsHigh), good), PixelBox{});
    }
  }
  View nowhere;
  setOrientation(nowhere, {0, 0, -1}, {0, 1, 0});
  nowhere.eye.y = nan;
  EXPECT_EQ(projectOne(scene::PixelView(nowhere, kPixelsWide, kPixelsHigh), good), PixelBox{});
}

TEST(PixelBoxes, EveryInstructionSetAndEverySplitGiveTheSameBits) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_FALSE(targets.empty());
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    ViewRandom random(seed);
    const View eye_view = randomView(random);
    const BoxProjection projection(scene::PixelView(eye_view, kPixelsWide, kPixelsHigh), kPixelsWide,
                                   kPixelsHigh);
    std::vector<Box> boxes;
    for (std::uint64_t i = 0; i < 1 + seed % 70; ++i) {
      boxes.push_back(randomBox(random, eye_view));
      if (random.below(20) == 0) {
        boxes.back().max.y = random.below(2) == 0 ? -1e30f : std::numeric_limits<float>::quiet_NaN();
      }
    }
    std::vector<PixelBox> whole(boxes.size());
    projectBoxes(projection, boxes, whole);
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      std::vector<PixelBox> images(boxes.size());
      projectBoxes(projection, boxes, images);
      EXPECT_EQ(images, whole) << hwy::TargetName(target) << ", seed " << seed;
    }
    const std::size_t cut = random.below(static_cast<std::uint32_t>(boxes.size()) + 1);
    std::vector<PixelBox> parts(boxes.size());
    projectBoxes(projection, std::span(boxes).first(cut), std::span(parts).first(cut));
    projectBoxes(projection, std::span(boxes).subspan(cut), std::span(parts).subspan(cut));
    EXPECT_EQ(parts, whole) << "seed " << seed;
  }
}

// ---- Points

Vec3f randomPoint(ViewRandom& random, const Box& box) {
  Vec3f point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<float>(random.in(box.min[axis], box.max[axis]));
  }
  return point;
}

TEST(PixelPoints, LieInTheirPixelsAndAreNoFartherThanTheySay) {
  int known = 0, unknown = 0;
  for (std::uint64_t seed = 1; seed <= 60000; ++seed) {
    ViewRandom random(seed);
    const View eye_view = randomView(random);
    const scene::PixelView view(eye_view, kPixelsWide, kPixelsHigh);
    const Vec3f point = randomPoint(random, randomBox(random, eye_view));
    PointImage image;
    projectPoints(BoxProjection(view, kPixelsWide, kPixelsHigh), {&point, 1}, {&image, 1});
    const Box box{point, point};
    const Exact exact(view, box);
    const PixelBox as_box = projectOne(view, box);
    if (image.x == PointImage::kUnknown) {
      ++unknown;
      EXPECT_EQ(image, PointImage{});
      const bool in_one_pixel =
          as_box.place == BoxPlace::kOnBuffer && as_box.x0 == as_box.x1 && as_box.y0 == as_box.y1;
      EXPECT_FALSE(as_box.whole && in_one_pixel) << "seed " << seed;
      continue;
    }
    ++known;
    ASSERT_EQ(as_box.place, BoxPlace::kOnBuffer) << "seed " << seed;
    EXPECT_TRUE(exact.z0 > view.near && exact.z0 < view.far) << "seed " << seed;
    EXPECT_EQ(static_cast<Wide>(image.x), std::floor(exact.x0)) << "seed " << seed;
    EXPECT_EQ(static_cast<Wide>(image.y), std::floor(exact.y0)) << "seed " << seed;
    EXPECT_LE(image.farthest, view.orthographic ? -exact.z0 : 1 / exact.z0) << "seed " << seed;
    EXPECT_EQ(image.farthest, as_box.farthest) << "seed " << seed;
  }
  EXPECT_GT(known, 10000);
  EXPECT_GT(unknown, 10000);
}

TEST(PixelPoints, OnPixelBordersOrOutsideTheViewAreUnknown) {
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.orthographic = true;
  view.ortho_height = 180.0;  // a pixel is a metre, the middle of the buffer the eye
  view.aspect = 320.0 / 180.0;
  view.z_far = 100.0;
  const BoxProjection projection(scene::PixelView(view, kPixelsWide, kPixelsHigh), kPixelsWide, kPixelsHigh);
  const auto imageOf = [&](const Vec3f& point) {
    PointImage image;
    projectPoints(projection, {&point, 1}, {&image, 1});
    return image;
  };
  EXPECT_EQ(imageOf({3.5f, -2.25f, -6}).x, 163);
  EXPECT_EQ(imageOf({3.5f, -2.25f, -6}).y, 87);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const Vec3f& point :
       {Vec3f(3, 0.5f, -6), Vec3f(0.5f, 3, -6), Vec3f(-160, 0.5f, -6), Vec3f(160.5f, 0.5f, -6),
        Vec3f(0.5f, 90.5f, -6), Vec3f(0.5f, 0.5f, 6), Vec3f(0.5f, 0.5f, 0), Vec3f(0.5f, 0.5f, -100),
        Vec3f(0.5f, 0.5f, -101), Vec3f(nan, 0.5f, -6), Vec3f(0.5f, 0.5f, nan), Vec3f(0.5f, -inf, -6)}) {
    EXPECT_EQ(imageOf(point), PointImage{}) << point.x << " " << point.y << " " << point.z;
  }
  PointImage image{.x = 1, .y = 1, .farthest = 1.0f};
  const Vec3f point{0.5f, 0.5f, -6};
  projectPoints(BoxProjection(), {&point, 1}, {&image, 1});
  EXPECT_EQ(image, PointImage{}) << "of no view";
}

TEST(PixelPoints, EveryInstructionSetAndEverySplitGiveTheSameBits) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    ViewRandom random(seed);
    const View eye_view = randomView(random);
    const BoxProjection projection(scene::PixelView(eye_view, kPixelsWide, kPixelsHigh), kPixelsWide,
                                   kPixelsHigh);
    std::vector<Vec3f> points;
    for (std::uint64_t i = 0; i < 1 + seed % 70; ++i) {
      points.push_back(randomPoint(random, randomBox(random, eye_view)));
    }
    std::vector<PointImage> whole(points.size()), parts(points.size());
    projectPoints(projection, points, whole);
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      std::vector<PointImage> images(points.size());
      projectPoints(projection, points, images);
      EXPECT_EQ(images, whole) << hwy::TargetName(target) << ", seed " << seed;
    }
    const std::size_t cut = random.below(static_cast<std::uint32_t>(points.size()) + 1);
    projectPoints(projection, std::span(points).first(cut), std::span(parts).first(cut));
    projectPoints(projection, std::span(points).subspan(cut), std::span(parts).subspan(cut));
    EXPECT_EQ(parts, whole) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline::occlusion
