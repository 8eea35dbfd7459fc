// --prepared: what is found in a scene once is read from then on.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

const std::string kSmallCity = "demo:city?copies=1";

struct PreparedRun {
  TemporaryFolder folder;
  std::string file = folder.file("city.prepared");

  Outcome cull(const std::string& scene = kSmallCity, const std::string& method = "depth-pyramid") const {
    return runTool({"cull", scene, "--method", method, "--frames", "0:40:10", "--no-times", "--prepared",
                    file, "--json", "-"});
  }
  void spoil(std::streamoff at) const {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(at);
    stream.put('\x55');
  }
};

TEST(Prepared, TheSecondRunReadsWhatTheFirstOneFound) {
  const PreparedRun run;
  const Outcome first = run.cull();
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.err, "");
  ASSERT_TRUE(std::filesystem::exists(run.file));
  const auto written = std::filesystem::last_write_time(run.file);
  const Outcome second = run.cull();
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.err, "");
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(std::filesystem::last_write_time(run.file), written);
}

TEST(Prepared, TheFileGrowsByWhatOtherMethodsNeed) {
  const PreparedRun run;
  const std::string without = runTool({"cull", kSmallCity, "--method", "occlusion-tree", "--frames",
                                       "0:40:10", "--no-times", "--json", "-"})
                                  .out;
  ASSERT_EQ(run.cull(kSmallCity, "frustum").code, 0);
  const auto hierarchy = std::filesystem::file_size(run.file);
  const Outcome surfaces = run.cull();
  const auto with_surfaces = std::filesystem::file_size(run.file);
  EXPECT_GT(with_surfaces, hierarchy);
  EXPECT_EQ(run.cull(kSmallCity, "occlusion-tree").out, without);
  const auto with_occluders = std::filesystem::file_size(run.file);
  EXPECT_GT(with_occluders, with_surfaces);
  EXPECT_EQ(run.cull(kSmallCity, "occlusion-tree").out, without) << "with occluders of the file";
  EXPECT_EQ(run.cull().out, surfaces.out);
  EXPECT_EQ(std::filesystem::file_size(run.file), with_occluders) << "nothing was missing";
  const Outcome info = runTool({"info", kSmallCity, "--prepared", run.file, "--json", "-"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_GT(std::filesystem::file_size(run.file), with_occluders) << "the other hierarchy";
  const Outcome again = runTool({"info", kSmallCity, "--prepared", run.file});
  EXPECT_EQ(again.err, "");
}

TEST(Prepared, WhatDoesNotFitIsFoundAnew) {
  const PreparedRun run;
  const Outcome first = run.cull();
  ASSERT_EQ(first.code, 0) << first.err;
  const auto size = std::filesystem::file_size(run.file);
  run.spoil(static_cast<std::streamoff>(size / 2));
  const Outcome damaged = run.cull();
  EXPECT_EQ(damaged.code, 0);
  EXPECT_NE(damaged.err.find("it is damaged"), std::string::npos) << damaged.err;
  EXPECT_EQ(damaged.out, first.out);
  EXPECT_EQ(run.cull().err, "") << "it was written anew";
  std::filesystem::resize_file(run.file, size / 3);
  const Outcome cut = run.cull();
  EXPECT_EQ(cut.code, 0);
  EXPECT_NE(cut.err.find("cut off"), std::string::npos) << cut.err;
  const Outcome other = run.cull("demo:city?copies=1&seed=9");
  EXPECT_EQ(other.code, 0);
  EXPECT_NE(other.err.find("of another scene"), std::string::npos) << other.err;
  std::filesystem::resize_file(run.file, 0);
  EXPECT_EQ(run.cull().out, first.out) << "an empty file may be written over";
}

TEST(Prepared, OtherFilesAreNotWrittenOver) {
  const PreparedRun run;
  const std::string text = run.folder.write("notes.txt", "not prepared");
  EXPECT_EQ(runTool({"info", "missing.sight", "--prepared", run.file}).code, 2);
  const Outcome notes = runTool({"cull", kSmallCity, "--frames", "0", "--prepared", text});
  EXPECT_EQ(notes.code, 2);
  EXPECT_NE(notes.err.find("holds nothing prepared"), std::string::npos) << notes.err;
  EXPECT_EQ(std::filesystem::file_size(text), 12u);
  const Outcome nowhere =
      runTool({"cull", kSmallCity, "--frames", "0", "--prepared", run.folder.file("no/where.prepared")});
  EXPECT_EQ(nowhere.code, 2) << nowhere.err;
  const Outcome several = runTool({"bench", kSmallCity, "demo:glass", "--prepared", run.file});
  EXPECT_EQ(several.code, 2);
  EXPECT_NE(several.err.find("one scene"), std::string::npos) << several.err;
}

}  // namespace
}  // namespace sightline::tool_test
