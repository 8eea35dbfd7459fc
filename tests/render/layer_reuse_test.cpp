#include "sightline/render/layer_reuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "tests/render/largest_difference.h"
#include "tests/render/test_scene.h"
#include "tests/support/not_finite.h"
#include "tests/support/translation.h"

namespace sightline {
namespace {

constexpr std::uint32_t kReuseWidth = 96, kReuseHeight = 72;
using test::kNan;
using test::translation;
// The size of a pixel in metres, ten metres from the eye, where the picture is ten metres high.
constexpr double kPixel = 10.0 / kReuseHeight;

// A rotation about the y axis.
Mat4 turned(double angle) {
  Mat4 m;
  m(0, 0) = m(2, 2) = std::cos(angle);
  m(0, 2) = std::sin(angle);
  m(2, 0) = -std::sin(angle);
  return m;
}

View pannedView(double angle) {
  View view = testView();
  setOrientation(view, {std::sin(angle), 0.0, -std::cos(angle)}, {0.0, 1.0, 0.0});
  return view;
}

std::vector<ObjectId> ids(std::initializer_list<std::uint32_t> numbers) {
  return std::vector<ObjectId>(numbers.begin(), numbers.end());
}

// Draws each frame with reuse and, for comparison, in full.
class Reused {
 public:
  Reused(const Scene& scene, const ReuseSettings& settings)
      : guarded_(rendererOf(scene, settings.guard_px)),
        plain_(rendererOf(scene, 0)),
        reuse(scene.view(), *guarded_, settings) {}

  void begin(const View& view, std::vector<Mat4> transforms = {}) {
    view_ = view;
    plain_->setTransforms(transforms);
    reuse.beginFrame(view, transforms);
  }
  // Returns whether the layer was redrawn.
  bool draw(const std::vector<ObjectId>& layer, const LayerDraw& how = {}) {
    const std::uint64_t before = reuse.stats().drawn;
    reuse.image(layer, how, image);
    plain_->draw(view_, layer, how, expected);
    return reuse.stats().drawn > before;
  }
  bool drawFrame(const View& view, const std::vector<Mat4>& transforms, const std::vector<ObjectId>& layer) {
    begin(view, transforms);
    return draw(layer);
  }

 private:
  static std::unique_ptr<LayerRenderer> rendererOf(const Scene& scene, std::uint32_t guard) {
    Result<LayerRenderer> renderer = LayerRenderer::create(
        scene.view(), {.width = kReuseWidth + 2 * guard, .height = kReuseHeight + 2 * guard});
    EXPECT_TRUE(renderer.has_value());
    return std::make_unique<LayerRenderer>(std::move(renderer.value()));
  }

  std::unique_ptr<LayerRenderer> guarded_, plain_;
  View view_;

