// Compares depth of field and motion blur of small scenes with the accumulation of whole pictures.

#include "sightline/render/lens_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/render/largest_difference.h"
#include "tests/render/test_scene.h"
#include "tests/support/translation.h"

namespace sightline {
namespace {

using test::translation;

constexpr std::uint32_t kLensWidth = 128, kLensHeight = 96;
constexpr std::array kMethods{LensMethod::kLayers, LensMethod::kSingleNormalised,
                              LensMethod::kSingleUnnormalised, LensMethod::kAccumulation};

// Makes each list a layer in a group of its own, front to back.
FrameLayers layersOf(std::initializer_list<std::vector<ObjectId>> lists) {
  FrameLayers layers;
  layers.first_part.push_back(0);
  layers.first_layer.push_back(0);
  for (const std::vector<ObjectId>& list : lists) {
    for (const ObjectId object : list) {
      layers.parts.push_back(PartId(object.value));
    }
    layers.first_part.push_back(static_cast<std::uint32_t>(layers.parts.size()));
    layers.first_layer.push_back(static_cast<std::uint32_t>(layers.first_layer.size()));
  }
  return layers;
}

// The difference of colours over the pixels for which `counts` is true.
template <typename Counts>
double rmsOf(const LayerImage& a, const LayerImage& b, Counts&& counts) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if (counts(i)) {
      const ShapedPixel &p = a.pixels[i], &q = b.pixels[i];
      for (const float d : {p.red - q.red, p.green - q.green, p.blue - q.blue}) {
        sum += static_cast<double>(d) * static_cast<double>(d);
      }
      count += 3.0;
    }
  }
  EXPECT_GT(count, 0.0);
  return std::sqrt(sum / count);
}
double rmsOf(const LayerImage& a, const LayerImage& b) {
  return rmsOf(a, b, [](std::size_t) { return true; });
}

// The middle of a picture's opacity and the mean square distance from it, in pixels.
struct Spot {
  double weight = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
};
Spot spotOf(const LayerImage& image) {
  Spot s;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double w = static_cast<double>(image.pixels[i].alpha);
    const double x = static_cast<double>(i % image.width) + 0.5,
                 y = static_cast<double>(i / image.width) + 0.5;
    s.weight += w;
    s.x += w * x;
    s.y += w * y;
    s.xx += w * x * x;
    s.yy += w * y * y;
  }
  s.x /= s.weight;
  s.y /= s.weight;
  s.xx = s.xx / s.weight - s.x * s.x;
  s.yy = s.yy / s.weight - s.y * s.y;
  return s;
}

class LensPictureTest : public RenderTest {
 protected:
  // Called when the scene is complete.
  void prepare() {
    Result<LayerRenderer> made =
        LayerRenderer::create(maker_.scene.view(), {.width = kLensWidth, .height = kLensHeight});
    ASSERT_TRUE(made.has_value()) << made.error().message;
    renderer_ = std::make_unique<LayerRenderer>(std::move(*made));
    lens_picture_ = std::make_unique<LensPicture>(maker_.scene.view(), *renderer_);
  }

  LensStats draw(const FrameLayers& layers, const LensSettings& settings, LayerImage& picture) {
    const Result<LensStats> stats = lens_picture_->draw(view_, layers, settings, picture);
    EXPECT_TRUE(stats.has_value());
    return stats ? *stats : LensStats{};
  }
  LayerImage by(LensMethod method) {
    LayerImage picture;
    settings_.method = method;
    draw(layers_, settings_, picture);
    return picture;
  }
  std::string errorOf(const FrameLayers& layers, const LensSettings& settings) {
    LayerImage picture;
    const Result<LensStats> stats = lens_picture_->draw(view_, layers, settings, picture);
    return stats ? "" : stats.error().message;
  }
  LayerImage sharp(std::span<const ObjectId> objects, bool sky = true) {
    LayerImage image, behind;
    renderer_->draw(view_, objects, {}, image);
    if (sky) {
      renderer_->drawSky(view_, behind);
      compositeOver(image, behind);
    }
    return image;
  }

  SceneMaker maker_;
  View view_ = testView();  // at z = 10; a wall of half height 5 at z = 0 fills it
  FrameLayers layers_;
  LensSettings settings_;
  std::unique_ptr<LayerRenderer> renderer_;
  std::unique_ptr<LensPicture> lens_picture_;
};

