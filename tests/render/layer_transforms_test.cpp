#include <limits>

#include "tests/render/layer_test.h"

namespace sightline {
namespace {

class LayerTransformsTest : public LayerTest {};

Mat4 placed(double angle, const Vec3d& offset, double scale = 1.0) {
  Mat4 m;
  m(0, 0) = m(2, 2) = std::cos(angle) * scale;
  m(0, 2) = std::sin(angle) * scale;
  m(2, 0) = -m(0, 2);
  m(1, 1) = scale;
  m(0, 3) = offset.x;
  m(1, 3) = offset.y;
  m(2, 3) = offset.z;
  return m;
}

// The scene with its stored positions transformed. Precondition: no position belongs to two objects.
Scene movedScene(Scene scene, const std::vector<Mat4>& scene_from_stored) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    std::vector<std::uint32_t> own;
    const Object& object = scene.objects[i];
    for (std::uint32_t k = 0; k < object.index_count; ++k) {
      own.push_back(scene.indices[object.first_index + k]);
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    for (const std::uint32_t index : own) {
      Vec3f& position = scene.positions[index];
      position = Vec3f(transformPoint(scene_from_stored[i], Vec3d(position)));
    }
  }
  updateBounds(scene);
  return scene;
}

TEST_F(LayerTransformsTest, TransformsMoveObjects) {
  const SceneMaker maker = opaqueScene(9);
  std::mt19937 random(9);
  std::vector<Mat4> places;
  for (std::size_t i = 0; i < maker.scene.objects.size(); ++i) {
    places.push_back(placed(uniform(random, -3, 3), {uniform(random, -1, 1), uniform(random, -1, 1), 0.0},
                            uniform(random, 0.5f, 1.5f)));
  }
  const Scene expected_scene = movedScene(maker.scene, places);
  LayerRenderer layers = layersOf(maker.scene), expected = layersOf(expected_scene);
  layers.setTransforms(places);
  for (const bool orthographic : {false, true}) {
    for (const LensPoint& lens : {LensPoint{}, LensPoint{.right = 0.3, .up = 0.2, .focus = 8.0}}) {
      const View view = turnedView(orthographic);
      const LayerImage moved = drawn(layers, view, allOf(maker.scene), {.depths = true, .lens = lens});
      const LayerImage stored = drawn(expected, view, allOf(maker.scene), {.depths = true, .lens = lens});
      EXPECT_LT(measureDifference(moved, stored, 2.0).share_beyond, 0.003);
      int differing = 0;
      for (std::size_t i = 0; i < moved.depths.size(); ++i) {
        const bool both = std::isfinite(moved.depths[i]) && std::isfinite(stored.depths[i]);
        differing +=
            both ? std::abs(moved.depths[i] - stored.depths[i]) > 1e-3f : moved.depths[i] != stored.depths[i];
      }
      EXPECT_LT(differing, 10);
    }
  }
}

TEST_F(LayerTransformsTest, IdentitiesChangeNoBit) {
  const SceneMaker maker = opaqueScene(10);
  LayerRenderer layers = layersOf(maker.scene);
  const LayerDraw how{.depths = true};
  const LayerImage stored = drawn(layers, turnedView(false), allOf(maker.scene), how);
  layers.setTransforms(std::vector<Mat4>(maker.scene.objects.size()));
  EXPECT_EQ(drawn(layers, turnedView(false), allOf(maker.scene), how).pixels, stored.pixels);
  EXPECT_EQ(drawn(layers, turnedView(false), allOf(maker.scene), how).depths, stored.depths);
  layers.setTransforms(std::vector{placed(1.0, {})});  // of the first object, the others are as stored
  EXPECT_NE(drawn(layers, turnedView(false), allOf(maker.scene), how).pixels, stored.pixels);
  layers.setTransforms({});
  EXPECT_EQ(drawn(layers, turnedView(false), allOf(maker.scene), how).pixels, stored.pixels);
}

TEST_F(LayerTransformsTest, TheEyeMayChangeBetweenPicturesOfMovedObjects) {
  const SceneMaker maker = opaqueScene(11);
  LayerRenderer layers = layersOf(maker.scene);
  const LayerImage before = drawn(layers, turnedView(true), allOf(maker.scene));
  layers.setTransforms(std::vector<Mat4>(maker.scene.objects.size()));
  (void)drawn(layers, testView(), allOf(maker.scene));
  EXPECT_EQ(drawn(layers, turnedView(true), allOf(maker.scene)).pixels, before.pixels);
}

TEST_F(LayerTransformsTest, MovedFarFromTheOriginSmallDistancesHold) {
  const Scene scene = closeWalls();
  LayerRenderer layers = layersOf(scene);
  const LayerImage near = drawn(layers, testView(), allOf(scene));
  // A thousand kilometres away, where a float has steps of 6 centimetres.
  const Vec3d far(1e6 + 0.123, 33.3, -2e6);
  layers.setTransforms(std::vector(2, placed(0.0, far)));
  const LayerImage moved = drawn(layers, testView(Vec3d(0.0, 0.0, 10.0) + far), allOf(scene));
  EXPECT_LT(measureDifference(near, moved, 2.0).share_beyond, 0.003);
}

TEST_F(LayerTransformsTest, MirroredObjectsKeepTheirFronts) {
  SceneMaker maker;
  maker.box({0.5f, -1.0f, -1.0f}, {2.0f, 1.0f, 1.0f}, kRed);
  maker.wall(3.0, 0.8, kGlass);
  maker.wall(3.5, 0.8, kGreen, true);  // its back: not seen
  LayerRenderer layers = layersOf(maker.scene);
  Mat4 mirror;
  mirror(0, 0) = -1.0;
  layers.setTransforms(std::vector(3, mirror));
  const LayerImage mirrored = drawn(layers, testView(), allOf(maker.scene), {.depths = true});

  SceneMaker expected;
  expected.box({-2.0f, -1.0f, -1.0f}, {-0.5f, 1.0f, 1.0f}, kRed);
  expected.wall(3.0, 0.8, kGlass);
  LayerRenderer other = layersOf(expected.scene);
  const LayerImage stored = drawn(other, testView(), allOf(expected.scene), {.depths = true});
  EXPECT_LT(measureDifference(mirrored, stored, 2.0).share_beyond, 0.01);
  const std::size_t left = kHeight / 2 * kWidth + kWidth / 2 - 7;
  EXPECT_NEAR(mirrored.depths[left], stored.depths[left], 1e-4);
  EXPECT_NEAR(mirrored.depths[left], 9.0, 1e-4);  // its front, not the inside of its back, two metres farther
}

TEST_F(LayerTransformsTest, ObjectsWithoutAFinitePlaceAreNotDrawn) {
  SceneMaker maker;
  maker.wall(1.0, 1.0, kRed);
  maker.wall(0.0, 1.0, kGreen);
  LayerRenderer layers = layersOf(maker.scene);
  const LayerImage green = drawn(layers, testView(), std::vector{ObjectId(1u)});
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    for (const int element : {0, 13}) {
      std::vector<Mat4> places(2);
      places[0].m[static_cast<std::size_t>(element)] = bad;
      layers.setTransforms(places);
      EXPECT_EQ(drawn(layers, testView(), allOf(maker.scene)).pixels, green.pixels);
    }
  }
  std::vector<Mat4> flat(2);
  flat[0](2, 2) = 0.0;  // no inverse: pressed onto z = 0, and moved before the other one
  flat[0](2, 3) = 0.5;
  layers.setTransforms(flat);
  const LayerImage image = drawn(layers, testView(), allOf(maker.scene), {.depths = true});
  EXPECT_NEAR(image.depths[kHeight / 2 * kWidth + kWidth / 2], 9.5, 1e-4);
}

}  // namespace
}  // namespace sightline