 public:
  LayerReuse reuse;
  LayerImage image, expected;  // of the last draw(): with reuse and in full
};

double covered(const LayerImage& image) {
  double sum = 0.0;
  for (const ShapedPixel& p : image.pixels) {
    sum += p.alpha;
  }
  return sum;
}

bool isCovered(const LayerImage& image, int x, int y) {
  return x >= 0 && y >= 0 && x < static_cast<int>(kReuseWidth) && y < static_cast<int>(kReuseHeight) &&
         image.pixels[static_cast<std::size_t>(y) * kReuseWidth + static_cast<std::size_t>(x)].alpha >= 0.5f;
}

// The largest distance, in pixels, from a pixel that one picture covers to the nearest one that the other
// covers; at most 9.
double farthestCovered(const LayerImage& a, const LayerImage& b) {
  constexpr int kReach = 8;
  double farthest = 0.0;
  for (int y = 0; y < static_cast<int>(kReuseHeight); ++y) {
    for (int x = 0; x < static_cast<int>(kReuseWidth); ++x) {
      if (!isCovered(a, x, y) || isCovered(b, x, y)) {
        continue;
      }
      double nearest = kReach + 1;
      for (int v = -kReach; v <= kReach; ++v) {
        for (int u = -kReach; u <= kReach; ++u) {
          nearest = isCovered(b, x + u, y + v) ? std::min(nearest, std::hypot(u, v)) : nearest;
        }
      }
      farthest = std::max(farthest, nearest);
    }
  }
  return farthest;
}

class LayerReuseTest : public RenderTest {
 protected:
  SceneMaker maker;
};

TEST_F(LayerReuseTest, FirstImageIsWhatTheRendererDraws) {
  maker.box({-1.1f, -0.9f, -1.0f}, {1.2f, 0.8f, 1.0f}, kRed);
  maker.wall(-4.0, 30.0, kGreen);
  for (const std::uint32_t guard : {0u, 7u, 24u}) {
    Reused reused(maker.scene, {.guard_px = guard});
    EXPECT_EQ(reused.reuse.width(), kReuseWidth);
    EXPECT_EQ(reused.reuse.height(), kReuseHeight);
    View view = testView();
    view.shift_x = 0.25 * (guard % 3);
    view.shift_y = -0.125 * (guard % 3);
    reused.begin(view);
    for (const std::uint32_t object : {0u, 1u}) {
      EXPECT_TRUE(reused.draw(ids({object})));
      EXPECT_LT(largestDifference(reused.image, reused.expected), 1e-4) << guard;
    }
    EXPECT_EQ(reused.reuse.stats().triangles, 14u);
    EXPECT_EQ(reused.reuse.stats().drawn_triangles, 14u);
  }
}

TEST_F(LayerReuseTest, PlaneMovedParallelToThePictureIsShiftedExactly) {
  maker.wall(0.0, 1.43, kRed);
  for (const auto& [right, down] : {std::pair(3, 2), {-11, 5}, {0, -7}, {20, 0}}) {
    Reused reused(maker.scene, {.tolerance_px = 0.01});
    View view = testView();
    view.shift_x = 0.02 * down;
    view.shift_y = 0.01 * right;
    EXPECT_TRUE(reused.drawFrame(view, {Mat4{}}, ids({0})));
    EXPECT_FALSE(reused.drawFrame(view, {translation({right * kPixel, -down * kPixel, 0.0})}, ids({0})));
    // The light of the wall is the same; haze differs a little with the distance from the eye.
    EXPECT_LT(largestDifference(reused.image, reused.expected), 5e-3) << right << ' ' << down;
    EXPECT_GT(covered(reused.image), 300.0);
    EXPECT_LT(reused.reuse.stats().largest_error_px, 1e-6);
  }
}

TEST_F(LayerReuseTest, ParallelMovementByPartsOfAPixelMovesTheMiddleOfWhatIsCoveredByThem) {
  maker.wall(0.0, 1.43, kRed);
  Reused reused(maker.scene, {.tolerance_px = 0.01});
  reused.drawFrame(testView(), {Mat4{}}, ids({0}));
  const auto middle = [&] {
    double x = 0.0, y = 0.0;
    for (std::size_t i = 0; i < reused.image.pixels.size(); ++i) {
      x += reused.image.pixels[i].alpha * static_cast<double>(i % kReuseWidth);
      y += reused.image.pixels[i].alpha * static_cast<double>(i / kReuseWidth);
    }
    return std::pair(x / covered(reused.image), y / covered(reused.image));
  };
  const auto before = middle();
  const double area = covered(reused.image);
  EXPECT_FALSE(reused.drawFrame(testView(), {translation({3.3 * kPixel, -1.6 * kPixel, 0.0})}, ids({0})));
  const auto after = middle();
  EXPECT_NEAR(after.first - before.first, 3.3, 1e-3);
  EXPECT_NEAR(after.second - before.second, 1.6, 1e-3);
  EXPECT_NEAR(covered(reused.image), area, 1e-2);
}

TEST_F(LayerReuseTest, ToleranceOfZeroDrawsWhatHasMovedAndNothingElse) {
  maker.box({-3, -1, -1}, {-1, 1, 1}, kRed);
  maker.box({1, -1, -1}, {3, 1, 1}, kGreen);
  Reused reused(maker.scene, {.tolerance_px = 0.0});
  LayerImage first;
  for (int frame = 0; frame < 4; ++frame) {
    reused.begin(testView(), {translation({0.01 * frame, 0, 0}), Mat4{}});
    EXPECT_TRUE(reused.draw(ids({0})));
    EXPECT_EQ(reused.draw(ids({1})), frame == 0);
    if (frame == 0) {
      first = reused.image;
    }
    EXPECT_EQ(reused.image.pixels, first.pixels);
  }
  for (int frame = 1; frame < 4; ++frame) {
    reused.begin(pannedView(0.001 * frame), {Mat4{}, Mat4{}});
    EXPECT_TRUE(reused.draw(ids({0})));
    EXPECT_TRUE(reused.draw(ids({1})));
  }
  EXPECT_EQ(reused.reuse.stats().layers, 14u);
  EXPECT_EQ(reused.reuse.stats().drawn, 11u);
  EXPECT_EQ(reused.reuse.stats().drawn_triangles, 11u * 12u);
}

// A box that the eye flies past.
TEST_F(LayerReuseTest, LargerTolerancesDrawLessAndAreWrongByMore) {
  maker.box({-1.5f, -1.0f, -3.0f}, {1.5f, 1.0f, 1.0f}, kRed);
  double drawn_before = 1e9, difference_before = -1.0, error_before = -1.0;
  for (const double tolerance : {0.2, 1.0, 4.0}) {
    Reused reused(maker.scene, {.tolerance_px = tolerance, .max_stretch = 10.0});
    double difference = 0.0;
    for (int frame = 0; frame < 40; ++frame) {
      reused.drawFrame(testView({0.08 * frame - 1.6, 0.5, 10.0}), {}, ids({0}));
      difference += measureDifference(reused.image, reused.expected).mean;
      // Resampling, and pixels that one of two rasterised edges takes, are no more than a pixel each.
      const double off = std::max(farthestCovered(reused.image, reused.expected),
                                  farthestCovered(reused.expected, reused.image));
      EXPECT_LE(off, tolerance + 2.0) << "frame " << frame;
    }
    const ReuseStats& stats = reused.reuse.stats();
    EXPECT_EQ(stats.layers, 40u);
    EXPECT_LT(static_cast<double>(stats.drawn), drawn_before);
    EXPECT_GT(difference, difference_before);
    EXPECT_GT(stats.largest_error_px, error_before);
    EXPECT_LE(stats.largest_error_px, tolerance);
    drawn_before = static_cast<double>(stats.drawn);
    difference_before = difference;
    error_before = stats.largest_error_px;
  }
  EXPECT_LT(drawn_before, 10.0);
}

TEST_F(LayerReuseTest, LayersOfOtherObjectsAreDrawnAnew) {
  maker.box({-3, -1, -1}, {-1, 1, 1}, kRed);
  maker.box({1, -1, -1}, {3, 1, 1}, kGreen);
  Reused reused(maker.scene, {});
  EXPECT_TRUE(reused.drawFrame(testView(), {}, ids({0})));
  EXPECT_FALSE(reused.drawFrame(testView(), {}, ids({0})));
  EXPECT_TRUE(reused.drawFrame(testView(), {}, ids({1, 0})));
  EXPECT_FALSE(reused.drawFrame(testView(), {}, ids({0, 1})));
  EXPECT_EQ(largestDifference(reused.image, reused.expected), 0.0);
  // An image that was not asked for in one frame is dropped.
  EXPECT_TRUE(reused.drawFrame(testView(), {}, ids({0})));
}

TEST_F(LayerReuseTest, WhatComesIntoViewIsDrawnUnlessTheGuardBandHasIt) {
  // Boxes from far left to far right, in one object's place each.
  for (int i = -9; i < 10; ++i) {
    const auto x = static_cast<float>(i);
    maker.box({x, -1, -1}, {x + 0.6f, 1, 1}, i % 2 ? kRed : kGreen);
  }
  const std::vector<ObjectId> all = allOf(maker.scene);
  const double pixel = 1.0 / kReuseHeight;  // of turning, in the middle of the picture
  Reused without(maker.scene, {.tolerance_px = 1.5}),
      with(maker.scene, {.tolerance_px = 1.5, .guard_px = 12});
  EXPECT_TRUE(without.drawFrame(pannedView(0.0), {}, all));
  EXPECT_TRUE(with.drawFrame(pannedView(0.0), {}, all));
  EXPECT_TRUE(without.drawFrame(pannedView(5 * pixel), {}, all));
  EXPECT_FALSE(with.drawFrame(pannedView(5 * pixel), {}, all));
  // Far side and all: what has come in is there, to the last column.
  for (std::uint32_t y = 0; y < kReuseHeight; ++y) {
    const std::size_t i = std::size_t{y} * kReuseWidth + kReuseWidth - 1;
    EXPECT_NEAR(with.image.pixels[i].alpha, with.expected.pixels[i].alpha, 0.75f) << y;
  }
  EXPECT_LE(std::max(farthestCovered(with.image, with.expected), farthestCovered(with.expected, with.image)),
            3.0);
  EXPECT_TRUE(with.drawFrame(pannedView(20 * pixel), {}, all));
}

TEST_F(LayerReuseTest, LayersThatEndInsideThePictureNeedNoGuardBand) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {});
  EXPECT_TRUE(reused.drawFrame(pannedView(0.0), {}, ids({0})));
  EXPECT_FALSE(reused.drawFrame(pannedView(0.05), {}, ids({0})));
}