// Figure 16: a blurred thing before a sharp background of tiles.
class BlurredForeground : public LensPictureTest {
 protected:
  void SetUp() override {
    LensPictureTest::SetUp();
    if (IsSkipped()) {
      return;
    }
    front_ = maker_.box({-2.2f, -0.9f, 4.9f}, {-0.3f, 0.9f, 5.1f}, kRed);
    for (int i = 0; i < 14; ++i) {
      for (int j = 0; j < 10; ++j) {
        const auto x = static_cast<float>(i - 7), y = static_cast<float>(j - 5);
        tiles_.push_back(maker_.box({x, y, -1.0f}, {x + 1.0f, y + 1.0f, 0.0f},
                                    (i + j) % 2 == 0 ? kGreen : kBlueBothSides));
      }
    }
    prepare();
    layers_ = layersOf({{front_}, tiles_});
    settings_.lens = {.focus = 10.0, .aperture = 0.8};  // the thing's circle: 7.7 pixels
    settings_.method = LensMethod::kAccumulation;
    settings_.passes = 150;
    draw(layers_, settings_, reference_);
  }

  // Whether the thing covers only a part of the lens: the pixel is within half its circle of confusion from
  // its edge.
  bool atEdge(std::size_t pixel) {
    if (edge_.pixels.empty()) {
      LayerImage alone;
      renderer_->draw(view_, std::span(&front_, 1), {}, alone);
      blurEvenly(alone, circleOfConfusion(view_, settings_.lens, 5.0, kLensHeight), edge_);
    }
    return edge_.pixels[pixel].alpha > 0.02f && edge_.pixels[pixel].alpha < 0.98f;
  }
  double edgeError(const LayerImage& picture) {
    return rmsOf(picture, reference_, [this](std::size_t i) { return atEdge(i); });
  }

  ObjectId front_;
  std::vector<ObjectId> tiles_;
  LayerImage reference_, edge_;
};

TEST_F(BlurredForeground, IsNearestToTheReferenceByLayers) {
  const double layers = edgeError(by(LensMethod::kLayers));
  const double potmesil = edgeError(by(LensMethod::kSingleNormalised));
  const double rokita = edgeError(by(LensMethod::kSingleUnnormalised));
  EXPECT_LT(layers, 0.25 * potmesil);
  EXPECT_LT(layers, 0.25 * rokita);
  EXPECT_LT(layers, 0.02);  // of full light
}

TEST_F(BlurredForeground, LeavesTheBackgroundInFocusSharp) {
  std::vector<ObjectId> all = tiles_;
  all.push_back(front_);
  const LayerImage pinhole = sharp(all);
  const auto far_from_edge = [this](std::size_t i) {
    return i % kLensWidth > kLensWidth * 2 / 3 && !atEdge(i);
  };
  for (const LensMethod method : kMethods) {
    EXPECT_LT(rmsOf(by(method), pinhole, far_from_edge), 0.02) << static_cast<int>(method);
  }
}

TEST_F(BlurredForeground, IsOpaqueWithASkyInEveryWay) {
  for (const LensMethod method : kMethods) {
    for (const ShapedPixel& pixel : by(method).pixels) {
      ASSERT_NEAR(pixel.alpha, 1.0, 1e-4) << static_cast<int>(method);
    }
  }
}

// How far an accumulation spreads a small thing is what circleOfConfusion says: the renderer's lens and the
// blurs' are one.
TEST_F(LensPictureTest, AccumulationSpreadsByTheCircleOfConfusion) {
  const ObjectId before = maker_.box({-0.2f, -0.2f, 3.9f}, {0.2f, 0.2f, 4.0f}, kRed);
  const ObjectId behind = maker_.box({-0.4f, -0.4f, -9.1f}, {0.4f, 0.4f, -9.0f}, kRed);
  prepare();
  for (const bool orthographic : {false, true}) {
    view_.orthographic = orthographic;
    view_.ortho_height = 8.0;
    for (const auto& [object, depth, size] : {std::tuple{before, 6.0, 0.4}, {behind, 19.0, 0.8}}) {
      LayerImage pinhole, picture;
      LensSettings settings{.method = LensMethod::kAccumulation, .lens = {.focus = 10.0, .aperture = 1.5}};
      settings.passes = 200;
      settings.sky = false;
      draw(layersOf({{object}}), settings, picture);
      const double circle = circleOfConfusion(view_, settings.lens, depth, kLensHeight);
      ASSERT_GT(circle, 5.0);
      // Mean squares add: a disc's is d^2 / 16 in each direction, a square's w^2 / 12.
      const double width = kLensHeight * size / (orthographic ? 8.0 : depth);
      const Spot spot = spotOf(picture);
      EXPECT_NEAR(spot.x, 0.5 * kLensWidth, 0.1);
      EXPECT_NEAR(spot.y, 0.5 * kLensHeight, 0.1);
      EXPECT_NEAR(std::sqrt(16.0 * (spot.xx - width * width / 12.0)), circle, 0.05 * circle) << orthographic;
      EXPECT_NEAR(std::sqrt(16.0 * (spot.yy - width * width / 12.0)), circle, 0.05 * circle) << orthographic;

      settings.method = LensMethod::kLayers;
      draw(layersOf({{object}}), settings, picture);
      renderer_->draw(view_, std::span(&object, 1), {}, pinhole);
      EXPECT_NEAR(std::sqrt(16.0 * (spotOf(picture).xx - spotOf(pinhole).xx)), circle, 0.03 * circle);
    }
  }
}

