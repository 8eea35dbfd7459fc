#include "sightline/render/layer_compositor.h"

#include <algorithm>
#include <set>
#include <string>

#include "scenes/glass.h"
#include "scenes/moving_scene.h"
#include "tests/render/test_scene.h"

namespace sightline {
namespace {

constexpr LayerRendererOptions kSmall{.width = 160, .height = 90};
// Compositing and blending in one picture round differently, by up to 1 of 255.
constexpr double kRounding = 1.0;

using Peel = CompositeSettings::Peel;

// Makes every object a part that does not move.
MovingScene still(Scene scene) {
  MovingScene moving;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    std::vector<Vec3d> points;
    for (const std::uint32_t index : scene.view().indicesOf(scene.objects[o])) {
      points.emplace_back(scene.positions[index]);
    }
    moving.hulls.push_back(buildHull(points).value());
    moving.parts.push_back({.name = scene.object_names.empty() ? "" : scene.object_names[o], .hulls = {o}});
  }
  moving.scene = std::move(scene);
  return moving;
}

MovingScene glass() {
  return still(makeGlass({.panes = 12, .bottles = 6}));
}

// A scene with its sorter, renderer and compositor.
class Studio {
 public:
  explicit Studio(MovingScene scene, const LayerRendererOptions& options = kSmall)
      : moving_(std::move(scene)),
        sorter_(makeSorter(moving_, {})),
        renderer_(std::move(LayerRenderer::create(moving_.scene.view(), options).value())),
        compositor_(moving_.scene.view(), renderer_),
        enabled_(moving_.parts.size(), true) {}

  void enable(std::size_t part, bool enabled) {
    enabled_[part] = enabled;
    sorter_.setEnabled(PartId(part), enabled);
  }
  void goTo(std::uint32_t frame) {
    view_ = moving_.scene.paths.at(0).view(frame, moving_.scene.origin);
    std::vector<Mat4> poses;
    pose(moving_, frame, poses, sorter_);
    placements(moving_, frame, poses);
    renderer_.setTransforms(poses);
    layers_ = merger_.merge(sorter_.update(view_));
  }
  void look(const View& view) {
    view_ = view;
    layers_ = merger_.merge(sorter_.update(view_));
  }

  LayerImage composite(const CompositeSettings& settings = {}, CompositeStats* stats = nullptr) {
    return compositeLayers(layers_, settings, stats);
  }
  LayerImage compositeLayers(const FrameLayers& layers, const CompositeSettings& settings = {},
                             CompositeStats* stats = nullptr) {
    LayerImage picture;
    const Result<CompositeStats> result = compositor_.composite(view_, layers, settings, picture);
    EXPECT_TRUE(result) << (result ? "" : result.error().message);
    if (stats != nullptr && result) {
      *stats = *result;
    }
    return picture;
  }
  // The picture that composite() must make: all enabled objects drawn at once, without those of left_out.
  LayerImage atOnce(std::span<const LayerId> left_out = {}, bool sky = true) {
    std::set<std::uint32_t> away;
    for (const LayerId layer : left_out) {
      for (const PartId part : layers_.partsOf(layer)) {
        away.insert(part.value);
      }
    }
    std::vector<ObjectId> objects;
    for (std::uint32_t part = 0; part < enabled_.size(); ++part) {
      if (enabled_[part] && away.count(part) == 0) {
        objects.emplace_back(part);
      }
    }
    LayerImage picture, behind;
    renderer_.draw(view_, objects, {.peel = true}, picture);
    if (sky) {
      renderer_.drawSky(view_, behind);
      compositeOver(picture, behind);
    }
    return picture;
  }

