#include <cmath>

#include "tests/render/layer_test.h"

namespace sightline {
namespace {

class DepthPeelingTest : public LayerTest {};

const std::vector<Material> kSeeThrough{
    {.opacity = Opacity::kBlended, .double_sided = true, .base_color = {0.9f, 0.1f, 0.1f, 0.4f}},
    {.opacity = Opacity::kBlended, .double_sided = true, .base_color = {0.1f, 0.8f, 0.2f, 0.7f}},
    {.opacity = Opacity::kBlended, .base_color = {0.1f, 0.2f, 0.9f, 0.5f}},
    {.opacity = Opacity::kBlended, .double_sided = true, .base_color = {0.8f, 0.8f, 0.1f, 0.2f}},
};

// The pictures of the objects alone, composited in the order in which a ray intersects the objects.
ShapedPixel sorted(const std::vector<LayerImage>& alone, const Fragments& fragments, std::size_t pixel) {
  double color[4] = {0, 0, 0, 0};
  for (const Fragment& fragment : fragments.list) {
    const ShapedPixel& p = alone[fragment.object.value].pixels[pixel];
    const double through = 1.0 - color[3];
    const float channels[4] = {p.red, p.green, p.blue, p.alpha};
    for (int c = 0; c < 4; ++c) {
      color[c] += through * static_cast<double>(channels[c]);
    }
  }
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2]),
          static_cast<float>(color[3])};
}

struct PeelCheck {
  int sure = 0;             // pixels compared
  std::size_t deepest = 0;  // largest number of fragments in one of them
  double largest = 0.0;     // largest difference of a channel
};

PeelCheck checkPeeling(const Scene& scene, LayerRenderer& layers, const View& view, const LensPoint& lens) {
  std::vector<LayerImage> alone;
  for (const ObjectId id : allOf(scene)) {
    alone.push_back(drawn(layers, view, std::vector{id}, {.lens = lens}));
  }
  const LayerImage image = drawn(layers, view, allOf(scene), {.peel = true, .lens = lens});
  PeelCheck check;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const Fragments fragments = fragmentsOf(scene, view, rayThrough(view, lens, x, y));
      if (!fragments.sure) {
        continue;
      }
      const std::size_t pixel = y * kWidth + x;
      LayerImage expected, found;
      expected.pixels = {sorted(alone, fragments, pixel)};
      found.pixels = {image.pixels[pixel]};
      check.largest = std::max(check.largest, largestDifference(expected, found));
      check.deepest = std::max(check.deepest, fragments.list.size());
      ++check.sure;
    }
  }
  return check;
}

TEST_F(DepthPeelingTest, PeeledPicturesAreOfTheFragmentsSortedByRays) {
  for (const std::uint32_t seed : {6u, 7u}) {
    std::vector<Material> materials = kSeeThrough;
    if (seed == 7) {
      materials.insert(materials.begin(), 2, Material{.double_sided = true});
    }
    const Scene scene = triangles(seed, 40, materials);
    LayerRenderer layers = layersOf(scene);
    for (const bool orthographic : {false, true}) {
      for (const LensPoint& lens : {LensPoint{}, LensPoint{.right = -0.5, .up = 0.2, .focus = 9.0}}) {
        const PeelCheck check = checkPeeling(scene, layers, turnedView(orthographic), lens);
        EXPECT_LT(check.largest, 2e-6) << "seed " << seed << ", orthographic " << orthographic;
        EXPECT_GT(check.sure, 1000);
        EXPECT_GT(check.deepest, 5u);
      }
    }
  }
}

TEST_F(DepthPeelingTest, WithoutPeelingTheOrderOfIdsIsBlended) {
  SceneMaker maker;
  maker.scene.materials = kSeeThrough;
  maker.wall(1.0, 9.0, 0);
  maker.wall(0.0, 9.0, 1);
  maker.wall(2.0, 9.0, 3);
  LayerRenderer layers = layersOf(maker.scene);
  LayerImage expected = drawn(layers, testView(), std::vector{ObjectId(2u)});
  compositeOver(expected, drawn(layers, testView(), std::vector{ObjectId(1u)}));
  compositeOver(expected, drawn(layers, testView(), std::vector{ObjectId(0u)}));
  const LayerImage in_order = drawn(layers, testView(), allOf(maker.scene));
  EXPECT_LT(largestDifference(in_order, expected), 1e-6);
  const LayerImage peeled = drawn(layers, testView(), allOf(maker.scene), {.peel = true});
  EXPECT_GT(largestDifference(in_order, peeled), 0.05);

  // The order is from the farthest to the nearest; a repeated object counts at its first place.
  const std::vector by_depth{ObjectId(1u), ObjectId(0u), ObjectId(1u), ObjectId(2u), ObjectId(0u)};
  EXPECT_LT(largestDifference(drawn(layers, testView(), by_depth, {.as_given = true}), peeled), 1e-6);
  EXPECT_EQ(drawn(layers, testView(), by_depth).pixels, in_order.pixels);
}

