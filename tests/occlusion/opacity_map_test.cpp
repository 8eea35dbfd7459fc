#include "sightline/occlusion/opacity_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sightline/comparison/centre_coverage.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/occlusion/synthetic_buffers.h"

namespace sightline {
namespace {

using namespace test;
using occlusion::BoxPlace;

OpacityMapSettings sized(std::uint32_t width, std::uint32_t height) {
  OpacityMapSettings settings;
  settings.raster.width = width;
  settings.raster.height = height;
  return settings;
}

// Two maps that compare depths in different ways. The test fails if their answers differ.
class AllComparisons {
 public:
  explicit AllComparisons(OpacityMapSettings settings)
      : sparse_(settings),
        pixelwise_(comparing(DepthComparison::kPixelwise, settings)),
        always_(comparing(DepthComparison::kSparseAlways, settings)) {}

  void build(const View& view, const OccluderSet& set) {
    sparse_.build(view, set, all(set));
    pixelwise_.build(view, set, all(set));
    always_.build(view, set, all(set));
  }
  Visibility classify(const Box& box) {
    const Visibility state = sparse_.classify(box);
    EXPECT_EQ(state, pixelwise_.classify(box));
    EXPECT_EQ(state, always_.classify(box));
    return state;
  }
  OpacityMap& sparse() { return sparse_; }

 private:
  static OpacityMapSettings comparing(DepthComparison depth, OpacityMapSettings settings) {
    settings.depth = depth;
    return settings;
  }
  OpacityMap sparse_, pixelwise_, always_;
};

Visibility ask(const View& view, std::span<const OraclePolygon> polygons, const Box& box,
               const OpacityMapSettings& settings = {}) {
  AllComparisons maps(settings);
  const OccluderSet set = setOf(polygons);
  maps.build(view, set);
  return maps.classify(box);
}

const Box kBehind{{-1, -1, -12}, {1, 1, -10}};  // hidden by any wall(-1, 1, -1, 1, -5)

TEST(OpacityMap, TellsHiddenPartialAndVisible) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5)};
  EXPECT_EQ(ask(kLookingBack, walls, kBehind), Visibility::kHidden);
  EXPECT_EQ(ask(kLookingBack, walls, {{-0.3f, -0.3f, -4}, {0.3f, 0.3f, -3}}), Visibility::kPartial);
  EXPECT_EQ(ask(kLookingBack, walls, {{-3, -1, -12}, {1, 1, -10}}), Visibility::kPartial);
  EXPECT_EQ(ask(kLookingBack, walls, {{5, -1, -12}, {6, 1, -10}}), Visibility::kVisible);
  // This box is outside of the buffer.
  EXPECT_EQ(ask(kLookingBack, walls, {{25, -1, -12}, {26, 1, -10}}), Visibility::kHidden);
}

TEST(OpacityMap, FusesWallsThatShareNoEdge) {
  const std::vector<OraclePolygon> walls{wall(-2, 0.3f, -4, 4, -4), wall(0, 5, -8, 8, -6)};
  EXPECT_EQ(ask(kLookingBack, walls, kBehind), Visibility::kHidden);
}

TEST(OpacityMap, TellsBehindFromBeforeAndTouching) {
  const std::vector<OraclePolygon> walls{wall(-4, 4, -4, 4, -5)};
  EXPECT_NE(ask(kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5}}), Visibility::kHidden);
  EXPECT_NE(ask(kLookingBack, walls, {{-1, -1, -6}, {1, 1, -4.999f}}), Visibility::kHidden);
  EXPECT_EQ(ask(kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5.001f}}), Visibility::kHidden);
}

TEST(OpacityMap, ABoxBeforeASmallPartOfTheCoverIsNotHidden) {
  // The farther wall is seen through a gap of the nearer one, and the box stands between them.
  const std::vector<OraclePolygon> walls{wall(-9, 1, -9, 9, -5), wall(2, 9, -9, 9, -5),
                                         wall(-9, 20, -20, 20, -15)};
  const Box between{{-8, -2, -8}, {8, 2, -7}}, behind{{-8, -2, -18}, {8, 2, -17}};
  EXPECT_NE(ask(kLookingBack, walls, between), Visibility::kHidden);
  EXPECT_EQ(ask(kLookingBack, walls, behind), Visibility::kHidden);
  // As seen from the eye, this box is beside the gap.
  EXPECT_EQ(ask(kLookingBack, walls, {{-8, -2, -8}, {1, 2, -7}}), Visibility::kHidden);
}