TEST_F(LayerReuseTest, LayerIsDrawnWhenAnObjectOfItComesIntoView) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  maker.box({-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}, kGreen);
  for (const Mat4& outside : {translation({30, 0, 0}), translation({-30, 0, 0}), translation({0, 0, 40})}) {
    Reused reused(maker.scene, {.tolerance_px = 50.0});
    EXPECT_TRUE(reused.drawFrame(testView(), {Mat4{}, outside}, ids({0, 1})));
    // It moves, but still where nobody sees it.
    Mat4 elsewhere = outside;
    elsewhere(1, 3) = 1.0;
    EXPECT_FALSE(reused.drawFrame(testView(), {Mat4{}, elsewhere}, ids({0, 1})));
    EXPECT_TRUE(reused.drawFrame(testView(), {Mat4{}, translation({3, 0, 0})}, ids({0, 1})));
    EXPECT_EQ(largestDifference(reused.image, reused.expected), 0.0);
  }
}

TEST_F(LayerReuseTest, OtherKindsOfViewsAreDrawnAnew) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {.tolerance_px = 1000.0, .max_stretch = 1000.0});
  View view = testView();
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  view.tan_half_fovy = 0.6;  // the same kind
  EXPECT_FALSE(reused.drawFrame(view, {}, ids({0})));
  view.z_near = 0.2;
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  view.z_far = 500.0;
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  view.orthographic = true;
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  EXPECT_FALSE(reused.drawFrame(view, {}, ids({0})));
}

