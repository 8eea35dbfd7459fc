#include "src/layers/extents/extent_scan.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <limits>
#include <numeric>

#include "tests/support/instruction_sets.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using shapes::Random;

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

Interval randomInterval(Random& random, bool angular) {
  // Uses coarse numbers, so that intervals often just touch.
  const auto coarse = [&](double from, double to) {
    return static_cast<float>(std::round(random.number(from, to) * 4) / 4);
  };
  if (angular) {
    const float low = coarse(-2, 2);
    return random.below(10) == 0 ? Interval{-2, 2} : Interval{low, low + coarse(0, 4)};
  }
  const float low = random.below(10) == 0 ? -kFloatInfinity : coarse(-3, 3);
  const float high = random.below(10) == 0 ? kFloatInfinity : std::max(low, coarse(-3, 3));
  return {low, high};
}

Extent randomExtent(Random& random, const ExtentTable& table) {
  Extent extent{};
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    extent[axis] = randomInterval(random, table.angular(axis));
  }
  return extent;
}

ExtentTable randomTable(Random& random) {
  ExtentTable table;
  table.parts = random.below(300);
  const std::size_t axes = 1 + random.below(random.below(5) == 0 ? kMaxExtentAxes : 4);
  const std::size_t padded = (table.parts + 15) / 16 * 16;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    table.kinds.push_back(random.below(2) == 0 ? ExtentAxis::Kind::kAngular : ExtentAxis::Kind::kSpatial);
    table.lows.emplace_back(padded, std::nanf(""));
    table.highs.emplace_back(padded, std::nanf(""));
    for (std::size_t part = 0; part < table.parts; ++part) {
      const Interval own = randomInterval(random, table.angular(axis));
      table.lows[axis][part] = own.low;
      table.highs[axis][part] = own.high;
    }
  }
  return table;
}

std::vector<std::uint32_t> shuffledParts(Random& random, std::size_t count) {
  std::vector<std::uint32_t> parts(count);
  std::iota(parts.begin(), parts.end(), 0u);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(parts[i - 1], parts[random.below(static_cast<std::uint32_t>(i))]);
  }
  return parts;
}