TEST(OpacityMap, NeverHidesABoxSeenThroughAGap) {
  for (const OpacityMapSettings& settings : {sized(16, 16), sized(320, 180), sized(640, 640)}) {
    AllComparisons maps(settings);
    forEachGap([&](std::span<const OraclePolygon> walls, const Box& box, const std::string& what) {
      const OccluderSet set = setOf(walls);
      maps.build(kLookingBack, set);
      EXPECT_NE(maps.classify(box), Visibility::kHidden) << settings.raster.width << ": " << what;
    });
  }
}

TEST(OpacityMap, ThePapersCoverageHidesWhatIsSeenThroughAGap) {
  OpacityMapSettings settings = sized(128, 128);
  settings.raster.coverage = centreCoverage();
  int hidden = 0;
  forEachGap([&](std::span<const OraclePolygon> walls, const Box& box, const std::string&) {
    hidden += ask(kLookingBack, walls, box, settings) == Visibility::kHidden ? 1 : 0;
  });
  EXPECT_GT(hidden, 10);
}

TEST(OpacityMap, BoxesThatReachTheNearPlaneAreNotHidden) {
  const std::vector<OraclePolygon> walls{wall(-9, 9, -9, 9, -5)};
  View view = kLookingBack;
  view.z_near = 4.0;
  for (const float z : {-3.9f, -4.0f, 1.0f}) {
    EXPECT_NE(ask(view, walls, {{-1, -1, -12}, {1, 1, z}}), Visibility::kHidden) << z;
  }
}

TEST(OpacityMap, BoxesAndEyesThatAreNotFiniteSeeEverything) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<OraclePolygon> walls{wall(-9, 9, -9, 9, -5)};
  for (const Box& box : {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{-1, -1, -inf}, {1, 1, -10}}}) {
    EXPECT_NE(ask(kLookingBack, walls, box), Visibility::kHidden);
  }
  EXPECT_NE(ask(viewFrom({nan, 0, 0}, {0, 0, -1}), walls, kBehind), Visibility::kHidden);
}

TEST(OpacityMap, NothingIsHiddenBeforeTheMapIsFinished) {
  const OccluderSet set = setOf({{wall(-4, 4, -4, 4, -5)}});
  OpacityMap map;
  EXPECT_EQ(map.classify(kBehind), Visibility::kVisible);
  map.begin(kLookingBack);
  EXPECT_EQ(map.classify(kBehind), Visibility::kVisible);
  map.draw(set, all(set));
  EXPECT_EQ(map.classify(kBehind), Visibility::kVisible);
  map.finish();
  EXPECT_EQ(map.classify(kBehind), Visibility::kHidden);
  map.begin(kLookingBack);
  map.finish();
  EXPECT_EQ(map.classify(kBehind), Visibility::kVisible);  // of another, empty one
}

TEST(OpacityMap, SetsDrawnOneAfterTheOtherHideTogether) {
  const OccluderSet left = setOf({{wall(-4, 0.1f, -4, 4, -5)}}), right = setOf({{wall(-0.1f, 4, -4, 4, -6)}});
  OpacityMap map;
  map.build(kLookingBack, left, all(left));
  EXPECT_NE(map.classify(kBehind), Visibility::kHidden);
  map.draw(right, all(right));
  map.finish();
  EXPECT_EQ(map.classify(kBehind), Visibility::kHidden);
  EXPECT_EQ(map.stats().raster.occluders, 2u);
  EXPECT_EQ(map.occluders().size(), 2u);
}

// Walls that leave a square hole of some width (metres, at 5 metres). In a buffer of 100 x 100 pixels a pixel
// is 0.1 metres there. The hole's borders lie on those of pixels, but for rounding.
std::vector<OraclePolygon> wallsAroundAHole(float width) {
  return {wall(-9, 0, -9, 9, -5), wall(width, 9, -9, 9, -5), wall(-9, 9, -9, 0, -6),
          wall(-9, 9, 1.2f * width, 9, -6)};
}