TEST_F(LayerReuseTest, OrthographicViewsShiftExactlyWhereverThingsAre) {
  maker.box({-1, -1, -6}, {1, 1, 1}, kRed);
  View view = testView();
  view.orthographic = true;
  view.ortho_height = 10.0;
  Reused reused(maker.scene, {.tolerance_px = 0.01, .guard_px = 5});
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  view.eye = view.eye + Vec3d(4 * kPixel, 0, 0);
  EXPECT_FALSE(reused.drawFrame(view, {}, ids({0})));
  EXPECT_LT(largestDifference(reused.image, reused.expected), 2e-3);
}

// The window moves as jitter between frames moves it.
TEST_F(LayerReuseTest, AWindowMovedByWholePixelsShiftsTheImageExactly) {
  maker.wall(0.0, 1.43, kRed);
  Reused reused(maker.scene, {.tolerance_px = 0.01});
  View view = testView();
  EXPECT_TRUE(reused.drawFrame(view, {}, ids({0})));
  view.shift_x = 2.0 * 3 / kReuseWidth;
  view.shift_y = -2.0 * 5 / kReuseHeight;
  EXPECT_FALSE(reused.drawFrame(view, {}, ids({0})));
  EXPECT_LT(largestDifference(reused.image, reused.expected), 5e-3);
  EXPECT_GT(covered(reused.image), 300.0);
}

