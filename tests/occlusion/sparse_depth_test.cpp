#include "src/occlusion/boxes/sparse_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "src/occlusion/boxes/summed_area.h"
#include "tests/occlusion/synthetic_buffers.h"

namespace sightline::occlusion {
namespace {

using namespace test;

// Queries the whole buffer until the peaks of all its rows have been computed.
void makeRows(SparseDepth& depth, const SyntheticMap& buffer) {
  const float nearest = -std::numeric_limits<float>::infinity();
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(depth.allNearer(rectangle(0, 0, buffer.width - 1, buffer.height - 1, nearest)))
        << buffer.name;
  }
}

// Returns a depth of the buffer, or one slightly nearer or farther.
float someDepth(std::mt19937_64& random, const SyntheticMap& buffer) {
  const float depth = buffer.view().at(static_cast<std::uint32_t>(random() % buffer.width),
                                       static_cast<std::uint32_t>(random() % buffer.height));
  if (random() % 20 == 0) {
    return random() % 2 == 0 ? std::numeric_limits<float>::infinity()
                             : std::numeric_limits<float>::quiet_NaN();
  }
  const float towards[] = {depth, -std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  return std::nextafter(depth, towards[random() % 3]);
}

TEST(SparseDepth, AnswersAsScanningAllPixelsDoes) {
  int nearer = 0, not_nearer = 0, used = 0;
  SparseDepth depth;
  for (const auto& size : kMapSizes) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      for (const SyntheticMap& buffer : syntheticMaps(size[0], size[1], seed)) {
        std::mt19937_64 random(seed);
        depth = SparseDepth();  // without a retest delay
        depth.begin(buffer.view());
        if (seed % 2 == 0) {
          makeRows(depth, buffer);
        }
        for (int i = 0; i < 300; ++i) {
          PixelBox rect = randomRectangle(random, buffer.width, buffer.height);
          rect.nearest = someDepth(random, buffer);
          const bool expected = allNearerByScanning(buffer.view(), rect);
          std::uint64_t compared = 0;
          ASSERT_EQ(depth.allNearer(rect), expected) << buffer.name << " seed " << seed << " rectangle " << i;
          ASSERT_EQ(allNearerPixelwise(buffer.view(), rect, compared), expected) << buffer.name << " " << i;
          (expected ? nearer : not_nearer) += 1;
        }
        used += depth.rowsUsed() > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(nearer, 5000);
  EXPECT_GT(not_nearer, 5000);
  EXPECT_GT(used, 50);
}

TEST(SparseDepth, UsedAlwaysItAnswersAsScanningAllPixelsDoes) {
  int rectangles = 0;
  for (const auto& size : kMapSizes) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SparseDepth depth(SparseDepth::Use::kAlways);  // also with a buffer after one of many peaks
      for (const SyntheticMap& buffer : syntheticMaps(size[0], size[1], seed)) {
        std::mt19937_64 random(seed);
        depth.begin(buffer.view());
        for (int i = 0; i < 300; ++i, ++rectangles) {
          PixelBox rect = randomRectangle(random, buffer.width, buffer.height);
          rect.nearest = someDepth(random, buffer);
          ASSERT_EQ(depth.allNearer(rect), allNearerByScanning(buffer.view(), rect))
              << buffer.name << " seed " << seed << " rectangle " << i;
        }
        EXPECT_GT(depth.rowsUsed(), 0u) << buffer.name;
      }
    }
  }
  EXPECT_GT(rectangles, 5000);
}

TEST(SparseDepth, UsedAlwaysItComparesThePeaksOfTheFirstRectangleHoweverNarrow) {
  const SyntheticMap flat("flat", 100, 3, [](std::uint32_t, std::uint32_t) { return 1.0f; });
  SparseDepth always(SparseDepth::Use::kAlways), where_paying;
  for (SparseDepth* depth : {&always, &where_paying}) {
    depth->begin(flat.view());
    EXPECT_TRUE(depth->allNearer(rectangle(10, 0, 19, 1, 0.5f)));
  }
  EXPECT_EQ(always.rowsUsed(), 2u);
  EXPECT_EQ(always.compared(), 2u * 2) << "the first pixel and the last one of each row";
  EXPECT_EQ(where_paying.rowsUsed(), 0u);
  EXPECT_EQ(where_paying.compared(), 2u * 10);
}

TEST(SparseDepth, EveryRectangleOfARowIsAnsweredRightAtEveryDepth) {
  // Tests all rectangles with all depths: peaks are at, next to and beyond both ends.
  for (const SyntheticMap& buffer : syntheticMaps(67, 1, 5)) {
    SparseDepth depth;
    depth.begin(buffer.view());
    makeRows(depth, buffer);
    for (std::uint32_t x0 = 0; x0 < buffer.width; ++x0) {
      for (std::uint32_t x1 = x0; x1 < buffer.width; ++x1) {
        for (std::uint32_t at = x0; at <= x1; at += 3) {
          const PixelBox rect = rectangle(x0, 0, x1, 0, std::nextafter(buffer.view().at(at, 0), -1e38f));
          ASSERT_EQ(depth.allNearer(rect), allNearerByScanning(buffer.view(), rect))
              << buffer.name << " " << x0 << " to " << x1 << " depth of " << at;
        }
      }
    }
  }
}

TEST(SparseDepth, TheLastPixelIsLookedAtWhereTheNextPeakLiesBeyondIt) {
  // Depth increases to the right up to pixel 90.
  const SyntheticMap buffer("valley", 100, 1, [](std::uint32_t x, std::uint32_t) {
    return -static_cast<float>(x <= 90 ? x : 180 - x);
  });
  SparseDepth depth;
  depth.begin(buffer.view());
  makeRows(depth, buffer);
  ASSERT_GT(depth.rowsUsed(), 0u);
  EXPECT_TRUE(depth.allNearer(rectangle(10, 0, 50, 0, -50.5f)));
  EXPECT_FALSE(depth.allNearer(rectangle(10, 0, 50, 0, -49.5f)));
  EXPECT_FALSE(depth.allNearer(rectangle(10, 0, 50, 0, -50.0f)));
}

TEST(SparseDepth, LooksAtFewPixels) {
  const auto comparedIn = [](const SyntheticMap& buffer) {
    SparseDepth depth;
    depth.begin(buffer.view());
    makeRows(depth, buffer);
    EXPECT_GT(depth.rowsUsed(), 0u) << buffer.name;
    const std::uint64_t before = depth.compared();
    EXPECT_TRUE(depth.allNearer(rectangle(0, 0, buffer.width - 1, buffer.height - 1, -1e30f)));
    return depth.compared() - before;
  };
  using U = std::uint32_t;
  EXPECT_EQ(comparedIn({"equal", 200, 3, [](U, U) { return 1.0f; }}), 2u * 3);
  EXPECT_EQ(comparedIn({"slope", 200, 3, [](U x, U) { return static_cast<float>(x); }}), 2u * 3);
  EXPECT_EQ(comparedIn({"other slope", 200, 3, [](U x, U) { return -static_cast<float>(x); }}), 2u * 3);
  // Three walls, equally far each: the farther one between them is a peak.
  EXPECT_EQ(comparedIn({"walls", 200, 1, [](U x, U) { return x / 70 == 1 ? 1.0f : 2.0f; }}), 3u);
  // Five teeth, of which four begin with a peak that is not the first pixel.
  EXPECT_EQ(comparedIn({"saw", 200, 1, [](U x, U) { return static_cast<float>(x % 40); }}), 6u);
  // Uncovered pixels are no peaks; what lies between two of them is one.
  EXPECT_EQ(comparedIn({"hole", 200, 1, [](U x, U) { return x == 100 ? kUncovered : 1.0f; }}), 2u);
  EXPECT_EQ(comparedIn({"holes", 200, 1, [](U x, U) { return x % 100 == 50 ? kUncovered : 1.0f; }}), 3u);
}

TEST(SparseDepth, UncoveredPixelsAreLeftOut) {
  const SyntheticMap buffer("hole", 60, 1,
                            [](std::uint32_t x, std::uint32_t) { return x == 30 ? kUncovered : 2.0f; });
  SparseDepth depth;
  depth.begin(buffer.view());
  for (const bool made : {false, true}) {
    EXPECT_TRUE(depth.allNearer(rectangle(5, 0, 50, 0, 1.0f))) << made;
    EXPECT_TRUE(depth.allNearer(rectangle(5, 0, 30, 0, 1.0f))) << made;
    EXPECT_TRUE(depth.allNearer(rectangle(30, 0, 30, 0, 9.0f))) << made;
    EXPECT_FALSE(depth.allNearer(rectangle(5, 0, 50, 0, 2.0f))) << made;
    makeRows(depth, buffer);
  }
}

TEST(SparseDepth, AMapOfPeaksIsComparedPixelByPixelAndTheNextOnesAreNotMade) {
  using U = std::uint32_t;
  const SyntheticMap rough("rough", 100, 2, [](U x, U) { return x % 2 == 0 ? 1.0f : 2.0f; });
  const SyntheticMap flat("flat", 100, 2, [](U, U) { return 1.0f; });
  const PixelBox rect = rectangle(3, 0, 92, 1, 0.5f);
  SparseDepth depth;
  depth.begin(rough.view());
  EXPECT_TRUE(depth.worthwhile());
  makeRows(depth, rough);
  EXPECT_EQ(depth.rowsUsed(), 0u);
  for (U frame = 0; frame < SparseDepth::kRetestDelay; ++frame) {
    depth.begin(flat.view());
    EXPECT_FALSE(depth.worthwhile()) << frame;
    makeRows(depth, flat);
    EXPECT_EQ(depth.rowsUsed(), 0u) << frame;
    const std::uint64_t before = depth.compared();
    EXPECT_TRUE(depth.allNearer(rect));
    EXPECT_EQ(depth.compared() - before, areaOf(rect));
  }
  for (int frame = 0; frame < 3; ++frame) {
    depth.begin(flat.view());
    EXPECT_TRUE(depth.worthwhile());
    EXPECT_EQ(depth.compared(), 0u);
    makeRows(depth, flat);
    EXPECT_GT(depth.rowsUsed(), 0u);
  }
}

TEST(SparseDepth, RoughRowsOfAMapDoNotSpoilItsOthers) {
  const SyntheticMap buffer("one rough row", 100, 10, [](std::uint32_t x, std::uint32_t y) {
    return y == 4 && x % 2 == 0 ? 2.0f : 1.0f;
  });
  SparseDepth depth;
  depth.begin(buffer.view());
  makeRows(depth, buffer);
  const std::uint64_t before = depth.compared();
  EXPECT_TRUE(depth.allNearer(rectangle(0, 0, 99, 9, 0.5f)));
  EXPECT_EQ(depth.compared() - before, 9u * 2 + 100);
  depth.begin(buffer.view());
  EXPECT_TRUE(depth.worthwhile());
}

TEST(SparseDepth, AFewQuestionsMakeNothing) {
  const SyntheticMap buffer("flat", 100, 1, [](std::uint32_t, std::uint32_t) { return 1.0f; });
  SparseDepth depth;
  depth.begin(buffer.view());
  EXPECT_TRUE(depth.allNearer(rectangle(0, 0, 99, 0, 0.5f)));
  EXPECT_EQ(depth.rowsUsed(), 0u);
  EXPECT_EQ(depth.compared(), 100u);
}

}  // namespace
}  // namespace sightline::occlusion
