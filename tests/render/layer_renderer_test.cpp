#include "sightline/render/layer_renderer.h"

#include <limits>
#include <string>

#include "sightline/render/compare.h"
#include "sightline/render/renderer.h"
#include "tests/render/layer_test.h"

namespace sightline {
namespace {

class LayerRendererTest : public LayerTest {};

TEST_F(LayerRendererTest, OpaqueObjectsOverTheSkyAreWhatRendererDraws) {
  for (const std::uint32_t seed : {1u, 2u}) {
    for (const bool orthographic : {false, true}) {
      const Scene scene = opaqueScene(seed).scene;
      const View view = turnedView(orthographic);
      LayerRenderer layers = layersOf(scene);
      Renderer renderer = rendererOf(scene, kWidth, kHeight);
      LayerImage picture = drawn(layers, view, allOf(scene));
      LayerImage sky;
      layers.drawSky(view, sky);
      compositeOver(picture, sky);
      EXPECT_LE(compareImages(toImage(picture), renderer.draw(view, allOf(scene))).largest, 1)
          << "seed " << seed << ", orthographic " << orthographic;
      EXPECT_LE(compareImages(toImage(sky), renderer.draw(view, {})).largest, 1);
    }
  }
}

TEST_F(LayerRendererTest, SmallDistancesHoldFarFromTheOriginAsInRenderer) {
  const Scene scene = closeWalls({1024.0f, 0.0f, 2048.0f});
  LayerRenderer layers = layersOf(scene);
  Renderer renderer = rendererOf(scene, kWidth, kHeight);
  const View view = testView({1024.0, 0.0, 2058.0});
  LayerImage picture = drawn(layers, view, allOf(scene)), sky;
  layers.drawSky(view, sky);
  compositeOver(picture, sky);
  EXPECT_LE(compareImages(toImage(picture), renderer.draw(view, allOf(scene))).largest, 1);
}

TEST_F(LayerRendererTest, PixelsAreOpaqueWhereAnObjectIsAndTransparentElsewhere) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  LayerRenderer layers = layersOf(maker.scene);
  const LayerImage image = drawn(layers, testView(), allOf(maker.scene));
  // Ten metres away the picture is ten metres high: the wall is a fifth of it, 9.6 pixels.
  int opaque = 0;
  for (const ShapedPixel& p : image.pixels) {
    EXPECT_TRUE(p.alpha == 1.0f || p == ShapedPixel{});
    opaque += p.alpha == 1.0f ? 1 : 0;
  }
  EXPECT_EQ(opaque, 100);
}

TEST_F(LayerRendererTest, LayersInTheirOrderAreThePictureOfAllAtOnceBitForBit) {
  SceneMaker maker;
  std::vector<ObjectId> far_to_near;
  for (int i = 0; i < 9; ++i) {
    const auto at = static_cast<float>(i);
    const std::uint32_t material = i % 3 == 0 ? kRed : i % 3 == 1 ? kFoliage : kGreen;
    far_to_near.push_back(i % 2 == 0 ? maker.wall(-4.0 + 0.5 * i, 2.0 - 0.2 * i, material)
                                     : maker.box({-1.5f + 0.2f * at, -1.0f, -4.0f + 0.5f * at},
                                                 {1.0f, 0.1f * at, -3.7f + 0.5f * at}, material));
  }
  LayerRenderer layers = layersOf(maker.scene);
  for (const bool orthographic : {false, true}) {
    View view = testView({0.2, 0.3, 8.0});
    view.orthographic = orthographic;
    const LayerDraw how{.depths = true};
    LayerImage composite = drawn(layers, view, std::span(far_to_near).last(1), how);
    for (std::size_t i = far_to_near.size() - 1; i-- > 0;) {
      compositeOver(composite, drawn(layers, view, std::span(far_to_near).subspan(i, 1), how));
    }
    const LayerImage all = drawn(layers, view, far_to_near, how);
    EXPECT_EQ(composite.pixels, all.pixels);
    EXPECT_EQ(composite.depths, all.depths);
  }
}

TEST_F(LayerRendererTest, IdsComeInAnyOrderAndCountOnce) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  maker.wall(1.0, 0.5, kGlass);
  maker.wall(0.5, 0.7, kGlass);
  LayerRenderer layers = layersOf(maker.scene);
  LayerImage image;
  const std::vector ids{ObjectId(2u), ObjectId(0u), ObjectId(1u), ObjectId(2u), ObjectId(), ObjectId(77u)};
  const LayerDrawStats stats = layers.draw(testView(), ids, {}, image);
  EXPECT_EQ(stats.triangles, 6u);
  EXPECT_EQ(stats.passes, 1u);
  EXPECT_EQ(image.pixels, drawn(layers, testView(), allOf(maker.scene)).pixels);
}