TEST_F(LayerReuseTest, LayersOutsideTheViewCostNothing) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  maker.scene.objects.back().index_count = 0;
  Reused reused(maker.scene, {});
  for (const Mat4& outside : {translation({30, 0, 0}), translation({0, -20, 0}), translation({0, 0, 40}),
                              translation({0, 0, -2000})}) {
    EXPECT_FALSE(reused.drawFrame(testView(), {outside}, ids({0})));
    EXPECT_EQ(reused.image.pixels, std::vector<ShapedPixel>(kReuseWidth * kReuseHeight));
  }
  EXPECT_FALSE(reused.drawFrame(testView(), {}, {}));
  EXPECT_FALSE(reused.drawFrame(testView(), {}, ids({1})));
  EXPECT_FALSE(reused.drawFrame(testView(), {}, ids({2, 4000000000u})));
  EXPECT_FALSE(reused.draw(ids({1}), {.depths = true}));
  EXPECT_EQ(reused.image.depths, std::vector<float>(kReuseWidth * kReuseHeight, LayerImage::kNoDepth));
  EXPECT_EQ(reused.reuse.stats().layers, 0u);
}

TEST_F(LayerReuseTest, ImagesAreDrawnAnewAfterSoManyFrames) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {.max_frames = 3});
  for (int frame = 0; frame < 9; ++frame) {
    EXPECT_EQ(reused.drawFrame(testView(), {}, ids({0})), frame % 3 == 0) << frame;
  }
}

TEST_F(LayerReuseTest, ObjectsThatHaveTurnedAreDrawnAnew) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {.tolerance_px = 100.0, .max_stretch = 100.0, .max_turn = 0.1});
  for (int frame = 0; frame < 8; ++frame) {
    // The frames' turns are 0.03: more than 0.1 are four of them.
    EXPECT_EQ(reused.drawFrame(testView(), {turned(0.03 * frame)}, ids({0})), frame % 4 == 0) << frame;
  }
}

// Turns about the line of sight move the picture exactly as a warp does; its shading turns with it.
TEST_F(LayerReuseTest, AnObjectsScaleDoesNotChangeHowFarItMayTurn) {
  for (const Vec3d& scale : {Vec3d(1, 1, 1), Vec3d(0.001, 0.001, 0.001), Vec3d(100, 100, 100),
                             Vec3d(0.001, 0.001, 100), Vec3d(1, 1, 0)}) {
    SCOPED_TRACE(scale.x);
    SceneMaker stored;
    const Vec3f half(static_cast<float>(1.0 / scale.x), static_cast<float>(1.0 / scale.y),
                     static_cast<float>(scale.z > 0.0 ? 1.0 / scale.z : 1.0));
    stored.box(half * -1.0f, half, kRed);
    const auto placed = [&](double angle) {
      Mat4 m;
      m(0, 0) = std::cos(angle) * scale.x;
      m(1, 0) = std::sin(angle) * scale.x;
      m(0, 1) = -std::sin(angle) * scale.y;
      m(1, 1) = std::cos(angle) * scale.y;
      m(2, 2) = scale.z;
      return m;
    };
    Reused reused(stored.scene, {.tolerance_px = 1.0, .max_turn = 0.1});
    EXPECT_TRUE(reused.drawFrame(testView(), {placed(0.0)}, ids({0})));
    EXPECT_FALSE(reused.drawFrame(testView(), {placed(0.05)}, ids({0})));
    EXPECT_TRUE(reused.drawFrame(testView(), {placed(3.1)}, ids({0})));
  }
}

