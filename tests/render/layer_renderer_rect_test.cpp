#include "src/render/layers/layer_renderer_rect.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/random_numbers.h"

namespace sightline::render {
namespace {

constexpr std::uint32_t kRectWidth = 200, kRectHeight = 100;

struct Case {
  View view;
  LensPoint lens;
  Box box;
  Mat4 scene_from_box;
};

// A random view and box: around, before or behind the eye, large or small.
Case randomCase(std::mt19937& random) {
  const auto between = test::numbersFrom<double>(random);
  Case c;
  c.view.eye = {between(-3, 3), between(-3, 3), between(-3, 3)};
  setOrientation(c.view, {between(-1, 1), between(-1, 1), between(-1, 1)}, {0.0, 1.0, 0.1});
  c.view.orthographic = between(0, 1) < 0.3;
  c.view.z_near = between(0.01, 1.0);
  c.view.aspect = 2.0;
  if (between(0, 1) < 0.5) {
    c.lens = {between(-0.5, 0.5), between(-0.5, 0.5), between(1, 10)};
  }
  const double size = between(0, 1) < 0.5 ? 0.3 : 6.0;
  for (int corner = 0; corner < 2; ++corner) {
    c.box.extend(Vec3f(Vec3d(between(-size, size), between(-size, size), between(-size, size))));
  }
  c.scene_from_box(0, 0) = between(-2, 2);
  c.scene_from_box(0, 1) = between(-1, 1);
  c.scene_from_box(2, 3) = between(-8, 8);
  return c;
}

// Where a point of the scene is drawn, in pixels from the lower left.
struct Drawn {
  double x = 0.0, y = 0.0;
  bool seen = false;
};

Drawn project(const Case& c, const Vec3d& point) {
  const Vec3d p = point - c.view.eye;
  const double z = dot(p, c.view.forward);
  // On the plane of focus, along the line from the point to the lens point.
  const double over = c.view.orthographic ? 1.0 : z;
  const double x = (dot(p, c.view.right) - c.lens.right * (1.0 - z / c.lens.focus)) / over;
  const double y = (dot(p, c.view.up) - c.lens.up * (1.0 - z / c.lens.focus)) / over;
  const double half = c.view.orthographic ? 0.5 * c.view.ortho_height : c.view.tan_half_fovy;
  const double u = x / (half * c.view.aspect), v = y / half;
  const bool inside = std::abs(u) <= 1.0 && std::abs(v) <= 1.0 && z >= c.view.z_near && z <= c.view.z_far;
  return {(u + 1.0) * 0.5 * kRectWidth, (v + 1.0) * 0.5 * kRectHeight, inside};
}

TEST(LayerRendererRect, HoldsAllPointsOfItsBoxesThatAreSeen) {
  constexpr std::uint32_t kSeed = 21;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int seen = 0, partial = 0;
  for (int i = 0; i < 300; ++i) {
    const Case c = randomCase(random);
    RectCollector collector(c.view, c.lens, kRectWidth, kRectHeight);
    collector.add(c.box, c.scene_from_box);
    const PixelRect& rect = collector.rect();
    partial += rect.width() * rect.height() < kRectWidth * kRectHeight / 2 ? 1 : 0;
    for (int k = 0; k < 100; ++k) {
      const Vec3d min(c.box.min), size = Vec3d(c.box.max) - min;
      const Vec3d at(min.x + size.x * share(random), min.y + size.y * share(random),
                     min.z + size.z * share(random));
      const Drawn drawn = project(c, transformPoint(c.scene_from_box, at));
      if (drawn.seen) {
        ++seen;
        ASSERT_TRUE(drawn.x >= rect.left && drawn.x <= rect.right && drawn.y >= rect.bottom &&
                    drawn.y <= rect.top)
            << "seed " << kSeed << ", case " << i << ": " << drawn.x << ", " << drawn.y;
      }
    }
  }
  EXPECT_GT(seen, 2000);
  EXPECT_GT(partial, 100);
}

View plainView() {
  View view;
  setOrientation(view, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0});
  view.aspect = 2.0;
  return view;
}

TEST(LayerRendererRect, IsHardlyLargerThanTheBoxes) {
  RectCollector collector(plainView(), {}, kRectWidth, kRectHeight);
  EXPECT_EQ(collector.rect(), PixelRect{});
  // At a depth of 10 the picture is 20 by 10 metres, ten pixels a metre.
  collector.add({{-2.0f, 1.0f, -10.0f}, {-1.0f, 2.0f, -10.0f}}, {});
  EXPECT_EQ(collector.rect(), (PixelRect{79, 59, 91, 71}));
  collector.add({{3.0f, -3.0f, -10.0f}, {4.0f, -2.0f, -10.0f}}, {});
  EXPECT_EQ(collector.rect(), (PixelRect{79, 19, 141, 71}));
  EXPECT_FALSE(collector.full());
  collector.add({{-1.0f, -1.0f, 1.0f}, {1.0f, 1.0f, 2.0f}}, {});       // behind the eye
  collector.add({{40.0f, -1.0f, -10.0f}, {41.0f, 1.0f, -10.0f}}, {});  // beside the picture
  collector.add(Box{}, {});
  EXPECT_EQ(collector.rect(), (PixelRect{79, 19, 141, 71}));
}

TEST(LayerRendererRect, IsThePictureWhereABoxIsAroundTheEyeOrNotFinite) {
  const float infinity = std::numeric_limits<float>::infinity();
  Mat4 nowhere;
  nowhere(1, 3) = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [box, place] : {std::pair<Box, Mat4>{{{-1, -1, -1}, {1, 1, 1}}, {}},
                                   {{{0, 0, -9}, {infinity, 1, -8}}, {}},
                                   {{{0, 0, -9}, {1, 1, -8}}, nowhere}}) {
    RectCollector collector(plainView(), {}, kRectWidth, kRectHeight);
    collector.add(box, place);
    EXPECT_TRUE(collector.full());
  }
}

}  // namespace
}  // namespace sightline::render
