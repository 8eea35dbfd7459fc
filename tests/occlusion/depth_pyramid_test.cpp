#include "sightline/occlusion/depth_pyramid.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/scene/pixel_view.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/instruction_sets.h"

namespace sightline {
namespace {

using namespace test;

constexpr RasterSettings kPyramidSizes[] = {{320, 180}, {64, 64}, {257, 33}};

DepthPyramid pyramidOf(std::span<const OraclePolygon> polygons, const View& view,
                       const RasterSettings& raster = {.width = 256, .height = 256}) {
  DepthPyramid pyramid({.raster = raster});
  const OccluderSet set = setOf(polygons);
  pyramid.build(view, set, all(set));
  return pyramid;
}

Visibility seenPast(std::span<const OraclePolygon> polygons, const Box& box) {
  return pyramidOf(polygons, kLookingBack).classify(box);
}

bool same(const BoxAnswer& a, const BoxAnswer& b) {
  return a.visibility == b.visibility && a.within_view == b.within_view;
}

TEST(DepthPyramid, TellsHiddenPartialAndVisible) {
  const std::vector<OraclePolygon> walls{wall(-2, 2, -2, 2, -5)};
  EXPECT_EQ(seenPast(walls, {{-1, -1, -9}, {1, 1, -8}}), Visibility::kHidden);
  EXPECT_EQ(seenPast(walls, {{-1, -1, -9}, {9, 1, -8}}), Visibility::kPartial);
  EXPECT_EQ(seenPast(walls, {{5, -1, -9}, {6, 1, -8}}), Visibility::kVisible) << "beside the wall";
  EXPECT_EQ(seenPast(walls, {{-1, -1, -4}, {1, 1, -3}}), Visibility::kVisible) << "before the wall";
  EXPECT_EQ(seenPast(walls, {{-1, -1, -6}, {1, 1, -4}}), Visibility::kPartial) << "through the wall";
  EXPECT_EQ(seenPast(walls, {{-1, -1, 3}, {1, 1, 4}}), Visibility::kHidden) << "behind the eye";
  EXPECT_EQ(seenPast(walls, {{-1, -1, -1}, {1, 1, 1}}), Visibility::kPartial) << "around the eye";
}

TEST(DepthPyramid, ABoxThatTouchesTheWallFromBehindIsNotHidden) {
  const std::vector<OraclePolygon> walls{wall(-2, 2, -2, 2, -5)};
  EXPECT_NE(seenPast(walls, {{-1, -1, -6}, {1, 1, -5}}), Visibility::kHidden);
  EXPECT_EQ(seenPast(walls, {{-1, -1, -6}, {1, 1, -5.001f}}), Visibility::kHidden);
}

TEST(DepthPyramid, ABoxIsComparedByItsOwnDepthInEachPixelNotByItsNearestPoint) {
  // A long box that recedes, and a wall before it that recedes likewise, a tenth nearer all along.
  const View view = viewFrom({0, 0, 0}, {0.8, -0.1, -1.6});
  const Box box{{1, -0.5f, -6}, {1.2f, 0, -1.5f}};
  const std::vector<OraclePolygon> walls{
      {{{0.9f, -3, -30}, {0.9f, -3, -0.5f}, {0.9f, 2, -0.5f}, {0.9f, 2, -30}}, true}};
  const DepthPyramid pyramid = pyramidOf(walls, view);
  const DepthBufferView buffer = pyramid.depthBuffer();
  occlusion::PixelBox image;
  occlusion::projectBoxes(scene::PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height,
                          {&box, 1}, {&image, 1});
  ASSERT_EQ(image.place, occlusion::BoxPlace::kOnBuffer);
  int before_nearest = 0, pixels = 0;
  for (std::uint32_t y = image.y0; y <= image.y1; ++y) {
    for (std::uint32_t x = image.x0; x <= image.x1; ++x, ++pixels) {
      before_nearest += buffer.at(x, y) > image.nearest ? 1 : 0;
    }
  }
  EXPECT_LT(before_nearest, pixels / 2);
  EXPECT_EQ(pyramid.classify(box), Visibility::kHidden);
}

TEST(DepthPyramid, ABoxIsComparedByItsOutlineNotByItsRectangle) {
  // Seen along a diagonal of the view, through a rhombus of a wall that its rectangle sticks out of.
  const Box box{{-2, -2, -6}, {2, 2, -5.9f}};
  View view = viewFrom({0, 0, 0}, {0, 0, -1});
  const double h = std::sqrt(0.5);
  view.right = {h, h, 0};
  view.up = {-h, h, 0};
  const std::vector<OraclePolygon> walls{wall(-2, 2, -2, 2, -5)};
  const DepthPyramid pyramid = pyramidOf(walls, view);
  EXPECT_FALSE(pyramid.depthBuffer().covered(70, 70)) << "within the rectangle, beside the wall";
  EXPECT_EQ(pyramid.classify(box), Visibility::kHidden);
  EXPECT_EQ(pyramid.classify({{-2.5f, -2, -6}, {2, 2, -5.9f}}), Visibility::kPartial);
}

TEST(DepthPyramid, NeverHidesABoxSeenThroughAGap) {
  for (const RasterSettings& size : kPyramidSizes) {
    forEachGap([&](std::span<const OraclePolygon> walls, const Box& box, const std::string& what) {
      EXPECT_NE(pyramidOf(walls, kLookingBack, size).classify(box), Visibility::kHidden)
          << what << ", buffer " << size.width << " x " << size.height;
    });
  }
}

TEST(DepthPyramid, WhatIsNotFiniteIsNotHidden) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<OraclePolygon> walls{wall(-50, 50, -50, 50, -5)};
  for (const Box& box : {Box{}, Box{{nan, 0, -9}, {1, 1, -8}}, Box{{0, 0, -9}, {1, inf, -8}},
                         Box{{-inf, -inf, -inf}, {inf, inf, inf}}}) {
    EXPECT_EQ(seenPast(walls, box), Visibility::kPartial);
  }
  // The eye is so far away that subtraction makes a box of one whose sides are the wrong way round.
  View far_away = kLookingBack;
  far_away.eye.y = 1e17;
  const std::vector<OraclePolygon> wide{wall(-1e17f, 1e17f, 0.9e17f, 1.1e17f, -1e15f)};
  EXPECT_NE(pyramidOf(wide, far_away).classify({{-1e17f, 3, -1e17f}, {1e17f, 2, 1e17f}}),
            Visibility::kHidden);
  View nowhere = kLookingBack;
  nowhere.eye.x = nan;
  EXPECT_NE(pyramidOf(walls, nowhere).classify({{-1, -1, -9}, {1, 1, -8}}), Visibility::kHidden);
}

TEST(DepthPyramid, BeforeItIsFinishedNothingOnTheMapIsHidden) {
  const Box behind{{-1, -1, -9}, {1, 1, -8}};
  const OccluderSet set = setOf(std::vector<OraclePolygon>{wall(-9, 9, -9, 9, -5)});
  DepthPyramid pyramid;
  EXPECT_NE(pyramid.classify(behind), Visibility::kHidden);
  pyramid.begin(kLookingBack);
  EXPECT_NE(pyramid.classify(behind), Visibility::kHidden);
  pyramid.draw(set, all(set));
  EXPECT_NE(pyramid.classify(behind), Visibility::kHidden);
  EXPECT_EQ(pyramid.levels(), 0u);
  pyramid.finish();
  EXPECT_EQ(pyramid.classify(behind), Visibility::kHidden);
  EXPECT_EQ(pyramid.levels(), 3u);
  EXPECT_EQ(pyramid.occluders().size(), 1u);
  pyramid.begin(kLookingBack);
  EXPECT_NE(pyramid.classify(behind), Visibility::kHidden);
}

TEST(DepthPyramid, SeesPointsThatNothingIsBefore) {
  const std::vector<OraclePolygon> walls{wall(-2, 2, -2, 2, -5)};
  const DepthPyramid pyramid = pyramidOf(walls, kLookingBack);
  const Vec3f points[] = {{0.01f, 0.01f, -4}, {3.1f, 0.01f, -6}, {0.01f, 0.01f, -6},
                          {0.01f, 0.01f, 4},  {90, 0.01f, -6},   {0.01f, 0.01f, -2e4f}};
  std::uint8_t seen[std::size(points)] = {};
  pyramid.seesPoints(points, seen);
  EXPECT_EQ(seen[0], 1) << "before the wall";
  EXPECT_EQ(seen[1], 1) << "beside the wall";
  EXPECT_EQ(seen[2], 0) << "behind the wall";
  EXPECT_EQ(seen[3], 0) << "behind the eye";
  EXPECT_EQ(seen[4], 0) << "beside the view";
  EXPECT_EQ(seen[5], 0) << "beyond the far plane";
  DepthPyramid unfinished;
  unfinished.begin(kLookingBack);
  std::ranges::fill(seen, std::uint8_t{1});
  unfinished.seesPoints(points, seen);
  EXPECT_TRUE(std::ranges::all_of(seen, [](std::uint8_t s) { return s == 0; }));
}

// What a box is known by from earlier views saves time and changes no answer.
TEST(DepthPyramid, ABoxIsNotHiddenWhereAPointOfItIsSeen) {
  std::size_t points_seen = 0, found = 0, lost = 0, hidden = 0;
  for (const Family& family : kFamilies) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      RandomScene scene(family, seed);
      const DepthPyramid pyramid = pyramidOf(scene.polygons, scene.view);
      std::vector<Box> boxes;
      std::vector<Vec3f> points;
      for (int i = 0; i < 150; ++i) {
        boxes.push_back(scene.randomBox());
        const Box& box = boxes.back();
        Vec3f point;
        for (int axis = 0; axis < 3; ++axis) {
          const double t = scene.random.in(0.0, 1.0);
          point[axis] =
              static_cast<float>(box.min[axis] + t * (static_cast<double>(box.max[axis]) - box.min[axis]));
        }
        points.push_back(max(box.min, min(point, box.max)));
      }
      std::vector<BoxAnswer> answers(boxes.size()), known(boxes.size());
      std::vector<std::uint8_t> seen(boxes.size());
      pyramid.classify(boxes, answers);
      pyramid.seesPoints(points, seen);
      std::vector<Vec3f> updated = points;
      pyramid.classify(boxes, known, {.not_hidden = seen, .seen_points = updated});
      std::vector<std::uint8_t> seen_now(boxes.size());
      pyramid.seesPoints(updated, seen_now);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const bool is_hidden = answers[i].visibility == Visibility::kHidden;
        EXPECT_FALSE(is_hidden && seen[i] != 0) << family.name << ", seed " << seed << ", box " << i;
        EXPECT_EQ(known[i].visibility, answers[i].visibility) << family.name << ", seed " << seed;
        EXPECT_TRUE(contains(boxes[i], Box{updated[i], updated[i]})) << family.name << ", seed " << seed;
        EXPECT_TRUE(!is_hidden || updated[i] == points[i]) << family.name << ", seed " << seed;
        points_seen += seen[i];
        hidden += is_hidden ? 1 : 0;
        if (answers[i].visibility == Visibility::kPartial && seen[i] == 0) {
          ++(seen_now[i] != 0 ? found : lost);
        }
      }
    }
  }
  EXPECT_GT(points_seen, 1000u);
  EXPECT_GT(hidden, 1000u);
  EXPECT_GT(found, lost) << "points that are remembered are those that are seen";
}