TEST_F(LayerReuseTest, ImagesAreNotStretchedFurtherThanAllowed) {
  maker.wall(0.0, 1.0, kRed);
  Reused reused(maker.scene, {.tolerance_px = 0.5, .max_stretch = 1.25});
  EXPECT_TRUE(reused.drawFrame(testView({0, 0, 10.0}), {}, ids({0})));
  EXPECT_FALSE(reused.drawFrame(testView({0, 0, 8.1}), {}, ids({0})));  // 1.235
  EXPECT_TRUE(reused.drawFrame(testView({0, 0, 7.9}), {}, ids({0})));   // 1.266
  EXPECT_FALSE(reused.drawFrame(testView({0, 0, 9.8}), {}, ids({0})));  // 1 / 1.241
  EXPECT_TRUE(reused.drawFrame(testView({0, 0, 10.0}), {}, ids({0})));  // 1 / 1.266
}

// A floor.
TEST_F(LayerReuseTest, FlatThingsSeenAtASlantNeedProjectiveWarps) {
  maker.box({-3, -2, -9}, {3, -1.9f, 3}, kRed);
  maker.scene.indices.resize(6);  // of a box's triangles, two of one side
  maker.scene.indices = {2, 6, 7, 2, 7, 3};
  maker.scene.objects[0].index_count = 6;
  const View before = testView(), after = testView({0.9, 0.2, 9.8});
  ReuseSettings settings{.tolerance_px = 0.1, .guard_px = 20, .max_stretch = 2.0};
  Reused projective(maker.scene, settings);
  settings.warp = ReuseWarp::kAffine;
  Reused affine(maker.scene, settings);
  EXPECT_TRUE(affine.drawFrame(before, {}, ids({0})));
  EXPECT_TRUE(affine.drawFrame(after, {}, ids({0})));
  EXPECT_TRUE(projective.drawFrame(before, {}, ids({0})));
  EXPECT_FALSE(projective.drawFrame(after, {}, ids({0})));
  EXPECT_LT(projective.reuse.stats().largest_error_px, 0.01);
  EXPECT_GT(covered(projective.image), 200.0);
  EXPECT_LE(farthestCovered(projective.image, projective.expected), 1.5);
  EXPECT_LE(farthestCovered(projective.expected, projective.image), 1.5);
}

TEST_F(LayerReuseTest, DepthsAndPointsOfALensAreDrawnEachTime) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {.guard_px = 6});
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_TRUE(reused.drawFrame(testView(), {}, ids({0})) == (frame == 0));
    EXPECT_TRUE(reused.draw(ids({0}), {.depths = true}));
    ASSERT_EQ(reused.image.depths.size(), reused.expected.depths.size());
    for (std::size_t i = 0; i < reused.image.depths.size(); ++i) {
      const float a = reused.image.depths[i], b = reused.expected.depths[i];
      EXPECT_TRUE(a == b || std::abs(a - b) < 1e-3f) << i;
    }
    EXPECT_TRUE(reused.draw(ids({0}), {.lens = {.right = 0.1, .focus = 10.0}}));
  }
}

// A box moves before a wall and away again.
TEST_F(LayerReuseTest, WhatIsDrawnWithoutWhatOthersHideIsDrawnEachTime) {
  maker.wall(0.0, 2.0, kGlass);
  maker.box({-1, -1, 1}, {1, 1, 2}, kRed);
  Result<LayerRenderer> renderer =
      LayerRenderer::create(maker.scene.view(), {.width = kReuseWidth, .height = kReuseHeight});
  ASSERT_TRUE(renderer.has_value());
  LayerReuse reuse(maker.scene.view(), *renderer, {});
  for (const double x : {9.0, 0.0, 0.0, 9.0}) {
    reuse.beginFrame(testView(), std::vector{Mat4{}, translation({x, 0, 0})});
    renderer->hideBehind(testView(), ids({1}));
    LayerImage image, expected;
    reuse.image(ids({0}), {.hidden = true}, image);
    renderer->draw(testView(), ids({0}), {.hidden = true}, expected);
    EXPECT_EQ(image.pixels, expected.pixels) << x;
    EXPECT_GT(covered(image), 50.0);
  }
  EXPECT_EQ(reuse.stats().drawn, 4u);
}