  std::uint32_t partNamed(const std::string& name) const {
    const auto& names = moving_.scene.object_names;
    return static_cast<std::uint32_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  LayerId layerOf(std::uint32_t part) const {
    for (std::uint32_t i = 0; i < layers_.layers(); ++i) {
      const std::span<const PartId> parts = layers_.partsOf(LayerId(i));
      if (std::find(parts.begin(), parts.end(), PartId(part)) != parts.end()) {
        return LayerId(i);
      }
    }
    return {};
  }
  bool isBlended(std::size_t part) const {
    return moving_.scene.view().materialOf(moving_.scene.objects[part]).opacity == Opacity::kBlended;
  }

  const FrameLayers& layers() const { return layers_; }
  const MovingScene& moving() const { return moving_; }
  const View& view() const { return view_; }
  LayerRenderer& renderer() { return renderer_; }
  LayerCompositor& compositor() { return compositor_; }

 private:
  MovingScene moving_;
  LayerSorter sorter_;
  LayerRenderer renderer_;
  LayerCompositor compositor_;
  LayerMerger merger_;
  FrameLayers layers_;
  std::vector<bool> enabled_;
  View view_;
};

std::uint32_t largestGroup(const FrameLayers& layers) {
  std::uint32_t largest = 0;
  for (std::size_t g = 0; g < layers.groups(); ++g) {
    largest = std::max(largest, layers.first_layer[g + 1] - layers.first_layer[g]);
  }
  return largest;
}

class LayerCompositorTest : public RenderTest {};

TEST_F(LayerCompositorTest, LayersOfMovingScenesAreThePictureOfAllAtOnce) {
  for (const bool canyon : {false, true}) {
    Studio studio(canyon ? makeCanyon({.grid = 5, .inflation = 0.0})
                         : makeToothpicks({.count = 60, .uniform_density = true}));
    for (const std::uint32_t frame : {0u, 60u, 170u}) {
      studio.goTo(frame);
      CompositeStats stats;
      const LayerImage picture = studio.composite({}, &stats);
      EXPECT_LE(measureDifference(picture, studio.atOnce()).largest, kRounding) << canyon << " " << frame;
      EXPECT_EQ(stats.layers, studio.layers().layers());
      EXPECT_EQ(stats.peeled, 0u);
      EXPECT_EQ(stats.unordered_groups, 0u);
      EXPECT_GT(stats.triangles, 0u);
    }
  }
}

// The pixels in which two objects are nearest at the same depth: a depth buffer shows either of them.
std::vector<bool> ties(Studio& studio) {
  const std::vector<ObjectId> objects = allOf(studio.moving().scene);
  LayerImage together, alone;
  studio.renderer().draw(studio.view(), objects, {.depths = true}, together);
  std::vector<int> nearest(together.pixels.size(), 0);
  for (const ObjectId& object : objects) {
    studio.renderer().draw(studio.view(), {&object, 1}, {.depths = true}, alone);
    for (std::size_t p = 0; p < nearest.size(); ++p) {
      nearest[p] += alone.depths[p] <= together.depths[p] * 1.0001f ? 1 : 0;
    }
  }
  std::vector<bool> tie;
  for (const int count : nearest) {
    tie.push_back(count > 1);
  }
  return tie;
}

// Pieces of terrain overlap: there two of them, each with a tint of its own, show the same surface.
TEST_F(LayerCompositorTest, OnlyWhereSurfacesLieInTheSamePlaceDoesAnOverlappingSplitDiffer) {
  Studio studio(makeCanyon({.grid = 5}));
  studio.goTo(60);
  const Image picture = toImage(studio.composite()), all = toImage(studio.atOnce());
  const std::vector<bool> tie = ties(studio);
  EXPECT_LT(std::count(tie.begin(), tie.end(), true), static_cast<std::ptrdiff_t>(tie.size() / 2));
  for (std::size_t p = 0; p < tie.size(); ++p) {
    for (std::size_t c = 4 * p; c < 4 * p + 4 && !tie[p]; ++c) {
      ASSERT_NEAR(picture.rgba[c], all.rgba[c], kRounding) << "pixel " << p;
    }
  }
}

TEST_F(LayerCompositorTest, WithoutTintsAnOverlappingSplitIsThePictureOfAllAtOnce) {
  Studio studio(makeCanyon({.grid = 5}), {.width = 160, .height = 90, .tints = false});
  for (const std::uint32_t frame : {0u, 60u, 170u}) {
    studio.goTo(frame);
    const PictureDifference difference = measureDifference(studio.composite(), studio.atOnce());
    EXPECT_LE(difference.largest, kRounding) << frame;
  }
}

TEST_F(LayerCompositorTest, LayersOfGlassAreThePictureOfAllPeeledAtOnce) {
  Studio studio(glass());
  for (const std::uint32_t frame : {0u, 60u, 110u, 160u, 239u}) {
    studio.goTo(frame);
    CompositeStats stats;
    const LayerImage picture = studio.composite({}, &stats);
    EXPECT_LE(measureDifference(picture, studio.atOnce()).largest, kRounding) << frame;
    EXPECT_GE(stats.unordered_groups, 3u);
    EXPECT_LT(stats.peeled, stats.layers / 2);
  }
}

// Leaves every part that is not see-through to the depth buffer.
MovingScene depthBuffered(MovingScene moving) {
  for (std::size_t part = 0; part < moving.parts.size(); ++part) {
    const Object& object = moving.scene.objects[part];
    if (moving.scene.view().materialOf(object).opacity != Opacity::kBlended) {
      moving.parts[part].settings.place = PartSettings::Place::kDepthBuffered;
    }
  }
  return moving;
}

TEST_F(LayerCompositorTest, SeeThroughLayersBehindADepthBufferAreThePictureOfAllPeeledAtOnce) {
  Studio all(glass()), studio(depthBuffered(glass()));
  for (const std::uint32_t frame : {0u, 60u, 110u, 160u, 239u}) {
    all.goTo(frame);
    studio.goTo(frame);
    ASSERT_TRUE(studio.layers().depth_buffered.valid());
    EXPECT_LT(studio.layers().layers(), all.layers().layers());
    const LayerImage picture = studio.composite();
    EXPECT_LE(measureDifference(picture, studio.atOnce()).largest, kRounding) << frame;
    EXPECT_LE(measureDifference(picture, all.composite()).largest, kRounding) << frame;
  }
}

// Layers have soft edges of their own then, as without a depth buffer.
TEST_F(LayerCompositorTest, WithSamplesSeeThroughLayersBehindADepthBufferDifferAtEdgesAlone) {
  LayerRendererOptions options = kSmall;
  options.samples = 2;
  Studio studio(depthBuffered(glass()), options);
  studio.goTo(60);
  const PictureDifference difference = measureDifference(studio.composite(), studio.atOnce());
  EXPECT_LT(difference.mean, 0.05);
  EXPECT_LT(difference.share_beyond, 0.01);
}

TEST_F(LayerCompositorTest, OrthographicAndMovedSeeThroughLayersAreHiddenByTheDepthBuffer) {
  Studio studio(depthBuffered(glass()));
  View view = studio.moving().scene.paths.at(0).view(60, studio.moving().scene.origin);
  view.orthographic = true;
  view.ortho_height = 6.0;
  studio.look(view);
  EXPECT_LE(measureDifference(studio.composite(), studio.atOnce()).largest, kRounding);
  // Another picture from elsewhere in between does not leave its depths behind.
  studio.goTo(200);
  (void)studio.composite();
  studio.look(view);
  EXPECT_LE(measureDifference(studio.composite(), studio.atOnce()).largest, kRounding);
}

TEST_F(LayerCompositorTest, AnOverlayIsBeforeTheDepthBufferAndABackdropBehindIt) {
  SceneMaker maker;
  maker.wall(0.0, 2.0, kGlass);          // the overlay, though it is behind
  maker.wall(3.0, 3.0, kRed);            // opaque
  maker.wall(1.0, 4.0, kBlueBothSides);  // the backdrop
  maker.wall(4.0, 1.0, kGlass);          // before the wall
  maker.wall(2.0, 1.0, kGlass);          // behind it
  MovingScene moving = still(std::move(maker.scene));
  using Place = PartSettings::Place;
  const Place places[] = {Place::kOverlay, Place::kDepthBuffered, Place::kBackdrop, Place::kSorted,
                          Place::kSorted};
  for (std::size_t i = 0; i < 5; ++i) {
    moving.parts[i].settings.place = places[i];
  }
  Studio studio(std::move(moving));
  studio.look(testView());
  const LayerImage picture = studio.composite();
  // The same by hand, layer over layer.
  LayerImage by_hand, layer;
  by_hand.clear(kSmall.width, kSmall.height);
  for (const std::uint32_t part : {0u, 3u, 1u, 2u}) {
    const ObjectId object(part);
    studio.renderer().draw(studio.view(), {&object, 1}, {}, layer);
    compositeOver(by_hand, layer);
  }
  studio.renderer().drawSky(studio.view(), layer);
  compositeOver(by_hand, layer);
  EXPECT_LE(measureDifference(picture, by_hand).largest, kRounding);
}

TEST_F(LayerCompositorTest, SamplesChangeEdgesAlone) {
  Studio studio(glass(), {.width = 160, .height = 90, .samples = 2});
  studio.goTo(60);
  const PictureDifference difference = measureDifference(studio.composite(), studio.atOnce());
  EXPECT_LT(difference.share_beyond, 0.02);
  EXPECT_LT(difference.mean, 0.2);
}

// Most programs sort by the distances of centres.
TEST_F(LayerCompositorTest, AnOrderByDistancesOfCentresGivesAnotherPicture) {
  Studio studio(glass());
  for (std::uint32_t part = 0; part < studio.moving().parts.size(); ++part) {
    studio.enable(part, studio.isBlended(part));
  }
  studio.goTo(80);
  FrameLayers by_distance;
  by_distance.parts = studio.layers().parts;
  const auto distance = [&](PartId part) {
    return length(center(studio.moving().scene.objects[part.value].bounds) - studio.view().eye);
  };
  std::sort(by_distance.parts.begin(), by_distance.parts.end(),
            [&](PartId a, PartId b) { return distance(a) < distance(b); });
  for (std::uint32_t i = 0; i <= by_distance.parts.size(); ++i) {
    by_distance.first_part.push_back(i);
    by_distance.first_layer.push_back(i);
  }
  ASSERT_TRUE(checkLayers(by_distance));
  const LayerImage right = studio.atOnce();
  EXPECT_GT(measureDifference(studio.compositeLayers(by_distance), right).share_beyond, 0.01);
  EXPECT_EQ(measureDifference(studio.composite(), right).share_beyond, 0.0);
}

// Six bars, each before the next all the way round.
MovingScene ringOf(Opacity opacity) {
  Scene scene = makeGlass({.panes = 0, .bottles = 0});
  for (Material& material : scene.materials) {
    material.opacity = opacity;
  }
  return still(std::move(scene));
}

TEST_F(LayerCompositorTest, ARingOfOpaqueBarsIsCompositedByExpressions) {
  Studio studio(ringOf(Opacity::kOpaque));
  studio.goTo(0);
  EXPECT_EQ(largestGroup(studio.layers()), 6u);
  const LayerImage all = studio.atOnce();
  for (const CompositingForm form :
       {CompositingForm::kSumOfOuts, CompositingForm::kOverAtop, CompositingForm::kCheapest}) {
    CompositeStats stats;
    EXPECT_LE(measureDifference(studio.composite({.form = form}, &stats), all).largest, kRounding);
    EXPECT_EQ(stats.layers, studio.layers().layers());
    EXPECT_GT(stats.operations.outs, 0u);
  }
}

TEST_F(LayerCompositorTest, ARingOfGlassIsPeeledAsOneLayer) {
  Studio studio(glass());
  studio.goTo(0);
  ASSERT_EQ(largestGroup(studio.layers()), 6u);
  CompositeStats peeled, expressions;
  const LayerImage all = studio.atOnce();
  EXPECT_LE(measureDifference(studio.composite({}, &peeled), all).largest, kRounding);
  studio.composite({.peel = Peel::kNever}, &expressions);
  EXPECT_EQ(expressions.layers, studio.layers().layers());
  EXPECT_EQ(peeled.layers, expressions.layers - 5);
  EXPECT_EQ(expressions.peeled, 0u);
  EXPECT_EQ(peeled.unordered_groups, expressions.unordered_groups);
}

// With one sample for each pixel no ray intersects a whole cycle, so the expressions are correct for glass
// too.
TEST_F(LayerCompositorTest, ARingOfGlassByExpressionsIsTheSame) {
  Studio studio(glass());
  for (std::uint32_t part = 0; part < studio.moving().parts.size(); ++part) {
    studio.enable(part, studio.moving().parts[part].name.rfind("ring", 0) == 0);
  }
  studio.goTo(0);
  ASSERT_EQ(studio.layers().layers(), 6u);
  ASSERT_EQ(studio.layers().groups(), 1u);
  EXPECT_LE(measureDifference(studio.composite({.peel = Peel::kNever}), studio.atOnce()).largest, kRounding);
}

TEST_F(LayerCompositorTest, ACycleBehindAnotherGroupIsInThePicture) {
  Studio studio(glass());
  for (std::uint32_t part = 0; part < studio.moving().parts.size(); ++part) {
    studio.enable(part, studio.moving().parts[part].name.rfind("ring", 0) == 0);
  }
  studio.goTo(0);
  // The same cycle as the second of two groups, with a transparent image in the first one.
  FrameLayers layers = studio.layers();
  ASSERT_EQ(layers.groups(), 1u);
  const PartId other(studio.partNamed("floor"));
  layers.parts.insert(layers.parts.begin(), other);
  layers.first_part.insert(layers.first_part.begin(), 0u);
  for (std::size_t i = 1; i < layers.first_part.size(); ++i) {
    ++layers.first_part[i];
  }
  layers.first_layer = {0, 1, 7};
  for (LayerOcclusion& occlusion : layers.occlusions) {
    ++occlusion.front.value, ++occlusion.back.value;
  }
  ASSERT_TRUE(checkLayers(layers));
  LayerImage nothing;
  nothing.clear(studio.renderer().width(), studio.renderer().height());
  CompositeSettings settings{.peel = Peel::kNever};
  settings.replaced = {{LayerId(0u), &nothing}};
  EXPECT_LE(measureDifference(studio.compositeLayers(layers, settings), studio.atOnce()).largest, kRounding);
}

TEST_F(LayerCompositorTest, WhatMayCoverItselfIsPeeledAndNothingElse) {
  Studio studio(glass());
  studio.goTo(100);
  std::vector<std::string> peeled, not_peeled;
  CompositeSettings settings;
  settings.draw_layer = [&](std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
    if (objects.size() == 1 && studio.isBlended(objects[0].value)) {
      (how.peel ? peeled : not_peeled).push_back(studio.moving().parts[objects[0].value].name);
    } else if (objects.size() == 1) {
      EXPECT_FALSE(how.peel);
    }
    studio.renderer().draw(studio.view(), objects, how, image);
  };
  studio.composite(settings);
  EXPECT_GE(peeled.size(), 12u);
  for (const std::string& name : peeled) {
    EXPECT_EQ(name.rfind("bottle", 0), 0u) << name;
  }
  EXPECT_GE(not_peeled.size(), 10u);
  for (const std::string& name : not_peeled) {
    EXPECT_NE(name.rfind("bottle", 0), 0u) << name;
  }
}

TEST_F(LayerCompositorTest, WithoutALayerItIsThePictureOfTheOthers) {
  Studio studio(glass());
  studio.goTo(80);
  for (const char* name : {"long pane", "floor", "ring 2", "bottle by the long pane 4", "cabinet"}) {
    const std::vector<LayerId> left_out{studio.layerOf(studio.partNamed(name))};
    CompositeSettings settings;
    settings.left_out = left_out;
    EXPECT_LE(measureDifference(studio.composite(settings), studio.atOnce(left_out)).largest, kRounding)
        << name;
  }
  EXPECT_GT(measureDifference(studio.composite({.left_out = {studio.layerOf(studio.partNamed("floor"))}}),
                              studio.atOnce())
                .share_beyond,
            0.1);
}

TEST_F(LayerCompositorTest, ALayerReplacedByItsOwnImageChangesNothing) {
  Studio studio(glass());
  studio.goTo(0);
  const LayerImage picture = studio.composite();
  for (const char* name : {"floor", "ring 2", "film 2"}) {
    const ObjectId object(studio.partNamed(name));
    LayerImage own;
    studio.renderer().draw(studio.view(), {&object, 1}, {}, own);
    CompositeSettings settings;
    settings.replaced = {{studio.layerOf(object.value), &own}};
    EXPECT_LE(measureDifference(studio.composite(settings), picture).largest, kRounding) << name;
  }
}

TEST_F(LayerCompositorTest, AReplacementLiesWhereItsLayerLies) {
  SceneMaker maker;
  maker.wall(4.0, 0.3, kRed);
  const ObjectId proxy = maker.wall(2.0, 1.0, kRed);
  maker.wall(0.0, 3.0, kRed);
  Studio studio(still(maker.scene), {.width = 64, .height = 48});
  studio.look(testView());
  LayerImage green;
  green.clear(64, 48);
  for (std::uint32_t y = 20; y < 28; ++y) {
    for (std::uint32_t x = 16; x < 48; ++x) {
      green.pixels[y * 64 + x] = {0.0f, 0.6f, 0.0f, 1.0f};
    }
  }
  CompositeSettings settings;
  settings.replaced = {{studio.layerOf(proxy.value), &green}};
  CompositeStats stats;
  const Image picture = toImage(studio.composite(settings, &stats));
  EXPECT_EQ(stats.layers, 2u);
  EXPECT_TRUE(isRed(pixelOf(picture, 32, 24)));    // the wall before it
  EXPECT_TRUE(isGreen(pixelOf(picture, 20, 24)));  // before the wall behind it
  EXPECT_TRUE(isRed(pixelOf(picture, 20, 32)));
}

TEST_F(LayerCompositorTest, TheSkyIsBehindEverythingOrLeftAway) {
  SceneMaker maker;
  maker.wall(0.0, 0.5, kGlass);
  Studio studio(still(maker.scene), {.width = 32, .height = 24});
  studio.look(testView());
  const LayerImage with = studio.composite(), without = studio.composite({.sky = false});
  EXPECT_FLOAT_EQ(with.pixels.front().alpha, 1.0f);
  EXPECT_EQ(without.pixels.front(), ShapedPixel{});
  const ShapedPixel& middle = without.pixels[12 * 32 + 16];
  EXPECT_NEAR(middle.alpha, 0.5f, 0.01f);
  EXPECT_LE(measureDifference(without, studio.atOnce({}, false)).largest, kRounding);
}

TEST_F(LayerCompositorTest, NothingGivesTheSky) {
  SceneMaker maker;
  maker.wall(0.0, 0.5, kRed);
  Studio studio(still(maker.scene), {.width = 32, .height = 24});
  studio.look(testView());
  LayerImage sky;
  studio.renderer().drawSky(studio.view(), sky);
  EXPECT_EQ(studio.compositeLayers({}).pixels, sky.pixels);
}

TEST_F(LayerCompositorTest, PicturesKeepTheirMemoryFromFrameToFrame) {
  Studio studio(glass());
  std::set<const ShapedPixel*> memory;
  CompositeSettings settings;
  settings.draw_layer = [&](std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image) {
    studio.renderer().draw(studio.view(), objects, how, image);
    memory.insert(image.pixels.data());
  };
  LayerImage picture;
  const auto run = [&](std::uint32_t frame) {
    studio.goTo(frame);
    EXPECT_TRUE(studio.compositor().composite(studio.view(), studio.layers(), settings, picture));
  };
  run(0);
  run(1);
  const std::set<const ShapedPixel*> first = memory;
  const ShapedPixel* picture_memory = picture.pixels.data();
  EXPECT_LE(first.size(), largestGroup(studio.layers()));
  for (std::uint32_t frame = 2; frame < 6; ++frame) {
    run(frame);
  }
  EXPECT_EQ(memory, first);
  EXPECT_EQ(picture.pixels.data(), picture_memory);
}

TEST_F(LayerCompositorTest, WhatCannotBeIsAnError) {
  SceneMaker maker;
  maker.wall(0.0, 0.5, kRed);
  Studio studio(still(maker.scene), {.width = 32, .height = 24});
  studio.look(testView());
  LayerImage image, picture;
  image.clear(32, 25);
  const auto fails = [&](const FrameLayers& layers, const CompositeSettings& settings) {
    return !studio.compositor().composite(studio.view(), layers, settings, picture);
  };
  EXPECT_TRUE(fails(studio.layers(), {.replaced = {{LayerId(0u), &image}}}));
  image.clear(32, 24);
  EXPECT_FALSE(fails(studio.layers(), {.replaced = {{LayerId(0u), &image}}}));
  EXPECT_TRUE(fails(studio.layers(), {.replaced = {{LayerId(1u), &image}}}));
  EXPECT_TRUE(fails(studio.layers(), {.replaced = {{LayerId(0u), nullptr}}}));
  EXPECT_FALSE(fails(studio.layers(), {.left_out = {LayerId(7u), LayerId{}}}));
  FrameLayers other = studio.layers();
  other.parts[0] = PartId(1u);
  EXPECT_TRUE(fails(other, {}));
  CompositeSettings smaller;
  smaller.draw_layer = [](std::span<const ObjectId>, const LayerDraw&, LayerImage& drawn) {
    drawn.clear(16, 12);
  };
  EXPECT_TRUE(fails(studio.layers(), smaller));
  EXPECT_FALSE(fails(studio.layers(), {}));
}

}  // namespace
}  // namespace sightline