TEST(OpacityMap, ToleranceOverlooksSmallHolesOnly) {
  const std::vector<OraclePolygon> polygons = wallsAroundAHole(0.2f);
  const OccluderSet set = setOf(polygons);
  OpacityMapSettings settings = sized(100, 100);
  OpacityMap map(settings);
  map.build(kLookingBack, set, all(set));
  const std::uint32_t uncovered = 100 * 100 - coveredByCounting(map.depthBuffer(), rectangle(0, 0, 99, 99));
  ASSERT_GE(uncovered, 4u);
  ASSERT_LE(uncovered, 16u);  // a pixel more on each side, where rounding leaves a gap
  for (const std::uint32_t tolerance : {0u, uncovered - 1, uncovered, uncovered + 1}) {
    settings.tolerance = tolerance;
    EXPECT_EQ(ask(kLookingBack, polygons, kBehind, settings),
              tolerance < uncovered ? Visibility::kPartial : Visibility::kHidden)
        << tolerance;
  }
  // Before the wall it stays unhidden, and where nothing covers it tolerance does not count.
  settings.tolerance = 100 * 100;
  EXPECT_EQ(ask(kLookingBack, polygons, {{-1, -1, -4}, {1, 1, -3}}, settings), Visibility::kPartial);
  EXPECT_EQ(ask(kLookingBack, {}, kBehind, settings), Visibility::kVisible);
}

TEST(OpacityMap, TheCoverageRatioGivesUpBoxesThatAreHardlyCovered) {
  // The wall covers about a tenth of what the box's nearest face does.
  const std::vector<OraclePolygon> walls{wall(-0.5f, 0.5f, -2, 2, -5)};
  const Box wide{{-10, -3, -12}, {10, 3, -10}};
  OpacityMapSettings settings;
  EXPECT_EQ(ask(kLookingBack, walls, wide, settings), Visibility::kVisible);
  settings.coverage_ratio = 0.05;
  EXPECT_EQ(ask(kLookingBack, walls, wide, settings), Visibility::kPartial);
  settings.coverage_ratio = 0.0;
  const OccluderSet set = setOf(walls);
  OpacityMap map(settings);
  map.build(kLookingBack, set, all(set));
  for (const double ratio : {0.0, 0.2, 0.05, 1.0}) {
    map.setCoverageRatio(ratio);
    EXPECT_EQ(map.classify(wide), ratio < 0.1 ? Visibility::kPartial : Visibility::kVisible) << ratio;
    EXPECT_EQ(map.classify({{-0.5f, -1, -12}, {0.5f, 1, -10}}), Visibility::kHidden) << ratio;
  }
}

TEST(OpacityMap, StatsCountTestsUntilTheNextMap) {
  const OccluderSet set = setOf({{wall(-1, 1, -1, 1, -5)}});
  OpacityMapSettings settings = sized(100, 100);
  settings.depth = DepthComparison::kPixelwise;
  OpacityMap map(settings);
  for (int frame = 0; frame < 2; ++frame) {
    map.build(kLookingBack, set, all(set));
    map.classify({{-0.3f, -0.3f, -12}, {0.3f, 0.3f, -10}});  // hidden
    map.classify({{-0.2f, -0.2f, -4}, {0.2f, 0.2f, -3}});    // before the wall
    map.classify({{-3, -1, -12}, {1, 1, -10}});              // half covered
    map.classify({{-10, -9, -12}, {10, 9, -10}});            // hardly covered
    map.classify({{5, -1, -12}, {6, 1, -10}});               // not covered
    map.classify({{55, -1, -12}, {56, 1, -10}});             // off the buffer: no test
    EXPECT_EQ(map.stats().raster.occluders, 1u);
    EXPECT_EQ(map.stats().overlap_tests, 5u);
    EXPECT_EQ(map.stats().overlap_failed, 3u);
    EXPECT_EQ(map.stats().given_up, 1u);
    EXPECT_EQ(map.stats().depth_tests, 2u);
    EXPECT_GT(map.stats().depths_compared, 2u);
    EXPECT_EQ(map.stats().sparse_rows, 0u);
  }
  map.build(kLookingBack, set, all(set));
  EXPECT_EQ(map.stats().overlap_tests, 0u);
  EXPECT_EQ(map.stats().depths_compared, 0u);
}