// The planes by which objects are cut may change in any frame.
TEST_F(LayerReuseTest, PiecesAreDrawnEachTime) {
  maker.wall(0.0, 1.0, kRed);
  maker.wall(-1.0, 1.0, kGreen);
  Result<LayerRenderer> renderer =
      LayerRenderer::create(maker.scene.view(), {.width = kReuseWidth, .height = kReuseHeight});
  ASSERT_TRUE(renderer.has_value());
  LayerReuse reuse(maker.scene.view(), *renderer, {});
  for (const double at : {0.0, 0.0, 0.4}) {
    const Plane plane{{1, 0, 0}, -at};
    renderer->setPieces(
        {{ObjectId(2u), ObjectId(0u), {{plane, true}}}, {ObjectId(3u), ObjectId(0u), {{plane, false}}}});
    reuse.beginFrame(testView(), {});
    for (const std::vector<ObjectId>& layer : {ids({2}), ids({3}), ids({3, 1})}) {
      LayerImage image, expected;
      reuse.image(layer, {}, image);
      renderer->draw(testView(), layer, {}, expected);
      EXPECT_EQ(image.pixels, expected.pixels) << at;
      EXPECT_GT(covered(image), 20.0);
    }
  }
  EXPECT_EQ(reuse.stats().drawn, 9u);
  EXPECT_EQ(reuse.stats().layers, 9u);
  reuse.beginFrame(testView(), std::vector{translation({90, 0, 0})});
  LayerImage image;
  reuse.image(ids({2}), {}, image);
  EXPECT_EQ(covered(image), 0.0);
  EXPECT_EQ(reuse.stats().layers, 9u) << "a piece of what is outside the view costs nothing";
}

TEST_F(LayerReuseTest, LengthsOfAxesDoNotMatter) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  for (const bool orthographic : {false, true}) {
    Reused reused(maker.scene, {.guard_px = 4}), other(maker.scene, {.guard_px = 4});
    for (int frame = 0; frame < 6; ++frame) {
      View view = testView();
      view.orthographic = orthographic;
      const std::vector<Mat4> places{translation({0.5 * frame, 0.1 * frame, 0})};
      const bool drawn = reused.drawFrame(view, places, ids({0}));
      view.right = view.right * (2.0 + frame);
      view.up = view.up * 0.25;
      view.forward = view.forward * 7.0;
      EXPECT_EQ(other.drawFrame(view, places, ids({0})), drawn);
      EXPECT_EQ(other.image.pixels, reused.image.pixels) << "frame " << frame;
      EXPECT_GT(covered(other.image), 100.0);
    }
    EXPECT_LT(reused.reuse.stats().drawn, 6u);
  }
}

TEST_F(LayerReuseTest, WhatIsPeeledIsKeptAsSuch) {
  maker.wall(0.0, 1.0, kGlass);
  Reused reused(maker.scene, {});
  EXPECT_TRUE(reused.drawFrame(testView(), {}, ids({0})));
  EXPECT_TRUE(reused.draw(ids({0}), {.peel = true}));
  EXPECT_FALSE(reused.draw(ids({0}), {.peel = true}));
  EXPECT_TRUE(reused.draw(ids({0})));
}

TEST_F(LayerReuseTest, WhatCrossesTheNearPlaneIsDrawnEachTime) {
  maker.box({-0.2f, -0.3f, -5.0f}, {0.2f, 0.3f, 9.95f}, kBlueBothSides);
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  Reused reused(maker.scene, {.tolerance_px = 50.0});
  for (int frame = 0; frame < 3; ++frame) {
    reused.begin(testView({0.01 * frame, 0.0, 10.0}));
    EXPECT_TRUE(reused.draw(ids({0})));
    EXPECT_TRUE(reused.draw(ids({0, 1})));
    EXPECT_EQ(largestDifference(reused.image, reused.expected), 0.0);
  }
  // It comes there from before the eye.
  EXPECT_TRUE(reused.drawFrame(testView(), {Mat4{}, translation({0, 0, 2})}, ids({1})));
  EXPECT_TRUE(reused.drawFrame(testView(), {Mat4{}, translation({0, 0, 9.5})}, ids({1})));
}

