#include "src/culling/adaptive_coverage.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace sightline::culling {
namespace {

// The times that culling takes and saves in a frame. A place is modelled by the times for each ratio.
struct Times {
  double culling_us = 0.0, saved_us = 0.0;
};
using Place = std::function<Times(double ratio)>;

// A larger ratio takes less time and saves less.
Place place(double culling_us, double saved_us) {
  return [=](double ratio) {
    return Times{culling_us * (1.0 - 0.5 * ratio), saved_us * (1.0 - 0.5 * ratio)};
  };
}
const Place kDense = place(200.0, 2000.0), kOpen = place(200.0, 10.0);

struct Setting {
  double ratio = 0.0;
  bool suspended = false;
  friend bool operator==(const Setting&, const Setting&) = default;
};

// Spends this many frames in a place, and returns the settings of each.
std::vector<Setting> walk(AdaptiveCoverage& adaptive, const Place& place, int frames) {
  std::vector<Setting> settings;
  for (int i = 0; i < frames; ++i) {
    settings.push_back({adaptive.ratio(), adaptive.suspended()});
    const Times times = adaptive.suspended() ? Times{} : place(adaptive.ratio());
    adaptive.frame(times.culling_us, times.saved_us);
  }
  return settings;
}

int suspendedFrames(const std::vector<Setting>& settings) {
  int count = 0;
  for (const Setting& setting : settings) {
    count += setting.suspended ? 1 : 0;
  }
  return count;
}

// Returns the lengths of stretches of equal settings, without the first and the last one, which are
// incomplete.
std::vector<int> stretches(const std::vector<Setting>& settings) {
  std::vector<int> lengths{1};
  for (std::size_t i = 1; i < settings.size(); ++i) {
    if (settings[i] == settings[i - 1]) {
      ++lengths.back();
    } else {
      lengths.push_back(1);
    }
  }
  lengths.pop_back();
  if (!lengths.empty()) {
    lengths.erase(lengths.begin());
  }
  return lengths;
}

TEST(AdaptiveCoverage, KeepsTheConfiguredRatioWhereCullingPays) {
  AdaptiveCoverage adaptive(0.2);
  for (const Setting& setting : walk(adaptive, kDense, 1000)) {
    EXPECT_EQ(setting, (Setting{0.2, false}));
  }
}

TEST(AdaptiveCoverage, RisesInStepsWhereCullingTakesSomewhatMoreThanItSavesAndIsSuspendedInTheEnd) {
  AdaptiveCoverage adaptive(0.2);
  const std::vector<Setting> settings = walk(adaptive, place(120.0, 100.0), 60);
  int rises = 0;
  for (std::size_t i = 1; i < settings.size() && !settings[i].suspended; ++i) {
    EXPECT_GE(settings[i].ratio, settings[i - 1].ratio) << "frame " << i;
    EXPECT_LE(settings[i].ratio, 1.0);
    rises += settings[i].ratio > settings[i - 1].ratio ? 1 : 0;
  }
  EXPECT_GE(rises, 3);
  EXPECT_GT(suspendedFrames(settings), 0);
}

TEST(AdaptiveCoverage, AnOpenPlaceSuspendsCullingAndIsTriedNowAndThen) {
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, kOpen, 20);
  const std::vector<Setting> settings = walk(adaptive, kOpen, 1000);
  EXPECT_GT(suspendedFrames(settings), 850);
  EXPECT_LT(suspendedFrames(settings), 990);
  for (const Setting& setting : settings) {
    if (!setting.suspended) {
      EXPECT_EQ(setting.ratio, 0.2);  // a trial is with all that culling can do
    }
  }
}

TEST(AdaptiveCoverage, FollowsAChangeFromADenseToAnOpenPlaceAndBack) {
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, kDense, 100);
  for (int round = 0; round < 3; ++round) {
    EXPECT_GT(suspendedFrames(walk(adaptive, kOpen, 200)), 160) << round;
    walk(adaptive, kDense, 30);
    EXPECT_EQ(suspendedFrames(walk(adaptive, kDense, 200)), 0) << round;
    EXPECT_EQ(adaptive.ratio(), 0.2) << round;
  }
}