TEST(DepthPyramid, TheVolumeAloneHidesNothingWithinIt) {
  const std::vector<OraclePolygon> walls{wall(-9, 9, -9, 9, -5)};
  const DepthPyramid pyramid = pyramidOf(walls, kLookingBack);
  const Box boxes[] = {{{-1, -1, -9}, {1, 1, -8}},
                       {{-1, -1, 3}, {1, 1, 4}},
                       {{-1, -1, -1}, {1, 1, 1}},
                       {{-20, -1, -9}, {1, 1, -8}}};
  BoxAnswer answers[4];
  pyramid.classifyInView(boxes, answers);
  EXPECT_TRUE(same(answers[0], {Visibility::kVisible, true}));
  EXPECT_TRUE(same(answers[1], {Visibility::kHidden, false}));
  EXPECT_TRUE(same(answers[2], {Visibility::kPartial, false}));
  EXPECT_TRUE(same(answers[3], {Visibility::kVisible, false}));
}

class DepthPyramidFamilies : public ::testing::TestWithParam<Family> {};

TEST_P(DepthPyramidFamilies, NothingThatARayReachesIsHidden) {
  int hidden = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    RandomScene scene(GetParam(), seed);
    const DepthPyramid pyramid = pyramidOf(scene.polygons, scene.view, kPyramidSizes[seed % 3]);
    for (int b = 0; b < 30; ++b) {
      const Box box = scene.randomBox();
      const Visibility state = pyramid.classify(box);
      if (state != Visibility::kHidden) {
        continue;
      }
      BoxAnswer in_view;
      pyramid.classifyInView({&box, 1}, {&in_view, 1});
      hidden += in_view.visibility == Visibility::kHidden ? 0 : 1;
      const Sight sight = lookAt(box, scene.view, scene.polygons, 300, scene.random.engine());
      EXPECT_FALSE(sight.seen) << GetParam().name << ", seed " << seed << ", box " << b;
    }
  }
  EXPECT_GT(hidden, 20) << "by the depth buffer";
}

