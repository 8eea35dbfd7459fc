// Which settings are on the front, which one is advised, and the interval of kept / exact.

#include <gtest/gtest.h>

#include "tools/sightline/bench/advice.h"
#include "tools/sightline/bench/bench_text.h"

namespace sightline::tool {
namespace {

SettingRecord settingOf(std::string_view method, double cpu_us, std::uint64_t kept, double draw_us = -1.0) {
  SettingRecord run;
  run.setting.method = &methodNamed(method);
  run.cpu.mean = {cpu_us, cpu_us, cpu_us};
  run.kept = kept;
  if (draw_us >= 0.0) {
    run.draw = FrameTimes{.mean = {draw_us, draw_us, draw_us}};
  }
  return run;
}

BenchRecord recordOf(std::vector<SettingRecord> runs) {
  BenchRecord record{.scene_name = "demo:city", .witnessed = 100};
  record.runs = std::move(runs);
  markFront(record);
  record.advice = adviceFor(record);
  return record;
}

TEST(BenchAdvice, TheFrontHasWhatNoneBeats) {
  const BenchRecord record =
      recordOf({settingOf("frustum", 1, 1000), settingOf("occlusion-tree", 100, 110),
                settingOf("depth-pyramid", 20, 130), settingOf("supporting-planes", 30, 130),
                settingOf("opacity-map", 100, 111), settingOf("depth-pyramid", 20, 130)});
  EXPECT_TRUE(record.runs[0].on_front);
  EXPECT_TRUE(record.runs[1].on_front);
  EXPECT_TRUE(record.runs[2].on_front);
  EXPECT_FALSE(record.runs[3].on_front) << "as tight as another one, and slower";
  EXPECT_FALSE(record.runs[4].on_front) << "as fast as another one, and looser";
  EXPECT_TRUE(record.runs[5].on_front) << "an equal one does not beat it";
}

TEST(BenchAdvice, WhatMayCullVisibleObjectsIsNeitherOnTheFrontNorBeatsAnything) {
  SettingRecord approximate = settingOf("opacity-map", 2, 90);
  approximate.setting.opacity_map.map.tolerance = 5;
  ASSERT_TRUE(approximate.setting.approximate());
  const BenchRecord record =
      recordOf({settingOf("frustum", 1, 1000), approximate, settingOf("depth-pyramid", 20, 130)});
  EXPECT_FALSE(record.runs[1].on_front);
  EXPECT_TRUE(record.runs[2].on_front);
  EXPECT_EQ(record.advice.run, 2u);
}

TEST(BenchAdvice, WithoutDrawingItIsTheKneeOfTheFront) {
  const BenchRecord record = recordOf({settingOf("frustum", 1, 1000), settingOf("supporting-planes", 10, 150),
                                       settingOf("occlusion-tree", 1000, 110)});
  EXPECT_EQ(record.advice.run, 1u);
  EXPECT_EQ(record.advice.sentence.rfind("for demo:city use supporting-planes (", 0), 0u)
      << record.advice.sentence;
  EXPECT_NE(record.advice.sentence.find("86 % in tightness for 33 % in time"), std::string::npos)
      << record.advice.sentence;
}

TEST(BenchAdvice, OfTwoEndsOfAFrontItIsTheTighterOne) {
  EXPECT_EQ(recordOf({settingOf("frustum", 1, 1000), settingOf("occlusion-tree", 100, 110)}).advice.run, 1u);
}

TEST(BenchAdvice, WithDrawingItIsTheLeastTimeOfBoth) {
  EXPECT_EQ(recordOf({settingOf("frustum", 1, 1000, 500), settingOf("supporting-planes", 10, 150, 300),
                      settingOf("occlusion-tree", 100, 110, 150)})
                .advice.run,
            2u);
  const BenchRecord no_use =
      recordOf({settingOf("frustum", 1, 1000, 50), settingOf("occlusion-tree", 100, 110, 20)});
  EXPECT_EQ(no_use.advice.run, 0u);
}

TEST(BenchAdvice, IsFrustumCullingWhereNothingHidesATenth) {
  const BenchRecord open = recordOf({settingOf("frustum", 1, 1000), settingOf("occlusion-tree", 2, 901)});
  EXPECT_EQ(open.advice.run, 0u);
  EXPECT_NE(open.advice.sentence.find("no setting hides a tenth"), std::string::npos) << open.advice.sentence;
  EXPECT_EQ(recordOf({settingOf("frustum", 1, 1000), settingOf("occlusion-tree", 2, 900)}).advice.run, 1u);
}

TEST(BenchAdvice, IsGivenForOneSettingAndWhereNothingIsVisible) {
  EXPECT_EQ(recordOf({settingOf("frustum", 1, 10)}).advice.run, 0u);
  BenchRecord dark = recordOf({settingOf("frustum", 1, 10), settingOf("occlusion-tree", 2, 0)});
  dark.witnessed = 0;
  EXPECT_NE(adviceFor(dark).sentence.find("none of which is visible"), std::string::npos);
}

TEST(BenchInterval, GoesFromAllUndecidedVisibleToNone) {
  BenchRecord record;
  record.witnessed = 80;
  record.undecided = 20;
  SettingRecord run;
  run.kept = 120;
  const std::optional<Interval> interval = record.overestimate(run);
  ASSERT_TRUE(interval);
  EXPECT_DOUBLE_EQ(interval->low, 1.2);
  EXPECT_DOUBLE_EQ(interval->high, 1.5);
  EXPECT_EQ(intervalText(interval), "1.20-1.50");
  EXPECT_EQ(intervalText(Interval{1.201, 1.204}), "1.20");
  record.witnessed = 0;
  EXPECT_FALSE(record.overestimate(run));
  EXPECT_EQ(intervalText({}), "-");
}

}  // namespace
}  // namespace sightline::tool