TEST_F(LayerRendererTest, WithoutTintsObjectsOfOneMaterialAreOneColour) {
  SceneMaker maker;
  const ObjectId first = maker.wall(0.0, 1.0, kRed), alike = maker.wall(0.0, 1.0, kRed),
                 green = maker.wall(0.0, 1.0, kGreen);
  for (const bool tints : {false, true}) {
    LayerRenderer layers = layersOf(maker.scene, {.width = kWidth, .height = kHeight, .tints = tints});
    const LayerImage one = drawn(layers, testView(), {&first, 1});
    const LayerImage other = drawn(layers, testView(), {&alike, 1});
    EXPECT_EQ(one.pixels != other.pixels, tints);
    EXPECT_GT(largestDifference(one, drawn(layers, testView(), {&green, 1})), 0.1);
  }
}

TEST_F(LayerRendererTest, NothingIsTransparentAndWithoutDepth) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  const Scene empty;
  LayerRenderer some = layersOf(maker.scene), none = layersOf(empty);
  for (LayerRenderer* layers : {&some, &none}) {
    for (const bool peel : {false, true}) {
      LayerImage image;
      const LayerDrawStats stats = layers->draw(testView(), {}, {.peel = peel, .depths = true}, image);
      EXPECT_EQ(stats.triangles, 0u);
      EXPECT_EQ(image.pixels, std::vector<ShapedPixel>(kWidth * kHeight));
      EXPECT_EQ(image.depths, std::vector<float>(kWidth * kHeight, LayerImage::kNoDepth));
      EXPECT_TRUE(drawn(*layers, testView(), {}).depths.empty());
    }
  }
}

TEST_F(LayerRendererTest, PicturesOfOnePixel) {
  SceneMaker maker;
  maker.wall(0.0, 9.0, kRed);
  maker.wall(1.0, 9.0, kGlass);
  View view = testView();
  view.aspect = 1.0;
  for (const std::uint32_t samples : {1u, 2u, 4u}) {
    LayerRenderer layers = layersOf(maker.scene, {1, 1, samples});
    const LayerImage image = drawn(layers, view, allOf(maker.scene), {.peel = true, .depths = true});
    ASSERT_EQ(image.pixels.size(), 1u);
    EXPECT_EQ(image.pixels[0].alpha, 1.0f);
    EXPECT_NEAR(image.depths.at(0), 9.0, 1e-4);
    LayerImage sky;
    layers.drawSky(view, sky);
    EXPECT_EQ(sky.pixels.at(0).alpha, 1.0f);
  }
}

TEST_F(LayerRendererTest, ImpossibleSizesAreErrorsThatNameThem) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  for (const LayerRendererOptions& bad :
       {LayerRendererOptions{0, 4, 1}, LayerRendererOptions{4, 0, 1}, LayerRendererOptions{8193, 4, 1},
        LayerRendererOptions{4, 0xffffffffu, 4}, LayerRendererOptions{4, 4, 3},
        LayerRendererOptions{4, 4, 0}}) {
    const Result<LayerRenderer> none = LayerRenderer::create(maker.scene.view(), bad);
    ASSERT_FALSE(none.has_value());
    EXPECT_NE(none.error().message.find(std::to_string(bad.samples)), std::string::npos);
  }
}

TEST_F(LayerRendererTest, RenderersMoveAndStandBesideOthers) {
  SceneMaker red, green;
  red.wall(0.0, 1.0, kRed);
  green.wall(0.0, 1.0, kGreen);
  LayerRenderer a = layersOf(red.scene), b = layersOf(green.scene);
  Renderer c = rendererOf(red.scene);
  LayerRenderer d = std::move(a);
  const std::size_t middle = kHeight / 2 * kWidth + kWidth / 2;
  EXPECT_GT(drawn(d, testView(), allOf(red.scene)).pixels[middle].red, 0.1f);
  EXPECT_GT(drawn(b, testView(), allOf(green.scene)).pixels[middle].green, 0.1f);
  EXPECT_TRUE(isRed(middleOf(c.draw(testView(), allOf(red.scene)))));
  b = std::move(d);
  EXPECT_GT(drawn(b, testView(), allOf(red.scene)).pixels[middle].red, 0.1f);
  EXPECT_EQ(b.width(), kWidth);
  EXPECT_EQ(b.height(), kHeight);
  EXPECT_FALSE(b.device().empty());
}