TEST_F(LayerReuseTest, WhatIsNotFiniteIsDrawnEachTimeAndHarmsNothingElse) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  maker.box({-3, -1, -1}, {-2, 1, 1}, kGreen);
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0}) {
    Reused reused(maker.scene, {.guard_px = 4});
    for (int element = 0; element < 12; ++element) {
      Mat4 hostile;
      hostile(element % 3, element / 3) = bad;
      for (int frame = 0; frame < 3; ++frame) {
        reused.begin(testView(), {frame == 2 ? Mat4{} : hostile, Mat4{}});
        const bool is_drawn = reused.draw(ids({0}));
        EXPECT_TRUE(std::isfinite(bad) || frame == 1 || is_drawn) << bad << ' ' << element;
        EXPECT_EQ(reused.image.pixels.size(), std::size_t{kReuseWidth} * kReuseHeight);
        EXPECT_TRUE(std::isfinite(covered(reused.image)));
        reused.draw(ids({0, 1}));
        EXPECT_EQ(reused.draw(ids({1})), element == 0 && frame == 0);
      }
    }
  }
}

TEST_F(LayerReuseTest, WhatIsDrawnAsGivenIsNotReused) {
  maker.wall(0.0, 1.0, kGlass);
  maker.scene.materials[kGreen].opacity = Opacity::kBlended;
  maker.scene.materials[kGreen].base_color[3] = 0.5f;
  maker.wall(1.0, 1.0, kGreen);
  Reused reused(maker.scene, {});
  reused.begin(testView());
  EXPECT_TRUE(reused.draw(ids({0, 1}), {.as_given = true}));
  const LayerImage other_order = reused.image;
  EXPECT_TRUE(reused.draw(ids({1, 0}), {.as_given = true}));
  EXPECT_EQ(reused.image.pixels, reused.expected.pixels);
  EXPECT_GT(largestDifference(reused.image, other_order), 0.05);
}

TEST_F(LayerReuseTest, HostileViewsAndSettingsDoNoHarm) {
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  for (const double bad : {kNan, 0.0, -1.0, 1e308, std::numeric_limits<double>::infinity()}) {
    for (const ReuseSettings& settings :
         {ReuseSettings{.tolerance_px = bad}, ReuseSettings{.max_stretch = bad},
          ReuseSettings{.max_turn = bad}}) {
      Reused reused(maker.scene, settings);
      for (int frame = 0; frame < 3; ++frame) {
        reused.drawFrame(testView({0.01 * frame, 0, 10}), {}, ids({0}));
        EXPECT_LE(farthestCovered(reused.image, reused.expected), 2.0);
        EXPECT_LE(farthestCovered(reused.expected, reused.image), 2.0);
      }
    }
    Reused reused(maker.scene, {});
    for (double View::*member : {&View::tan_half_fovy, &View::aspect, &View::z_near, &View::z_far}) {
      View view = testView();
      view.*member = bad;
      reused.begin(view);
      reused.reuse.image(ids({0}), {}, reused.image);
      EXPECT_EQ(reused.image.pixels.size(), std::size_t{kReuseWidth} * kReuseHeight);
      reused.begin(testView({0.01, 0, 10}));
      reused.reuse.image(ids({0}), {}, reused.image);
      EXPECT_GT(covered(reused.image), 100.0);
    }
    View view = testView();
    view.eye.x = bad;
    reused.begin(view);
    reused.reuse.image(ids({0}), {}, reused.image);
  }
  Result<LayerRenderer> small = LayerRenderer::create(maker.scene.view(), {.width = 9, .height = 8});
  ASSERT_TRUE(small);
  LayerReuse reuse(maker.scene.view(), *small, {.max_frames = 0, .guard_px = 4000000000u});
  EXPECT_EQ(reuse.width(), 3u);
  EXPECT_EQ(reuse.height(), 2u);
  LayerImage image;
  for (std::uint64_t frame = 1; frame < 4; ++frame) {
    reuse.beginFrame(testView(), {});
    reuse.image(ids({0}), {}, image);
    EXPECT_EQ(image.pixels.size(), 6u);
    EXPECT_EQ(reuse.stats().drawn, frame);
  }
}

}  // namespace
}  // namespace sightline