TEST_P(DepthPyramidFamilies, NothingIsBeforeABoxThatIsVisible) {
  int visible = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RandomScene scene(GetParam(), seed);
    const DepthPyramid pyramid = pyramidOf(scene.polygons, scene.view);
    for (int b = 0; b < 30; ++b) {
      const Box box = scene.randomBox();
      BoxAnswer answer;
      pyramid.classify({&box, 1}, {&answer, 1});
      if (answer.visibility != Visibility::kVisible || !answer.within_view) {
        continue;
      }
      ++visible;
      // The buffer in its centre's pixel is not nearer than its centre.
      const DepthBufferView buffer = pyramid.depthBuffer();
      const scene::PixelView view(scene.view, buffer.width, buffer.height);
      const Vec3d camera = view.toCamera(center(box) - view.eye);
      const double x = std::clamp(view.pixelX(camera), 0.0, buffer.width - 1.0);
      const double y = std::clamp(view.pixelY(camera), 0.0, buffer.height - 1.0);
      EXPECT_LE(buffer.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)),
                view.reciprocalDepth(camera.z))
          << GetParam().name << ", seed " << seed;
    }
  }
  EXPECT_GT(visible, 5);
}

INSTANTIATE_TEST_SUITE_P(Scales, DepthPyramidFamilies, ::testing::ValuesIn(kFamilies),
                         [](const auto& param) { return "Family" + std::to_string(param.index); });

TEST(DepthPyramid, ThreadsInstructionSetsAndBatchesChangeNothing) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  const ParallelFor backwards = [](std::uint32_t count, const RangeBody& body) {
    for (std::uint32_t i = count; i > 0; --i) {
      body(i - 1, i);
    }
  };
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    RandomScene scene(kFamilies[0], seed);
    const OccluderSet set = setOf(scene.polygons);
    std::vector<Box> boxes;
    for (std::uint64_t i = 0; i < 100 + seed; ++i) {
      boxes.push_back(scene.randomBox());
    }
    std::vector<BoxAnswer> first(boxes.size()), answers(boxes.size());
    DepthPyramid pyramid;
    pyramid.build(scene.view, set, all(set));
    pyramid.classify(boxes, first);
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      pyramid.build(scene.view, set, all(set), backwards);
      pyramid.classify(boxes, answers);
      EXPECT_TRUE(std::ranges::equal(first, answers, same)) << hwy::TargetName(target) << ", seed " << seed;
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(pyramid.classify(boxes[i]), first[i].visibility) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace sightline
