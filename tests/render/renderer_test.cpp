#include "sightline/render/renderer.h"

#include "sightline/render/compare.h"
#include "tests/render/test_scene.h"

namespace sightline {
namespace {

class RendererTest : public RenderTest {};

TEST_F(RendererTest, TheNearerOfTwoWallsIsSeenWhicheverComesFirst) {
  for (const bool near_first : {true, false}) {
    SceneMaker maker;
    maker.wall(near_first ? 2.0 : 0.0, 1.0, near_first ? kRed : kGreen);
    maker.wall(near_first ? 0.0 : 2.0, 1.0, near_first ? kGreen : kRed);
    Renderer renderer = rendererOf(maker.scene);
    EXPECT_TRUE(isRed(middleOf(renderer.draw(testView(), allOf(maker.scene)))));
  }
}

TEST_F(RendererTest, OnlyTheGivenObjectsAreDrawn) {
  SceneMaker maker;
  maker.wall(2.0, 1.0, kRed);
  const ObjectId behind = maker.wall(0.0, 1.0, kGreen);
  Renderer renderer = rendererOf(maker.scene);
  DrawStats stats;
  EXPECT_TRUE(isGreen(middleOf(renderer.draw(testView(), std::vector{behind}, &stats))));
  EXPECT_EQ(stats.triangles, 2u);
  EXPECT_GT(stats.draw_us, 0.0);
  EXPECT_EQ(renderer.time(testView(), {}).triangles, 0u);
}

TEST_F(RendererTest, BacksAreDrawnOnlyOfDoubleSidedMaterials) {
  SceneMaker maker;
  maker.wall(2.0, 1.0, kRed, true);
  maker.wall(1.0, 1.0, kBlueBothSides, true);
  maker.wall(0.0, 1.0, kGreen);
  Renderer renderer = rendererOf(maker.scene);
  EXPECT_TRUE(isBlue(middleOf(renderer.draw(testView(), allOf(maker.scene)))));
  EXPECT_TRUE(isGreen(middleOf(renderer.draw(testView(), std::vector{ObjectId(0u), ObjectId(2u)}))));
}

TEST_F(RendererTest, BlendedObjectsMixWithWhatIsBehindAndDoNotHideIt) {
  SceneMaker maker;
  maker.wall(2.0, 1.0, kGlass);
  maker.wall(0.0, 1.0, kRed);
  Renderer renderer = rendererOf(maker.scene);
  const Pixel alone = middleOf(renderer.draw(testView(), std::vector{ObjectId(1u)}));
  const Pixel through = middleOf(renderer.draw(testView(), allOf(maker.scene)));
  EXPECT_TRUE(isRed(alone));
  EXPECT_GT(through.r, alone.r / 3);
  EXPECT_GT(through.b, alone.b + 40);
}

TEST_F(RendererTest, AlphaTestedObjectsLetHalfOfThePixelsThrough) {
  SceneMaker maker;
  maker.wall(2.0, 1.0, kFoliage);
  maker.wall(0.0, 1.0, kRed);
  Renderer renderer = rendererOf(maker.scene);
  const Image image = renderer.draw(testView(), allOf(maker.scene));
  int red = 0;
  for (std::uint32_t x = 150; x < 170; ++x) {
    for (std::uint32_t y = 110; y < 130; ++y) {
      red += isRed(pixelOf(image, x, y)) ? 1 : 0;
    }
  }
  EXPECT_EQ(red, 200);
}

TEST_F(RendererTest, TheSamePictureTwiceIsBitEqualAlsoFromAnotherRenderer) {
  SceneMaker maker;
  maker.box({-1, -1, -1}, {1, 1, 1}, kRed);
  maker.wall(2.0, 0.4, kGlass);
  maker.wall(3.0, 0.2, kFoliage);
  Renderer renderer = rendererOf(maker.scene);
  Renderer other = rendererOf(maker.scene);
  const View view = testView({0.3, 0.7, 9.0});
  const Image first = renderer.draw(view, allOf(maker.scene));
  EXPECT_EQ(first, renderer.draw(view, allOf(maker.scene)));
  EXPECT_EQ(first, other.draw(view, allOf(maker.scene)));
  EXPECT_EQ(first, renderer.readBack());
}

TEST_F(RendererTest, APictureWithoutTheHiddenObjectsIsBitEqual) {
  SceneMaker maker;
  std::vector<ObjectId> kept;
  for (int i = 0; i < 40; ++i) {
    const int column = i % 10, row = i / 10;
    const auto x = static_cast<float>(column - 5);
    const auto y = static_cast<float>(row - 2);
    // Every other small box is behind the wall at z = 3, the others before it or beside it.
    const float z = i % 2 == 0 ? 1.0f : 4.0f;
    const ObjectId id = maker.box({0.2f * x, 0.2f * y, z}, {0.2f * x + 0.15f, 0.2f * y + 0.15f, z + 0.3f},
                                  i % 3 == 0   ? kGlass
                                  : i % 3 == 1 ? kRed
                                               : kFoliage);
    if (i % 2 == 1) {
      kept.push_back(id);
    }
    if (i == 20) {
      kept.push_back(maker.wall(3.0, 2.0, kGreen));
    }
  }
  Renderer renderer = rendererOf(maker.scene, 640, 480);
  const View view = testView({0.1, -0.2, 12.0});
  DrawStats all_stats, kept_stats;
  const Image all = renderer.draw(view, allOf(maker.scene), &all_stats);
  const Image without = renderer.draw(view, kept, &kept_stats);
  EXPECT_EQ(compareImages(all, without).pixels, 0u);
  EXPECT_LT(kept_stats.triangles, all_stats.triangles);
}

TEST_F(RendererTest, ConsecutiveObjectsOfOnePassAreOneRange) {
  SceneMaker maker;
  for (int i = 0; i < 10; ++i) {
    maker.wall(0.1 * i, 1.0, i % 2 == 0 ? kRed : kBlueBothSides);
  }
  Renderer renderer = rendererOf(maker.scene);
  DrawStats stats;
  (void)renderer.draw(testView(), allOf(maker.scene), &stats);
  EXPECT_EQ(stats.ranges, 2u);
}

TEST_F(RendererTest, OrthographicSizesDoNotDependOnDistance) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  Renderer renderer = rendererOf(maker.scene);
  View view = testView();
  view.orthographic = true;
  view.ortho_height = 4.0;
  const Image near = renderer.draw(view, allOf(maker.scene));
  view.eye.z = 200.0;
  const Image far = renderer.draw(view, allOf(maker.scene));
  for (const Image* image : {&near, &far}) {
    // The wall is half as high as the picture, 240 pixels.
    EXPECT_TRUE(isRed(pixelOf(*image, 160, 62)));
    EXPECT_FALSE(isRed(pixelOf(*image, 160, 58)));
    EXPECT_TRUE(isRed(pixelOf(*image, 160, 177)));
    EXPECT_FALSE(isRed(pixelOf(*image, 160, 181)));
  }
}

TEST_F(RendererTest, OffCentreViewsAreTilesOfAPicture) {
  SceneMaker maker;
  maker.box({1.0f, 0.5f, -1.0f}, {3.0f, 2.5f, 1.0f}, kRed);
  Renderer renderer = rendererOf(maker.scene);
  for (const bool orthographic : {false, true}) {
    View whole = testView();
    whole.orthographic = orthographic;
    whole.ortho_height = 10.0;
    const Image picture = renderer.draw(whole, allOf(maker.scene));
    int different = 0, red = 0;
    for (const int right : {-1, 1}) {
      for (const int up : {-1, 1}) {
        View tile = whole;
        tile.tan_half_fovy *= 0.5;
        tile.ortho_height *= 0.5;
        tile.shift_x = right;
        tile.shift_y = up;
        const Image part = renderer.draw(tile, allOf(maker.scene));
        // Every second pixel of the tile beside the pixels of the picture.
        for (std::uint32_t y = 0; y < part.height; ++y) {
          for (std::uint32_t x = 0; x < part.width; ++x) {
            const std::uint32_t at_x = (x + (right > 0 ? part.width : 0)) / 2;
            const std::uint32_t at_y = (y + (up > 0 ? 0 : part.height)) / 2;
            const bool in_part = isRed(pixelOf(part, x, y));
            different += in_part != isRed(pixelOf(picture, at_x, at_y)) ? 1 : 0;
            red += in_part ? 1 : 0;
          }
        }
      }
    }
    EXPECT_GT(red, 1000);
    EXPECT_LT(different, red / 20) << "along the borders";
  }
}

TEST_F(RendererTest, WhatTheNearAndFarPlanesCutAwayIsNotDrawn) {
  SceneMaker maker;
  maker.wall(2.0, 3.0, kRed);
  maker.wall(0.0, 3.0, kGreen);
  Renderer renderer = rendererOf(maker.scene);
  View view = testView();
  view.z_near = 9.0;
  EXPECT_TRUE(isGreen(middleOf(renderer.draw(view, allOf(maker.scene)))));
  view.z_far = 9.5;
  const Pixel sky = middleOf(renderer.draw(view, allOf(maker.scene)));
  EXPECT_FALSE(isGreen(sky) || isRed(sky));
}

TEST_F(RendererTest, SmallDistancesHoldFarFromTheOrigin) {
  const Scene scene = closeWalls({1024.0f, 0.0f, 2048.0f});
  Renderer renderer = rendererOf(scene);
  const Image image = renderer.draw(testView({1024.0, 0.0, 2058.0}), allOf(scene));
  for (std::uint32_t x = 140; x < 180; ++x) {
    EXPECT_TRUE(isRed(pixelOf(image, x, 120)));
  }
}

TEST_F(RendererTest, CountsWhatShowsOfCulledObjectsButNotWhatADepthBufferCannotOrder) {
  SceneMaker maker;
  const ObjectId front = maker.wall(0.0, 1.0, kGreen);
  const ObjectId equal = maker.wall(0.0, 1.0, kRed);
  const ObjectId behind = maker.wall(-1.0, 0.5, kRed);
  const ObjectId before = maker.wall(0.01, 0.5, kRed);
  const ObjectId glass = maker.wall(0.01, 0.5, kGlass);
  Renderer renderer = rendererOf(maker.scene);
  const std::vector kept{front};
  EXPECT_EQ(renderer.countShowing(testView(), kept, std::vector{equal, behind}), 0u);
  EXPECT_EQ(renderer.countShowing(testView(), kept, {}), 0u);
  EXPECT_GT(renderer.countShowing(testView(), kept, std::vector{before}), 500u);
  EXPECT_GT(renderer.countShowing(testView(), kept, std::vector{glass}), 500u);
  EXPECT_GT(renderer.countShowing(testView(), {}, kept), 2000u);
}

TEST_F(RendererTest, AnEmptySceneIsSky) {
  const Scene scene;
  Renderer renderer = rendererOf(scene);
  const Image image = renderer.draw(testView(), {});
  EXPECT_EQ(image.rgba.size(), 320u * 240u * 4u);
  EXPECT_GT(middleOf(image).b, 100);
}

TEST_F(RendererTest, RenderersMoveAndCoexist) {
  SceneMaker red, green;
  red.wall(0.0, 1.0, kRed);
  green.wall(0.0, 1.0, kGreen);
  Renderer a = rendererOf(red.scene);
  Renderer b = rendererOf(green.scene);
  Renderer c = std::move(a);
  EXPECT_TRUE(isRed(middleOf(c.draw(testView(), allOf(red.scene)))));
  EXPECT_TRUE(isGreen(middleOf(b.draw(testView(), allOf(green.scene)))));
  b = std::move(c);
  EXPECT_TRUE(isRed(middleOf(b.draw(testView(), allOf(red.scene)))));
  EXPECT_FALSE(b.device().empty());
}

TEST_F(RendererTest, AnImpossibleSizeIsAnErrorThatNamesIt) {
  SceneMaker maker;
  maker.wall(0.0, 1.0, kRed);
  const Result<Renderer> none = Renderer::create(maker.scene.view(), 0, 240);
  ASSERT_FALSE(none.has_value());
  EXPECT_NE(none.error().message.find("0 x 240"), std::string::npos);
  EXPECT_FALSE(Renderer::create(maker.scene.view(), 1u << 20, 240).has_value());
}

}  // namespace
}  // namespace sightline