TEST_F(LayerRendererTest, DepthsAreThoseOfRays) {
  const std::vector<LensPoint> lenses{{}, {.right = 0.4, .up = -0.3, .focus = 7.0}};
  for (const std::uint32_t seed : {3u, 4u}) {
    const Scene scene = triangles(seed, 18, {{.double_sided = true}, {}, {.opacity = Opacity::kBlended}});
    LayerRenderer layers = layersOf(scene);
    for (const LensPoint& lens : lenses) {
      for (const bool orthographic : {false, true}) {
        const View view = turnedView(orthographic);
        const LayerImage image = drawn(layers, view, allOf(scene), {.depths = true, .lens = lens});
        int sure = 0, covered = 0;
        double worst = 0.0;
        for (std::uint32_t y = 0; y < kHeight; ++y) {
          for (std::uint32_t x = 0; x < kWidth; ++x) {
            const Fragments fragments = fragmentsOf(scene, view, rayThrough(view, lens, x, y));
            const float depth = image.depths[y * kWidth + x];
            if (!fragments.sure) {
              continue;
            }
            ++sure;
            ASSERT_EQ(fragments.list.empty(), depth == LayerImage::kNoDepth)
                << "seed " << seed << " at " << x << ", " << y;
            if (!fragments.list.empty()) {
              ++covered;
              worst = std::max(worst, std::abs(depth / fragments.list[0].depth - 1.0));
            }
          }
        }
        EXPECT_LT(worst, 1e-4) << "seed " << seed << ", orthographic " << orthographic;
        EXPECT_GT(sure, static_cast<int>(kWidth * kHeight) / 2);
        EXPECT_GT(covered, 150);
      }
    }
  }
}

TEST_F(LayerRendererTest, DepthsEndNowhereIfTheFarPlaneIsFarOrInfinite) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  LayerRenderer layers = layersOf(maker.scene);
  for (const double far : {11.0, 1e30, 1e308, std::numeric_limits<double>::infinity()}) {
    for (const double near : {0.1, 2.0, 9.9}) {
      View view = testView();
      view.z_near = near;
      view.z_far = far;
      const LayerImage image = drawn(layers, view, allOf(maker.scene), {.depths = true});
      EXPECT_NEAR(image.depths[kHeight / 2 * kWidth + kWidth / 2], 10.0, 1e-4) << near << " " << far;
      EXPECT_EQ(image.depths[0], LayerImage::kNoDepth);
    }
  }
}

TEST_F(LayerRendererTest, DepthsOfAnOrthographicViewWithoutEndAreTheNearDistance) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  LayerRenderer layers = layersOf(maker.scene);
  View view = testView();
  view.orthographic = true;
  view.z_far = std::numeric_limits<double>::infinity();
  const LayerImage image = drawn(layers, view, allOf(maker.scene), {.depths = true});
  EXPECT_EQ(image.depths[kHeight / 2 * kWidth + kWidth / 2], static_cast<float>(view.z_near));
  EXPECT_EQ(image.depths[0], LayerImage::kNoDepth);
}

// A view whose axes have other lengths and the same directions.
View stretched(View view, double right, double up, double forward) {
  view.right = view.right * right;
  view.up = view.up * up;
  view.forward = view.forward * forward;
  return view;
}

TEST_F(LayerRendererTest, LengthsOfAxesDoNotMatter) {
  SceneMaker maker;
  maker.box({-1.0f, -0.9f, -1.0f}, {1.1f, 1.0f, 8.5f}, kRed);  // close to the eye: it covers most
  maker.wall(0.5, 3.0, kGlass);
  LayerRenderer layers = layersOf(maker.scene);
  Renderer renderer = rendererOf(maker.scene, kWidth, kHeight);
  const std::vector<ObjectId> all = allOf(maker.scene);
  const ObjectId glass(1u);
  for (const bool orthographic : {false, true}) {
    View view = testView();
    view.orthographic = orthographic;
    view.shift_x = 0.25;
    for (const LensPoint& lens : {LensPoint{}, LensPoint{.right = 0.4, .up = -0.3, .focus = 7.0}}) {
      const LayerDraw how{.peel = true, .depths = true, .lens = lens}, hidden{.hidden = true, .lens = lens};
      const LayerImage expected = drawn(layers, view, all, how);
      layers.hideBehind(view, all, lens);
      const LayerImage expected_hidden = drawn(layers, view, {&glass, 1}, hidden);
      LayerImage expected_sky, sky;
      layers.drawSky(view, expected_sky);
      for (const double scale : {1e-100, 0.01, 3.0, 1e100}) {
        for (const View& other :
             {stretched(view, scale, 1, 1), stretched(view, 1, scale, 1), stretched(view, 1, 1, scale)}) {
          const LayerImage image = drawn(layers, other, all, how);
          EXPECT_EQ(image.pixels, expected.pixels) << scale;
          EXPECT_EQ(image.depths, expected.depths) << scale;
          layers.hideBehind(other, all, lens);
          EXPECT_EQ(drawn(layers, other, {&glass, 1}, hidden).pixels, expected_hidden.pixels) << scale;
          layers.drawSky(other, sky);
          EXPECT_EQ(sky.pixels, expected_sky.pixels) << scale;
          EXPECT_EQ(renderer.draw(other, all), renderer.draw(view, all)) << scale;
        }
      }
    }
  }
}