TEST(AdaptiveCoverage, StaysWhereItIsWhileCullingTakesAboutWhatItSaves) {
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, place(120.0, 100.0), 20);
  const Setting risen{adaptive.ratio(), adaptive.suspended()};
  ASSERT_GT(risen.ratio, 0.2);
  ASSERT_FALSE(risen.suspended);
  for (const Setting& setting : walk(adaptive, place(100.0, 120.0), 1000)) {
    EXPECT_EQ(setting, risen);
  }
}

TEST(AdaptiveCoverage, FallsBackToTheConfiguredRatioWhereCullingPaysAgain) {
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, place(120.0, 100.0), 30);
  ASSERT_GT(adaptive.ratio(), 0.5);
  walk(adaptive, kDense, 100);
  EXPECT_EQ(adaptive.ratio(), 0.2);
  EXPECT_FALSE(adaptive.suspended());
}

TEST(AdaptiveCoverage, SettlesWhereOnlyALargeRatioPays) {
  // At 0.4 culling pays clearly, below it loses: without waiting longer after each failure it would change
  // every eight frames.
  const Place tempting = [](double ratio) { return ratio < 0.35 ? Times{200, 150} : Times{80, 160}; };
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, tempting, 600);
  const std::vector<Setting> settings = walk(adaptive, tempting, 2000);
  EXPECT_LE(stretches(settings).size(), 20u);
  int losing = 0;
  for (const Setting& setting : settings) {
    EXPECT_FALSE(setting.suspended);
    losing += setting.ratio < 0.35 ? 1 : 0;
  }
  EXPECT_LT(losing, 100);
}

TEST(AdaptiveCoverage, NoSettingLastsForASingleFrameWhateverTheTimes) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 random(seed);
    const auto in = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    AdaptiveCoverage adaptive(in(0.0, 0.9));
    std::vector<Setting> settings;
    for (int stay = 0; stay < 40; ++stay) {
      const double culling_us = in(10, 300), saved_us = culling_us * std::exp2(in(-4, 4));
      const Place noisy = [&](double ratio) {
        return Times{culling_us * (1.0 - 0.5 * ratio) * in(0.5, 1.5),
                     saved_us * (1.0 - ratio) * in(0.5, 1.5)};
      };
      const std::vector<Setting> more = walk(adaptive, noisy, 1 + static_cast<int>(random() % 100));
      settings.insert(settings.end(), more.begin(), more.end());
    }
    int short_ones = 0;
    for (const int length : stretches(settings)) {
      // The setting changes after a failed trial or a decision.
      EXPECT_GE(length, static_cast<int>(AdaptiveCoverage::kTrial)) << "seed " << seed;
      short_ones += length < static_cast<int>(AdaptiveCoverage::kWindow) ? 1 : 0;
    }
    EXPECT_LE(short_ones, static_cast<int>(settings.size() / AdaptiveCoverage::kRetestDelay))
        << "seed " << seed;
  }
}

TEST(AdaptiveCoverage, NoiseAroundAClearGainChangesNothing) {
  std::mt19937_64 random(11);
  const Place noisy = [&](double) {
    return Times{100.0 * (0.5 + 1e-3 * static_cast<double>(random() % 1000)),
                 300.0 * (0.5 + 1e-3 * static_cast<double>(random() % 1000))};
  };
  AdaptiveCoverage adaptive(0.2);
  for (const Setting& setting : walk(adaptive, noisy, 5000)) {
    EXPECT_EQ(setting, (Setting{0.2, false}));
  }
}