TEST_F(DepthPeelingTest, SurfacesAtEqualDepthsAreAllPeeledInTheOrderOfIds) {
  SceneMaker maker;
  maker.scene.materials = kSeeThrough;
  std::vector<ObjectId> far_to_near;
  for (const double z : {2.0, 0.0, 1.0}) {
    for (int i = 0; i < 4; ++i) {
      maker.wall(z, 9.0, static_cast<std::uint32_t>(i));
    }
  }
  for (const std::uint32_t i : {4u, 5u, 6u, 7u, 8u, 9u, 10u, 11u, 0u, 1u, 2u, 3u}) {
    far_to_near.push_back(ObjectId(i));
  }
  LayerRenderer layers = layersOf(maker.scene);
  LayerImage expected;
  expected.clear(kWidth, kHeight);
  for (const ObjectId id : far_to_near) {
    LayerImage next = drawn(layers, testView(), std::vector{id});
    compositeOver(next, expected);
    expected = next;
  }
  LayerImage image;
  const LayerDrawStats stats = layers.draw(testView(), allOf(maker.scene), {.peel = true}, image);
  EXPECT_EQ(stats.passes, 3u);
  EXPECT_EQ(stats.triangles, 24u * 7u);
  EXPECT_LT(largestDifference(image, expected), 1e-6);
  EXPECT_EQ(image.pixels, drawn(layers, testView(), allOf(maker.scene), {.peel = true}).pixels);
}

TEST_F(DepthPeelingTest, AnyNumberOfSurfacesIsPeeled) {
  SceneMaker maker;
  maker.scene.materials = {{.opacity = Opacity::kBlended, .base_color = {0.2f, 0.5f, 0.9f, 0.02f}}};
  constexpr int kWalls = 150;
  for (int i = 0; i < kWalls; ++i) {
    maker.wall(0.01 * ((i * 67) % kWalls), 9.0, 0);
  }
  LayerRenderer layers = layersOf(maker.scene, {8, 6, 1});
  LayerImage image;
  const LayerDrawStats stats = layers.draw(testView(), allOf(maker.scene), {.peel = true}, image);
  EXPECT_EQ(stats.passes, static_cast<std::uint32_t>(kWalls));
  // Opacities are held in eight bits: 0.02 is 5 / 255.
  for (const ShapedPixel& p : image.pixels) {
    EXPECT_NEAR(p.alpha, 1.0 - std::pow(250.0 / 255.0, kWalls), 1e-5);
  }
}

TEST_F(DepthPeelingTest, OpaqueSurfacesHidePeelsBehindThem) {
  SceneMaker maker;
  maker.wall(1.0, 9.0, kRed);
  for (const double z : {0.0, 0.5, 2.0, 1.0}) {  // the last one at the opaque wall's depth is hidden by it
    maker.wall(z, 9.0, kGlass);
  }
  LayerRenderer layers = layersOf(maker.scene);
  LayerImage image;
  const LayerDrawStats stats =
      layers.draw(testView(), allOf(maker.scene), {.peel = true, .depths = true}, image);
  EXPECT_EQ(stats.passes, 1u);
  LayerImage expected = drawn(layers, testView(), std::vector{ObjectId(3u)});
  compositeOver(expected, drawn(layers, testView(), std::vector{ObjectId(0u)}));
  EXPECT_LT(largestDifference(image, expected), 1e-6);
  EXPECT_NEAR(image.depths[0], 8.0, 1e-5);
}

TEST_F(DepthPeelingTest, WhatLiesOnTheNearPlaneIsPeeledOnce) {
  SceneMaker maker;
  maker.wall(8.0, 9.0, kGlass);
  maker.wall(7.0, 2.0, kGlass);
  maker.wall(6.5, 2.0, kGlass);
  View view = testView();
  view.orthographic = true;  // depths are exact, the nearest one 1
  view.z_near = 2.0;
  view.z_far = 4.0;
  LayerRenderer layers = layersOf(maker.scene);
  LayerImage image;
  const LayerDrawStats stats = layers.draw(view, allOf(maker.scene), {.peel = true, .depths = true}, image);
  EXPECT_EQ(stats.passes, 3u);
  // In a corner that is the only surface, and no later peel finds it again.
  EXPECT_NEAR(image.pixels[0].alpha, 128.0 / 255.0, 1e-6);
  const std::size_t middle = kHeight / 2 * kWidth + kWidth / 2;
  EXPECT_NEAR(image.pixels[middle].alpha, 1.0 - std::pow(127.0 / 255.0, 3), 1e-6);
  EXPECT_EQ(image.depths[0], 2.0f);
  EXPECT_EQ(image.depths[middle], 2.0f);
}

}  // namespace
}  // namespace sightline