TEST_F(LensPictureTest, APinholeGivesTheSharpPictureInEveryWay) {
  const ObjectId red = maker_.wall(4.0, 1.0, kRed), green = maker_.wall(0.0, 2.5, kGreen);
  prepare();
  const FrameLayers layers = layersOf({{red}, {green}});
  const std::vector<ObjectId> all{red, green};
  const LayerImage expected = sharp(all);
  for (const LensMethod method : kMethods) {
    LayerImage picture;
    draw(layers, {.method = method, .lens = {.focus = 3.0, .aperture = 0.0}}, picture);
    EXPECT_LT(largestDifference(picture, expected), 1e-4) << static_cast<int>(method);
  }
}

TEST_F(LensPictureTest, ChoosesByHowMuchTheCircleVaries) {
  const ObjectId flat = maker_.wall(6.0, 0.5, kRed);
  const ObjectId thick = maker_.box({0.8f, -0.5f, 3.0f}, {1.4f, 0.5f, 4.5f}, kGreen);
  const ObjectId deep = maker_.box({-2.0f, -2.0f, -60.0f}, {2.0f, -1.0f, 5.0f}, kBlueBothSides);
  const ObjectId outside = maker_.wall(30.0, 1.0, kRed);
  prepare();
  const FrameLayers layers = layersOf({{outside}, {flat}, {thick}, {deep}});
  LensSettings settings{.lens = {.focus = 8.0, .aperture = 0.6}};
  settings.even_within_px = 1.0;
  settings.accumulate_beyond_px = 4.0;
  LayerImage picture;
  LensStats stats = draw(layers, settings, picture);
  EXPECT_EQ(stats.layers, 3u);  // one is behind the eye
  EXPECT_EQ(stats.even, 1u);
  EXPECT_EQ(stats.by_depth, 1u);
  EXPECT_EQ(stats.accumulated, 1u);
  EXPECT_EQ(stats.render_passes, 4u + 21u);
  EXPECT_EQ(stats.moved, 0u);

  settings.parts = {{PartId(flat.value), LayerBlur::kAccumulate},
                    {PartId(deep.value), LayerBlur::kEven},
                    {PartId(thick.value), LayerBlur::kEven}};
  settings.passes = 5;
  stats = draw(layers, settings, picture);
  EXPECT_EQ(stats.even, 2u);
  EXPECT_EQ(stats.by_depth, 0u);
  EXPECT_EQ(stats.accumulated, 1u);
  EXPECT_EQ(stats.render_passes, 4u + 5u);
}

TEST_F(LensPictureTest, AnAccumulatedLayerIsTheAccumulationOfItAlone) {
  const ObjectId deep = maker_.box({-2.0f, -2.0f, -60.0f}, {2.0f, -1.0f, 5.0f}, kBlueBothSides);
  prepare();
  LensSettings settings{.lens = {.focus = 8.0, .aperture = 0.6}, .sky = false};
  settings.parts = {{PartId(deep.value), LayerBlur::kAccumulate}};
  LayerImage layered, whole;
  draw(layersOf({{deep}}), settings, layered);
  settings.method = LensMethod::kAccumulation;
  draw(layersOf({{deep}}), settings, whole);
  EXPECT_LT(largestDifference(layered, whole), 1e-5);
}

