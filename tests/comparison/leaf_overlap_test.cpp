#include "src/comparison/layers/leaf_overlap.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <vector>

#include "tests/comparison/made_extents.h"
#include "tests/support/instruction_sets.h"

namespace sightline::comparison {
namespace {

using namespace made;

OverlapTests testsOf(const ExtentTable& table, const Extent& query) {
  OverlapTests tests;
  tests.axes = static_cast<std::uint32_t>(table.axes());
  for (std::size_t axis = 0; axis < table.axes(); ++axis) {
    const Interval& own = query[axis];
    tests.along[axis].count = table.angular(axis) ? 3 : 1;
    tests.along[axis].tests = {own, Interval{own.low + 4.0f, own.high + 4.0f},
                               Interval{own.low - 4.0f, own.high - 4.0f}};
  }
  return tests;
}

TEST(LeafOverlap, IsThatOfThePairsOnEveryInstructionSet) {
  constexpr std::uint32_t kRows = 32;
  std::uint64_t found = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Random random(seed);
    const std::uint32_t count = 1 + pick(random, kRows);
    ExtentTable table = makeTable(count, kindsOf(1 + seed % 5, pick(random, 32)));
    scatter(table, random, 0.3f);
    std::vector<float> bounds(2 * kRows * table.axes(), 0.0f);  // rows beyond the count must be ignored
    for (std::size_t axis = 0; axis < table.axes(); ++axis) {
      for (std::uint32_t part = 0; part < count; ++part) {
        bounds[2 * kRows * axis + part] = table.lows[axis][part];
        bounds[2 * kRows * axis + kRows + part] = table.highs[axis][part];
      }
    }
    const Extent query = anyQuery(table, random, 0.3f);
    std::uint32_t expected = 0;
    for (std::uint32_t part = 0; part < count; ++part) {
      expected |= overlaps(table, query, part) ? 1u << part : 0u;
      found += overlaps(table, query, part);
    }
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      const std::uint32_t bits = overlapBits(testsOf(table, query), bounds.data(), kRows, count);
      EXPECT_EQ(bits, expected) << "seed " << seed << ", " << hwy::TargetName(target);
    }
  }
  EXPECT_GT(found, 1000u);
}

}  // namespace
}  // namespace sightline::comparison