TEST_F(LayerRendererTest, ALeftHandedViewIsTheMirroredPictureOfTheSameSides) {
  SceneMaker maker;
  maker.box({-1.53f, -0.93f, -1.0f}, {1.17f, 1.03f, 1.0f}, kRed);
  maker.box({0.31f, -1.3f, 2.0f}, {2.04f, 1.4f, 3.0f}, kGlass);
  maker.wall(3.5, 2.0, kGreen, true);  // its back: not seen
  LayerRenderer layers = layersOf(maker.scene);
  Renderer renderer = rendererOf(maker.scene, kWidth, kHeight);
  const std::vector<ObjectId> all = allOf(maker.scene);
  Mat4 turn;  // a reflection, which turns the winding once more
  turn(1, 1) = -1.0;
  for (const std::vector<Mat4>& places : {std::vector<Mat4>(), std::vector(3, turn)}) {
    layers.setTransforms(places);
    for (const bool orthographic : {false, true}) {
      for (const bool peel : {false, true}) {
        View view = testView({0.2, 0.3, 10.0});
        view.orthographic = orthographic;
        const LayerImage plain = drawn(layers, view, all, {.peel = peel, .depths = true});
        const Image picture = renderer.draw(view, all);
        view.right = -view.right;
        const LayerImage mirrored = drawn(layers, view, all, {.peel = peel, .depths = true});
        const Image mirrored_picture = renderer.draw(view, all);
        int differing = 0, covered = 0;
        for (std::uint32_t y = 0; y < kHeight; ++y) {
          for (std::uint32_t x = 0; x < kWidth; ++x) {
            const std::size_t here = y * kWidth + x, there = y * kWidth + kWidth - 1 - x;
            const float a = plain.depths[here], b = mirrored.depths[there];
            const Pixel p = pixelOf(picture, x, y), q = pixelOf(mirrored_picture, kWidth - 1 - x, y);
            const bool same = (a == b || std::abs(a - b) < 1e-3f) &&
                              std::abs(plain.pixels[here].red - mirrored.pixels[there].red) < 0.01f &&
                              std::abs(plain.pixels[here].blue - mirrored.pixels[there].blue) < 0.01f &&
                              std::abs(p.r - q.r) + std::abs(p.g - q.g) + std::abs(p.b - q.b) < 6;
            differing += same ? 0 : 1;
            covered += a < LayerImage::kNoDepth ? 1 : 0;
          }
        }
        EXPECT_LT(differing, 20) << orthographic << peel;
        EXPECT_GT(covered, 150);
      }
    }
  }
}

TEST_F(LayerRendererTest, APixelIsTheMeanOfItsSamplesAndItsDepthTheNearest) {
  SceneMaker maker = opaqueScene(5);
  for (Object& object : maker.scene.objects) {
    object.material = MaterialId(object.material.value == kFoliage ? kGlass : object.material.value);
  }
  const View view = turnedView(false);
  for (const std::uint32_t samples : {2u, 4u}) {
    LayerRenderer pixels = layersOf(maker.scene, {kWidth, kHeight, samples});
    LayerRenderer single = layersOf(maker.scene, {kWidth * samples, kHeight * samples, 1});
    const LayerDraw how{.peel = true, .depths = true};
    const LayerImage image = drawn(pixels, view, allOf(maker.scene), how);
    const LayerImage fine = drawn(single, view, allOf(maker.scene), how);
    LayerImage mean;
    mean.clear(kWidth, kHeight);
    mean.depths.assign(mean.pixels.size(), LayerImage::kNoDepth);
    const float share = 1.0f / static_cast<float>(samples * samples);
    for (std::size_t i = 0; i < fine.pixels.size(); ++i) {
      const std::size_t x = i % fine.width / samples, y = i / fine.width / samples;
      ShapedPixel& p = mean.pixels[y * kWidth + x];
      p = {p.red + share * fine.pixels[i].red, p.green + share * fine.pixels[i].green,
           p.blue + share * fine.pixels[i].blue, p.alpha + share * fine.pixels[i].alpha};
      mean.depths[y * kWidth + x] = std::min(mean.depths[y * kWidth + x], fine.depths[i]);
    }
    EXPECT_LT(largestDifference(image, mean), 1e-6);
    EXPECT_EQ(image.depths, mean.depths);
  }
}