TEST_F(LensPictureTest, ByDepthIsNearerThanEvenWhereALayerIsDeep) {
  const ObjectId deep = maker_.box({-2.0f, -2.0f, -6.0f}, {2.0f, -1.0f, 5.0f}, kBlueBothSides);
  prepare();
  LensSettings settings{.method = LensMethod::kAccumulation, .lens = {.focus = 16.0, .aperture = 0.8}};
  settings.passes = 100;
  const FrameLayers layers = layersOf({{deep}});
  LayerImage reference, even, by_depth;
  draw(layers, settings, reference);
  settings.method = LensMethod::kLayers;
  settings.parts = {{PartId(deep.value), LayerBlur::kEven}};
  draw(layers, settings, even);
  settings.parts = {{PartId(deep.value), LayerBlur::kByDepth}};
  draw(layers, settings, by_depth);
  EXPECT_LT(rmsOf(by_depth, reference), 0.7 * rmsOf(even, reference));
}

TEST_F(LensPictureTest, TheSkyIsBlurredAsAtInfinity) {
  maker_.wall(30.0, 1.0, kRed);
  prepare();
  const LensSettings settings{.lens = {.focus = 2.0, .aperture = 0.2}};
  const double circle = circleOfConfusion(view_, settings.lens, LayerImage::kNoDepth, kLensHeight);
  ASSERT_GT(circle, 5.0);
  LayerImage sky, expected, picture;
  renderer_->drawSky(view_, sky);
  blurEvenly(sky, circle, expected);
  for (const LensMethod method : kMethods) {
    LensSettings chosen = settings;
    chosen.method = method;
    draw(FrameLayers{}, chosen, picture);
    EXPECT_LT(largestDifference(picture, expected), 1e-4) << static_cast<int>(method);
  }
}

// A thing that crosses the picture before one that stands.
class MovingThing : public LensPictureTest {
 protected:
  void SetUp() override {
    LensPictureTest::SetUp();
    if (IsSkipped()) {
      return;
    }
    mover_ = maker_.wall(2.0, 0.8, kRed);
    backdrop_ = maker_.wall(0.0, 2.0, kGreen);
    prepare();
    layers_ = layersOf({{mover_}, {backdrop_}});
    settings_.lens.aperture = 0.0;
    settings_.passes = 64;
  }
  void moveTo(const Mat4& mover) {
    later_ = {mover, Mat4{}};
    settings_.motion = FrameMotion{.later = view_, .later_stored = later_, .shutter = 0.5};
  }
  double layersError() { return rmsOf(by(LensMethod::kLayers), by(LensMethod::kAccumulation)); }

  ObjectId mover_, backdrop_;
  std::vector<Mat4> later_;
};

TEST_F(MovingThing, IsSpreadAsTheReferenceInTimeSpreadsIt) {
  moveTo(translation({2.0, 0.7, 0.0}));
  const std::vector<ObjectId> all{mover_, backdrop_};
  const LayerImage still = sharp(all);
  const double unblurred = rmsOf(still, by(LensMethod::kAccumulation));
  EXPECT_GT(unblurred, 0.015);
  EXPECT_LT(layersError(), 0.25 * unblurred);

  // Alone: a line of half of two metres at 8 metres, of which 96 pixels are 8.
  settings_.sky = false;
  layers_ = layersOf({{mover_}});
  const Spot spot = spotOf(by(LensMethod::kLayers)), before = spotOf(sharp(std::span(&mover_, 1), false));
  EXPECT_NEAR(spot.x, before.x, 0.01);
  // Points between pixels are shared by two, of a mean square of up to a sixth on the whole.
  EXPECT_NEAR(std::sqrt(12.0 * (spot.xx - before.xx) - 2.0), 12.0, 0.2);
  EXPECT_NEAR(std::sqrt(12.0 * (spot.yy - before.yy) - 2.0), 0.35 * 12.0, 0.2);
}

TEST_F(MovingThing, LeavesWhatStandsAsItWas) {
  moveTo(translation({2.0, 0.0, 0.0}));
  settings_.sky = false;
  layers_ = layersOf({{backdrop_}});
  LayerImage picture;
  settings_.method = LensMethod::kLayers;
  EXPECT_EQ(draw(layers_, settings_, picture).moved, 0u);
  EXPECT_LT(largestDifference(picture, sharp(std::span(&backdrop_, 1), false)), 1e-6);
}

