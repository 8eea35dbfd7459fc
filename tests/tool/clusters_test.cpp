// --clusters: large objects are answered by clusters of their triangles.

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// A wall, and an object of two triangles: one behind the wall, one beside it.
struct WallScene {
  TemporaryFolder folder;
  std::string scene = folder.write("wall.obj",
                                   "o wall\nv -4 -4 -5\nv 1 -4 -5\nv 1 4 -5\nv -4 4 -5\nf 1 2 3\nf 1 3 4\n"
                                   "o long\nv 2 -1 -8\nv 3 -1 -8\nv 3 0 -8\nv -1 -1 -8\nv 0 -1 -8\nv 0 0 -8\n"
                                   "f 5 6 7\nf 8 9 10\n"),
              path = folder.write("walk.path.json",
                                  R"({"frames": [{"eye": [0, 0, 0], "forward": [0, 0, -1]}]})");

  std::vector<std::string> command(const std::string& name, const std::string& clusters) const {
    return {name, scene, "--path", path, "--method", "depth-pyramid", "--clusters", clusters};
  }
};

TEST(Clusters, OfAnObjectThatIsPartlyHiddenAreCulledAlone) {
  const WallScene wall;
  const json whole = toolJson(wall.command("cull", "0"));
  EXPECT_EQ(whole["frames"][0]["visible"], json({0, 1}));
  EXPECT_FALSE(whole.contains("clusters"));
  const json cut = toolJson(wall.command("cull", "1"));
  EXPECT_EQ(cut["scene"]["objects"], 2);
  EXPECT_EQ(cut["scene"]["clusters"], 4);
  EXPECT_EQ(cut["scene"]["cluster_triangles"], 1);
  ASSERT_EQ(cut["clusters"].size(), 4u);
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_EQ(cut["clusters"][c]["object"], c / 2);
    EXPECT_EQ(cut["clusters"][c]["triangles"], 1);
  }
  const bool hidden_first = cut["clusters"][2]["max"][0] == 0.0;
  EXPECT_EQ(cut["frames"][0]["visible"], json({0, 1}));
  EXPECT_EQ(cut["frames"][0]["visible_clusters"], hidden_first ? json({0, 1, 3}) : json({0, 1, 2}));
  expectDocumented(cut, {"cull"});
  const Outcome text = runTool(wall.command("cull", "1"));
  EXPECT_NE(text.out.find("--clusters 1"), std::string::npos) << text.out;
  const std::string numbers = std::regex_replace(text.out, std::regex(" +"), " ");
  EXPECT_NE(numbers.find("visible clusters 3.0 of 4"), std::string::npos) << text.out;
  EXPECT_NE(numbers.find("visible objects 2.0 of 2"), std::string::npos) << text.out;
}

TEST(Clusters, AreProvedHiddenOneByOne) {
  const WallScene wall;
  std::vector<std::string> verify = wall.command("verify", "1");
  verify.insert(verify.end(), {"--proof", "--width", "64", "--height", "36"});
  const json verified = toolJson(verify);
  EXPECT_EQ(verified["scene"]["clusters"], 4);
  EXPECT_EQ(verified["false_culls"], 0);
  EXPECT_EQ(verified["proved"], 1) << "the triangle behind the wall";
  EXPECT_EQ(verified["frames"][0]["exact"], 3);
  expectDocumented(verified, {"verify"});
  EXPECT_NE(runTool(verify).out.find("4 clusters"), std::string::npos);
}

TEST(Clusters, WithABakedFileAreRefused) {
  const WallScene wall;
  const std::string sight = wall.folder.file("wall.sight");
  ASSERT_EQ(runTool({"bake", wall.scene, "-o", sight, "--depth", "1"}).code, 0);
  std::vector<std::string> cull = wall.command("cull", "1");
  cull.insert(cull.end(), {"--baked", sight});
  const Outcome outcome = runTool(cull);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("--clusters, --baked"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace sightline::tool_test