TEST_F(LayerRendererTest, HolesOfAlphaTestedObjectsAreWholePixels) {
  SceneMaker maker;
  maker.wall(0.0, 9.0, kFoliage);
  LayerRenderer single = layersOf(maker.scene);
  const LayerImage expected = drawn(single, testView(), allOf(maker.scene));
  for (const std::uint32_t samples : {2u, 4u}) {
    LayerRenderer layers = layersOf(maker.scene, {kWidth, kHeight, samples});
    const LayerImage image = drawn(layers, testView(), allOf(maker.scene));
    EXPECT_LT(largestDifference(image, expected), 1e-3);
    EXPECT_EQ(image.pixels[0].alpha + image.pixels[1].alpha, 1.0f);
  }
}

// The share of pixels in which `b` differs from `a` moved right and down by whole pixels, where both show the
// place.
double shareDiffering(const LayerImage& a, const LayerImage& b, int right, int down) {
  int compared = 0, differing = 0;
  for (int y = 0; y < static_cast<int>(kHeight); ++y) {
    for (int x = 0; x < static_cast<int>(kWidth); ++x) {
      const int from_x = x - right, from_y = y - down;
      if (from_x < 0 || from_y < 0 || from_x >= static_cast<int>(kWidth) ||
          from_y >= static_cast<int>(kHeight)) {
        continue;
      }
      LayerImage p, q;
      p.pixels = {a.pixels[static_cast<std::size_t>(from_y) * kWidth + static_cast<std::size_t>(from_x)]};
      q.pixels = {b.pixels[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)]};
      ++compared;
      differing += largestDifference(p, q) > 1e-4 ? 1 : 0;
    }
  }
  return static_cast<double>(differing) / compared;
}

TEST_F(LayerRendererTest, ALensPointSeesWhatACameraThereSeesShifted) {
  SceneMaker maker = opaqueScene(8);
  maker.box({-0.5f, -0.5f, 2.0f}, {1.0f, 1.0f, 2.5f}, kGlass);
  for (Object& object : maker.scene.objects) {  // holes stay where the pixels are
    object.material = MaterialId(object.material.value == kFoliage ? kGlass : object.material.value);
  }
  LayerRenderer layers = layersOf(maker.scene);
  const View view = turnedView(false);
  for (const bool peel : {false, true}) {
    const LensPoint lens{.right = 0.5, .up = -0.25, .focus = 6.0};
    View moved = view;
    moved.eye = view.eye + view.right * lens.right + view.up * lens.up;
    // A metre at the focus distance is kHeight / (2 * 0.5 * 6) = 8 pixels.
    const LayerImage there = drawn(layers, moved, allOf(maker.scene), {.peel = peel});
    const LayerImage here = drawn(layers, view, allOf(maker.scene), {.peel = peel, .lens = lens});
    EXPECT_LT(shareDiffering(there, here, 4, 2), 0.005);
    EXPECT_GT(shareDiffering(there, here, 0, 0), 0.05);
  }
}

TEST_F(LayerRendererTest, WhatIsInFocusStaysWhereItIs) {
  SceneMaker maker;
  maker.wall(0.0, 1.37, kRed);
  LayerRenderer layers = layersOf(maker.scene);
  for (const bool orthographic : {false, true}) {
    View view = testView({0.3, -0.2, 10.0});
    view.orthographic = orthographic;
    const LayerImage sharp = drawn(layers, view, allOf(maker.scene));
    const LensPoint near{.right = 1.3, .up = -0.9, .focus = 8.0}, at{.right = 1.3, .up = -0.9, .focus = 10.0};
    // The haze of two metres more is left.
    EXPECT_LT(largestDifference(sharp, drawn(layers, view, allOf(maker.scene), {.lens = at})), 0.02);
    EXPECT_GT(largestDifference(sharp, drawn(layers, view, allOf(maker.scene), {.lens = near})), 0.9);
  }
}

}  // namespace
}  // namespace sightline