TEST_F(MovingThing, LeavesTheTransformsOfTheFrame) {
  const std::vector<Mat4> now{translation({-1.0, 0.0, 0.0}), Mat4{}};
  renderer_->setTransforms(now);
  const std::vector<ObjectId> all{mover_, backdrop_};
  const LayerImage before = sharp(all);
  moveTo(translation({1.0, 0.0, 0.0}));
  for (const LensMethod method : {LensMethod::kAccumulation, LensMethod::kLayers}) {
    by(method);
    EXPECT_EQ(sharp(all).pixels, before.pixels);
    ASSERT_EQ(renderer_->transforms().size(), now.size());
    EXPECT_EQ(renderer_->transforms()[mover_.value].m, now[mover_.value].m);
  }
  // Where the thing stands later too, nothing moves.
  moveTo(now[mover_.value]);
  settings_.method = LensMethod::kLayers;
  LayerImage picture;
  EXPECT_EQ(draw(layers_, settings_, picture).moved, 0u);
}

TEST_F(MovingThing, IsSpreadByTheCamerasMotionToo) {
  moveTo(Mat4{});
  settings_.motion->later.eye.x += 1.0;
  setOrientation(settings_.motion->later, {0.05, 0.0, -1.0}, {0.0, 1.0, 0.0});
  const std::vector<ObjectId> all{mover_, backdrop_};
  const double unblurred = rmsOf(sharp(all), by(LensMethod::kAccumulation));
  EXPECT_LT(layersError(), 0.3 * unblurred);
  // Nearer things move farther.
  settings_.sky = false;
  std::vector<double> lengths;
  for (const ObjectId object : all) {
    layers_ = layersOf({{object}});
    const Spot before = spotOf(sharp(std::span(&object, 1), false));
    lengths.push_back(std::sqrt(12.0 * (spotOf(by(LensMethod::kLayers)).xx - before.xx)));
  }
  // 1 metre to the right of the picture's middle at depth d is 96 / d pixels to the left, and 0.05 of the
  // depth that the turn moves it, 96 * 0.05 pixels, too.
  EXPECT_NEAR(lengths[0], 0.5 * (96.0 / 8.0 + 4.8), 0.3);
  EXPECT_NEAR(lengths[1], 0.5 * (96.0 / 10.0 + 4.8), 0.3);
}

// What a line cannot show: the thing turns about its middle, which stays. Accumulated, it does.
TEST_F(MovingThing, ThatTurnsIsBlurredOnlyWhereItIsAccumulated) {
  Mat4 turn;
  turn(0, 0) = turn(1, 1) = std::cos(0.6);
  turn(1, 0) = std::sin(0.6);
  turn(0, 1) = -std::sin(0.6);
  moveTo(turn);
  const double by_line = layersError();
  settings_.parts = {{PartId(mover_.value), LayerBlur::kAccumulate}};
  const double accumulated = layersError();
  EXPECT_GT(by_line, 0.005);
  EXPECT_LT(accumulated, 0.2 * by_line);
}

TEST_F(MovingThing, BadSettingsAreRefused) {
  moveTo(translation({1.0, 0.0, 0.0}));
  LensSettings settings = settings_;
  settings.passes = 0;
  EXPECT_NE(errorOf(layers_, settings), "");
  for (const LensMethod method : {LensMethod::kSingleNormalised, LensMethod::kSingleUnnormalised}) {
    settings = settings_;
    settings.method = method;
    EXPECT_NE(errorOf(layers_, settings).find("motion"), std::string::npos);
  }
  for (const double shutter : {-0.1, 1.1, std::nan("")}) {
    settings = settings_;
    settings.motion->shutter = shutter;
    EXPECT_NE(errorOf(layers_, settings).find("shutter"), std::string::npos);
  }
  settings = settings_;
  settings.motion->later_stored = std::span(later_).first(1);
  EXPECT_NE(errorOf(layers_, settings).find("transform"), std::string::npos);
  settings = settings_;
  settings.parts = {{PartId(2u), LayerBlur::kEven}};
  EXPECT_NE(errorOf(layers_, settings).find("part 2"), std::string::npos);
  settings = settings_;
  for (const LensMethod method : {LensMethod::kLayers, LensMethod::kAccumulation}) {
    settings.method = method;
    EXPECT_NE(errorOf(layersOf({{ObjectId(5u)}}), settings).find("part 5"), std::string::npos);
  }
  EXPECT_EQ(errorOf(layers_, settings_), "");
}