TEST(ExtentScan, FindsWhatComparingOneByOneFindsOnEveryInstructionSet) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_FALSE(targets.empty());
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const ExtentTable table = randomTable(random);
    ExtentScan scan;
    scan.beginFrame(table, shuffledParts(random, table.parts));
    std::vector<bool> active(table.parts, true);
    for (int round = 0; round < 6; ++round) {
      for (std::size_t i = 0; round > 0 && i < table.parts; ++i) {
        if (random.below(3) == 0) {
          active[i] = random.below(2) == 0;
          scan.setActive(static_cast<std::uint32_t>(i), active[i]);
        }
      }
      const Extent query = randomExtent(random, table);
      std::vector<std::uint32_t> expected{77};
      for (std::uint32_t part = 0; part < table.parts; ++part) {
        if (active[part] && overlaps(table, query, part)) {
          expected.push_back(part);
        }
      }
      found += expected.size() - 1;
      for (const std::int64_t target : targets) {
        const test::ForcedInstructionSet forced(target);
        std::vector<std::uint32_t> parts{77};  // query() must append
        scan.query(query, parts);
        EXPECT_EQ(parts, expected) << hwy::TargetName(target) << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(found, 1000u);
}

// Returns narrow intervals of numbers of any magnitude: near the smallest and the greatest float, all equal,
// or close together and far from zero.
ExtentTable fineTable(Random& random, std::size_t parts) {
  ExtentTable table;
  table.parts = parts;
  table.kinds = {ExtentAxis::Kind::kAngular, ExtentAxis::Kind::kSpatial, ExtentAxis::Kind::kSpatial};
  const double sizes[] = {1.0, 1e-43, 3e38, 0.0, 1e-3}, offsets[] = {0.0, 0.0, 0.0, 7.0, 1e4};
  for (const ExtentAxis::Kind kind : table.kinds) {
    const bool angular = kind == ExtentAxis::Kind::kAngular;
    const std::uint32_t form = random.below(5);
    const double size = angular ? 2.0 : sizes[form], offset = angular ? 0.0 : offsets[form];
    std::vector<float>&lows = table.lows.emplace_back(), &highs = table.highs.emplace_back();
    for (std::size_t part = 0; part < parts; ++part) {
      lows.push_back(static_cast<float>(offset + size * random.number(-1, 1)));
      highs.push_back(std::max(lows.back(), static_cast<float>(lows.back() + size * random.number(0, 0.1))));
    }
  }
  return table;
}

// More than 64 * 64 parts, so that there are three levels of rows.
TEST(ExtentScan, FindsWhatComparingOneByOneFindsThroughThreeLevels) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const ExtentTable table = fineTable(random, 4096 + random.below(3) * 1000);
    ExtentScan scan;
    scan.beginFrame(table, shuffledParts(random, table.parts));
    for (int round = 0; round < 20; ++round) {
      Extent query{};
      for (std::size_t axis = 0; axis < table.axes(); ++axis) {
        query[axis] = table.at(axis, random.below(static_cast<std::uint32_t>(table.parts)));
      }
      std::vector<std::uint32_t> expected;
      for (std::uint32_t part = 0; part < table.parts; ++part) {
        if (overlaps(table, query, part)) {
          expected.push_back(part);
        }
      }
      found += expected.size();
      for (const std::int64_t target : targets) {
        const test::ForcedInstructionSet forced(target);
        std::vector<std::uint32_t> parts;
        scan.query(query, parts);
        EXPECT_EQ(parts, expected) << hwy::TargetName(target) << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(found, 1000u);
}

TEST(ExtentScan, BeginsWithAllListedPartsActiveAndFindsNoOthers) {
  ExtentTable table;
  table.kinds = {ExtentAxis::Kind::kSpatial};
  table.parts = 64;
  table.lows = {std::vector<float>(64, 0.0f)};
  table.highs = {std::vector<float>(64, 1.0f)};
  ExtentScan scan;
  Random random(1);
  const std::vector<std::uint32_t> all = shuffledParts(random, 64);
  scan.beginFrame(table, all);
  scan.setActive(63, false);
  Extent query{};
  query[0] = {1.0f, 2.0f};  // touches the part
  std::vector<std::uint32_t> parts;
  scan.query(query, parts);
  EXPECT_EQ(parts.size(), 63u);
  scan.beginFrame(table, all);
  parts.clear();
  scan.query(query, parts);
  EXPECT_EQ(parts.size(), 64u);
  scan.beginFrame(table, std::vector<std::uint32_t>{40, 7, 12});
  scan.setActive(50, true);  // part 50 is not in the order
  parts.clear();
  scan.query(query, parts);
  EXPECT_EQ(parts, (std::vector<std::uint32_t>{7, 12, 40}));
}

TEST(ExtentScan, ComparesOnlyBlocksWhoseUnionOverlapsAndThatHoldActiveParts) {
  constexpr std::size_t kFanOut = ScanRows::kFanOut;
  // The parts lie one behind the other along an axis.
  ExtentTable table;
  table.parts = kFanOut * kFanOut;
  table.kinds = {ExtentAxis::Kind::kSpatial};
  table.lows.resize(1);
  table.highs.resize(1);
  std::vector<std::uint32_t> order(table.parts);
  for (std::size_t part = 0; part < table.parts; ++part) {
    order[part] = static_cast<std::uint32_t>(part);
    table.lows[0].push_back(static_cast<float>(part));
    table.highs[0].push_back(static_cast<float>(part) + 0.5f);
  }
  ExtentScan scan;
  scan.beginFrame(table, order);
  const auto blocksOf = [&](const Interval& interval, std::size_t answers) {
    const std::uint64_t before = scan.blocksCompared();
    std::vector<std::uint32_t> found;
    Extent query{};
    query[0] = interval;
    scan.query(query, found);
    EXPECT_EQ(found.size(), answers);
    return scan.blocksCompared() - before;
  };
  // A query compares one block of united rows and the block of the answer, or two if its cell crosses a
  // border.
  EXPECT_LE(blocksOf({1000.0f, 1000.4f}, 1), 3u);
  EXPECT_EQ(blocksOf({-kFloatInfinity, kFloatInfinity}, table.parts), 1 + kFanOut);
  for (std::uint32_t part = 0; part + kFanOut < table.parts; ++part) {
    scan.setActive(part, false);
  }
  EXPECT_EQ(blocksOf({-kFloatInfinity, kFloatInfinity}, kFanOut), 2u);
}

}  // namespace
}  // namespace sightline::layers
