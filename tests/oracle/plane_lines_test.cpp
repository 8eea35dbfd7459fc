#include "oracle/plane_lines.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "oracle/split_mix.h"

namespace sightline {
namespace {

// Upright segments: `from` at x = 0, blockers beyond it, `to` at x = 10.
Gate upright(double x, double low, double high) {
  return {{x, high}, {x, low}};
}

struct Search {
  Gate from = upright(0, -1, 1), to = upright(10, -1, 1);
  std::vector<Gate> blockers;
  PlaneLine found{};

  bool run() {
    PlaneLines lines;
    return lines.search(from, to, blockers, 100000, [&](const PlaneLine& line) {
      found = line;
      return true;
    });
  }
  bool isFree(const PlaneLine& line) const {
    return line.crosses(from) && line.crosses(to) &&
           std::none_of(blockers.begin(), blockers.end(),
                        [&](const Gate& gate) { return line.crosses(gate); });
  }
};

TEST(PlaneLines, FindsALineThroughThreeNarrowGapsInARow) {
  Search search;
  for (const double x : {2.0, 5.0, 7.0}) {
    const double gap = 0.3 + 0.01 * x;
    search.blockers.push_back(upright(x, -100, gap));
    search.blockers.push_back(upright(x, gap + 1e-7, 100));
  }
  ASSERT_TRUE(search.run());
  EXPECT_TRUE(search.isFree(search.found));
}

TEST(PlaneLines, FindsNothingPastGapsThatAreNotInARow) {
  Search search;
  const auto addGap = [&](double x, double y) {
    search.blockers.push_back(upright(x, -100, y));
    search.blockers.push_back(upright(x, y + 1e-7, 100));
  };
  addGap(2, 0.3);
  addGap(5, 0.3 + 1e-6);
  EXPECT_TRUE(search.run());
  addGap(7, 0.3);
  EXPECT_FALSE(search.run());
}

TEST(PlaneLines, SegmentsThatTouchLeaveNoGap) {
  Search search;
  for (int i = -20; i < 20; ++i) {
    search.blockers.push_back(upright(3, 0.1 * i, 0.1 * (i + 1)));
  }
  EXPECT_FALSE(search.run());
}

TEST(PlaneLines, SegmentsBehindTheTargetOrTurnedAwayBlockNothing) {
  Search search;
  search.blockers = {upright(-1, -100, 100), upright(11, -100, 100), {{5, -100}, {5, 100}}};
  EXPECT_TRUE(search.run());
}

// A free line exists where random lines find one, and what is found is free.
TEST(PlaneLines, FindsALineWheneverRandomLinesDo) {
  int found_by_chance = 0, found = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SplitMix random{seed};
    Search search;
    for (int i = 0; i < 14; ++i) {
      const double x = random.in(1, 9), y = random.in(-1.5, 1), size = random.in(0.1, 1.5);
      search.blockers.push_back({{x + random.in(-0.5, 0.5), y + size}, {x, y}});
    }
    bool by_chance = false;
    for (int i = 0; i < 2000 && !by_chance; ++i) {
      const double y = random.in(-1, 1), slope = (random.in(-1, 1) - y) / 10;
      by_chance = search.isFree({slope, y});
    }
    const bool by_search = search.run();
    EXPECT_TRUE(by_search || !by_chance) << "seed " << seed;
    EXPECT_TRUE(!by_search || search.isFree(search.found)) << "seed " << seed;
    found_by_chance += by_chance ? 1 : 0;
    found += by_search ? 1 : 0;
  }
  EXPECT_GT(found_by_chance, 20);
  EXPECT_LT(found, 280);
}

}  // namespace
}  // namespace sightline