TEST_F(MovingThing, ThatIsNowhereHarmsNothing) {
  const double nan = std::nan("");
  for (const Mat4& nowhere : {translation({nan, 0.0, 0.0}), translation({0.0, 0.0, 1e9}), Mat4{.m = {}}}) {
    for (const LensMethod method : {LensMethod::kLayers, LensMethod::kAccumulation}) {
      moveTo(nowhere);
      for (const ShapedPixel& pixel : by(method).pixels) {
        ASSERT_TRUE(std::isfinite(pixel.red) && pixel.alpha <= 1.001f);
      }
      renderer_->setTransforms(later_);
      moveTo(Mat4{});
      by(method);
      renderer_->setTransforms({});
    }
  }
}

TEST_F(LensPictureTest, LayersOfWhichADepthBufferHidesPartsAreRefused) {
  const ObjectId glass = maker_.wall(4.0, 1.0, kGlass), wall = maker_.wall(5.0, 0.5, kRed);
  prepare();
  FrameLayers layers = layersOf({{glass}, {wall}});
  layers.first_hidden = LayerId(0u);
  layers.depth_buffered = LayerId(1u);
  for (const LensMethod method : kMethods) {
    LensSettings settings{.method = method};
    EXPECT_EQ(errorOf(layers, settings).find("depth buffer") != std::string::npos,
              method == LensMethod::kLayers);
  }
}

// The axes of the moving camera have other lengths, or it is left-handed.
TEST_F(MovingThing, IsTheSameForOtherAxesOfTheSameView) {
  moveTo(translation({1.0, 0.2, 0.0}));
  settings_.passes = 7;
  View later = view_;
  later.eye = view_.eye + Vec3d(0.6, 0.3, -0.2);
  const View view = view_;
  for (const LayerBlur blur : {LayerBlur::kAutomatic, LayerBlur::kAccumulate}) {
    settings_.parts = {{PartId(mover_.value), blur}, {PartId(backdrop_.value), blur}};
    for (const LensMethod method : {LensMethod::kLayers, LensMethod::kAccumulation}) {
      for (const double aperture : {0.0, 0.4}) {
        settings_.lens = {.focus = 9.0, .aperture = aperture};
        view_ = view;
        settings_.motion->later = later;
        const LayerImage expected = by(method);
        view_.right = view.right * 2.0;
        view_.forward = view.forward * 0.125;
        settings_.motion->later.up = later.up * 8.0;
        settings_.motion->later.forward = later.forward * 4.0;
        EXPECT_EQ(by(method).pixels, expected.pixels);
        if (aperture > 0.0) {
          continue;  // the points of the lens are not those of the mirrored lens
        }
        view_.right = -view.right;
        settings_.motion->later.right = -later.right;
        LayerImage mirrored = by(method);
        for (auto row = mirrored.pixels.begin(); row != mirrored.pixels.end(); row += kLensWidth) {
          std::reverse(row, row + kLensWidth);
        }
        EXPECT_LT(rmsOf(mirrored, expected), 0.004);
      }
    }
  }
}

TEST_F(LensPictureTest, SeesThroughLayersInTheRightOrder) {
  const ObjectId glass = maker_.wall(4.0, 1.0, kGlass), near_glass = maker_.wall(5.0, 0.8, kGlass);
  const ObjectId wall = maker_.wall(0.0, 2.5, kRed);
  prepare();
  const FrameLayers layers = layersOf({{near_glass}, {glass}, {wall}});
  LensSettings settings{.method = LensMethod::kAccumulation, .lens = {.focus = 10.0, .aperture = 0.5}};
  settings.passes = 80;
  LayerImage reference, picture;
  draw(layers, settings, reference);
  settings.method = LensMethod::kLayers;
  draw(layers, settings, picture);
  EXPECT_LT(rmsOf(picture, reference), 0.01);
}

TEST_F(LensPictureTest, TellsOfItsProgress) {
  const ObjectId near_wall = maker_.wall(4.0, 1.0, kGlass), wall = maker_.wall(0.0, 2.5, kRed);
  prepare();
  layers_ = layersOf({{near_wall}, {wall}});
  settings_.lens = {.focus = 10.0, .aperture = 0.5};
  settings_.passes = 4;
  std::vector<double> told;
  settings_.progress = [&](double done) { told.push_back(done); };
  by(LensMethod::kAccumulation);
  EXPECT_EQ(told, (std::vector<double>{0.25, 0.5, 0.75, 1.0}));
  told.clear();
  by(LensMethod::kLayers);
  EXPECT_EQ(told, (std::vector<double>{0.5, 1.0}));
}

}  // namespace
}  // namespace sightline