TEST(OpacityMap, TheSparseDepthMapComparesFewerPixels) {
  const OccluderSet set = setOf({{wall(-9, 9, -9, 9, -5)}});
  OpacityMapSettings settings;
  OpacityMap sparse(settings);
  settings.depth = DepthComparison::kPixelwise;
  OpacityMap pixelwise(settings);
  for (OpacityMap* map : {&sparse, &pixelwise}) {
    map->build(kLookingBack, set, all(set));
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(map->classify({{-9, -9, -12}, {9, 9, -11}}), Visibility::kHidden);
    }
  }
  EXPECT_GT(sparse.stats().sparse_rows, 0u);
  EXPECT_LT(sparse.stats().depths_compared, pixelwise.stats().depths_compared / 5);
}

// Computes the answer from the buffer pixel by pixel, for the default settings.
Visibility byScanning(const OpacityMap& map, const View& view, const Box& box) {
  const DepthBufferView pixels = map.depthBuffer();
  PixelBox image;
  occlusion::projectBoxes(scene::PixelView(view, pixels.width, pixels.height), pixels.width, pixels.height,
                          {&box, 1}, {&image, 1});
  if (image.place != BoxPlace::kOnBuffer) {
    return image.place == BoxPlace::kOutside ? Visibility::kHidden : Visibility::kPartial;
  }
  const std::uint32_t covered = coveredByCounting(pixels, image);
  const std::uint32_t area = (image.x1 - image.x0 + 1u) * (image.y1 - image.y0 + 1u);
  if (covered < area) {
    return covered < 0.2 * area ? Visibility::kVisible : Visibility::kPartial;
  }
  return allNearerByScanning(pixels, image) ? Visibility::kHidden : Visibility::kPartial;
}

class OpacityMapFamilies : public ::testing::TestWithParam<Family> {};

TEST_P(OpacityMapFamilies, NothingThatARayReachesIsHidden) {
  int hidden = 0;  // by the buffer, not for being off it
  // Square pixels, and such that are not.
  AllComparisons square(sized(160, 160)), flat(sized(97, 31));
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    RandomScene scene(GetParam(), seed);
    const OccluderSet set = setOf(scene.polygons);
    for (AllComparisons* maps : {&square, &flat}) {
      maps->build(scene.view, set);
      for (int i = 0; i < 100; ++i) {
        const Box box = scene.randomBox();
        const std::uint32_t tests = maps->sparse().stats().overlap_tests;
        const Visibility state = maps->classify(box);
        EXPECT_EQ(state, byScanning(maps->sparse(), scene.view, box)) << "seed " << seed << " box " << i;
        if (state == Visibility::kHidden) {
          hidden += maps->sparse().stats().overlap_tests != tests ? 1 : 0;
          EXPECT_FALSE(lookAt(box, scene.view, scene.polygons, 200, scene.random.engine()).seen)
              << GetParam().name << " seed " << seed << " box " << i;
        }
      }
    }
  }
  EXPECT_GT(hidden, 50) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(Scales, OpacityMapFamilies, ::testing::ValuesIn(kFamilies),
                         [](const auto& param) { return "Family" + std::to_string(param.index); });

TEST(OpacityMap, ALargerMapSeesThroughNoWallThatASmallerOneCloses) {
  // Small boxes behind random walls: with more pixels more of them are hidden, never many fewer.
  int few = 0, many = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    RandomScene scene(kFamilies[0], seed);
    const OccluderSet set = setOf(scene.polygons);
    OpacityMap small(sized(64, 64)), large(sized(512, 512));
    small.build(scene.view, set, all(set));
    large.build(scene.view, set, all(set));
    for (int i = 0; i < 200; ++i) {
      const Box box = scene.randomBox();
      few += small.classify(box) == Visibility::kHidden ? 1 : 0;
      many += large.classify(box) == Visibility::kHidden ? 1 : 0;
    }
  }
  EXPECT_GT(many, few);
}

}  // namespace
}  // namespace sightline
