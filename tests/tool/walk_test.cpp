// The main job, end to end.

#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

TEST(Tool, WalkWritesAReportThatStandsAlone) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const TemporaryFolder folder;
  const std::string report = folder.file("new/report");
  const Outcome outcome =
      runTool({"walk", "demo:city?copies=1", "-o", report, "--frames", "0:400:50", "--width", "160",
               "--height", "90", "--method", "occlusion-tree", "--variant", "FSE,FME"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  EXPECT_EQ(outcome.err, "");
  const json walk = parse(contents(report + "/walk.json"));
  ASSERT_EQ(walk["runs"].size(), 3u);
  EXPECT_EQ(walk["runs"][0]["method"], "frustum");
  EXPECT_EQ(walk["differing_frames"], 0);
  EXPECT_TRUE(walk["tie_frames"].is_number_unsigned());
  for (const json& run : walk["runs"]) {
    ASSERT_EQ(run["frames"].size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_LE(run["frames"][i]["triangles"], walk["runs"][0]["frames"][i]["triangles"]);
      EXPECT_GT(run["frames"][i]["draw_us"], 0.0);
    }
  }
  const std::string html = contents(report + "/index.html");
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find(">350<"), std::string::npos) << "frame numbers under the curves";
  EXPECT_NE(html.find("--frames 0:400:50"), std::string::npos) << "the whole command line";
  EXPECT_NE(html.find("--variant FSE,FME"), std::string::npos);
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(report)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".png") {
      EXPECT_EQ(contents(entry.path().string()).substr(1, 3), "PNG");
      EXPECT_NE(html.find(name), std::string::npos) << name;
      pictures += 1;
    }
  }
  EXPECT_GE(pictures, 8u) << "a picture and a plan of at least four frames";
}

TEST(Tool, WalkTellsTheOpacityMapWhatDrawingTakes) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const TemporaryFolder folder;
  const auto walk = [&](const std::vector<std::string>& more) {
    return runTool(joined({"walk", "demo:city?copies=1", "-o", folder.file("report"), "--frames", "0:400:20",
                           "--width", "64", "--height", "36", "--measure-renderer"},
                          more));
  };
  ASSERT_EQ(walk({"--method", "opacity-map"}).code, 0) << "nothing visible is culled whatever was measured";
  const json report = parse(contents(folder.file("report/walk.json")));
  for (const json& frame : report["runs"][1]["frames"]) {
    EXPECT_TRUE(frame["map"].contains("suspended")) << "the coverage ratio adapts";
  }
  EXPECT_EQ(walk({"--method", "depth-pyramid"}).code, 2);
  EXPECT_EQ(walk({"--method", "opacity-map", "--no-pictures"}).code, 2);
}

TEST(Tool, WalkCopesWithASingleFrame) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const TemporaryFolder folder;
  const Outcome outcome = runTool({"walk", "demo:building?floors=1", "-o", folder.file("report"), "--frames",
                                   "7", "--method", "frustum", "--width", "64", "--height", "36"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  EXPECT_TRUE(std::filesystem::exists(folder.file("report") + "/frame_0007.png"));
}

}  // namespace
}  // namespace sightline::tool_test