TEST(AdaptiveCoverage, TimesThatAreNotFiniteAreLeftOut) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  AdaptiveCoverage adaptive(0.2), other(0.2);
  for (int i = 0; i < 100; ++i) {
    const Times times = i < 50 ? Times{120, 100} : Times{100, 300};
    adaptive.frame(times.culling_us, times.saved_us);
    adaptive.frame(nan, 1.0);
    adaptive.frame(1.0, inf);
    other.frame(times.culling_us, times.saved_us);
    if (other.suspended() || adaptive.suspended()) {
      break;  // frames while suspended are counted, whatever they took
    }
    EXPECT_EQ(adaptive.ratio(), other.ratio()) << i;
  }
}

// The lengths of the first stretches of frames without culling, in an open place.
std::vector<int> delays(AdaptiveCoverage& adaptive, std::size_t count) {
  std::vector<int> lengths;
  for (bool was = false;;) {
    const bool suspended = walk(adaptive, kOpen, 1).front().suspended;
    if (was && !suspended && lengths.size() == count) {
      return lengths;
    }
    if (suspended && !was) {
      lengths.push_back(0);
    }
    if (suspended) {
      ++lengths.back();
    }
    was = suspended;
  }
}

TEST(AdaptiveCoverage, EachTrialThatFailsDoublesTheDelayUpToTheLongest) {
  AdaptiveCoverage adaptive(1.0, 100);
  walk(adaptive, kOpen, AdaptiveCoverage::kWindow);
  EXPECT_EQ(delays(adaptive, 5), (std::vector{16, 32, 64, 100, 100}));
}

TEST(AdaptiveCoverage, ATrialThatSucceedsMakesDelaysShortAgain) {
  AdaptiveCoverage adaptive(1.0, 100);
  walk(adaptive, kOpen, AdaptiveCoverage::kWindow);
  delays(adaptive, 3);
  walk(adaptive, kDense, 200);
  ASSERT_FALSE(adaptive.suspended());
  walk(adaptive, kOpen, AdaptiveCoverage::kWindow);
  EXPECT_EQ(delays(adaptive, 2), (std::vector{16, 32}));
}

TEST(AdaptiveCoverage, AnotherPlaceIsTriedAfterOneFrameAndDelaysAreShortAgain) {
  AdaptiveCoverage adaptive(1.0, 1000);
  walk(adaptive, kOpen, AdaptiveCoverage::kWindow);
  delays(adaptive, 4);
  walk(adaptive, kOpen, AdaptiveCoverage::kTrial + 10);
  ASSERT_TRUE(adaptive.suspended());
  adaptive.tryAgain();
  EXPECT_EQ(suspendedFrames(walk(adaptive, kOpen, 1 + AdaptiveCoverage::kTrial)), 1);
  EXPECT_EQ(delays(adaptive, 2), (std::vector{16, 32}));
}

TEST(AdaptiveCoverage, AnotherPlaceChangesNothingWhileCullingPays) {
  AdaptiveCoverage adaptive(0.2);
  walk(adaptive, kDense, 20);
  adaptive.tryAgain();
  EXPECT_EQ(suspendedFrames(walk(adaptive, kDense, 50)), 0);
}

TEST(AdaptiveCoverage, WhereTheConfiguredRatioIsOneALossSuspendsAtOnce) {
  AdaptiveCoverage adaptive(1.0);
  walk(adaptive, place(240.0, 200.0), AdaptiveCoverage::kWindow);  // far from hopeless
  EXPECT_TRUE(adaptive.suspended());
}

TEST(AdaptiveCoverage, TheRatioIsWithinZeroAndOne) {
  EXPECT_EQ(AdaptiveCoverage(-1.0).ratio(), 0.0);
  EXPECT_EQ(AdaptiveCoverage(2.0).ratio(), 1.0);
  EXPECT_EQ(AdaptiveCoverage(std::numeric_limits<double>::quiet_NaN()).ratio(), 0.0);
  AdaptiveCoverage adaptive(1.0);
  for (const Setting& setting : walk(adaptive, place(120.0, 100.0), 200)) {
    EXPECT_EQ(setting.ratio, 1.0);
  }
}

}  // namespace
}  // namespace sightline::culling
