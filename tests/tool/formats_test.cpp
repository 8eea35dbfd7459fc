// docs/formats.md describes every key that the tool writes.

#include <gtest/gtest-spi.h>

#include "tests/support/pictures.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

TEST(Formats, AKeyThatThePageDoesNotNameIsFound) {
  const std::set<std::string> words{"a", "b"};
  EXPECT_NONFATAL_FAILURE(expectDocumented(json{{"a", {{{"b", 1}}, {{"c", 2}}}}}, words, "form"),
                          "does not describe form.a.c");
  EXPECT_TRUE(wordsOfSection("## Points (read)").contains("points"));
  EXPECT_FALSE(wordsOfSection("## Points (read)").contains("frames"));
  EXPECT_FALSE(wordsOfSection("### scene").contains("hierarchy"));
}

TEST(Formats, TheKeysOfInfoAreDescribed) {
  expectDocumented(toolJson({"info", kCity}), {"info"});
}

TEST(Formats, TheKeysOfBakeInfoOfABakedFileAndQueryAreDescribed) {
  const TemporaryFolder folder;
  const std::string file = folder.file("city.sight");
  expectDocumented(toolJson({"bake", kCity, "-o", file, "--depth", "2"}), {"bake", "info of a baked file"});
  expectDocumented(toolJson({"info", file}), {"info of a baked file"});
  expectDocumented(toolJson({"query", file, "--points", "0,2,0", "--points", "0,9999,0"}), {"query"});
  expectDocumented(toolJson({"cull", kCity, "--frames", "0:2", "--baked", file, "--visible-sets", "on"}),
                   {"cull"});
  expectDocumented(
      toolJson({"cull", kCity, "--frames", "0:2", "--baked", file, "--method", "visibility-octree"}),
      {"cull"});
}

TEST(Formats, TheKeysOfCullAreDescribedWhateverTheMethod) {
  for (const std::vector<std::string>& method :
       std::vector<std::vector<std::string>>{{"frustum"},
                                             {"occlusion-tree"},
                                             {"occlusion-tree", "--detail-objects", "on"},
                                             {"occlusion-tree", "--occluders", "database"},
                                             {"occlusion-tree", "--occluders", "minimum-sets"},
                                             {"supporting-planes"},
                                             {"supporting-planes", "--planes", "through-box"},
                                             {"opacity-map", "--triangle-us", "1"},
                                             {"opacity-map", "--surfaces", "alone", "--budget-us", "100"},
                                             {"depth-pyramid"},
                                             {"depth-pyramid", "--draw-object-us", "1"}}) {
    expectDocumented(toolJson(joined({"cull", kCity, "--frames", "0:2", "--method"}, method)), {"cull"});
  }
}

TEST(Formats, TheKeysOfVerifyAreDescribedForOneSettingAndForSeveral) {
  const std::vector<std::string> verify{"verify", kCity, "--frames", "0", "--width", "32", "--height", "18"};
  expectDocumented(toolJson(verify), {"verify"});
  expectDocumented(toolJson(joined(verify, {"--hierarchy", "kd,bvh"})), {"verify"});
  // With the centres of pixels there are false culls, if any, in coarse maps.
  const json witnesses = toolJson(joined(verify, {"--method", "depth-pyramid", "--coverage", "centre",
                                                  "--resolution", "8x4", "--focus", "0"}),
                                  1);
  EXPECT_FALSE(witnesses["witnesses"].empty());
  expectDocumented(witnesses, {"verify"});
}

TEST(Formats, TheKeysOfWalkAreDescribed) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const TemporaryFolder folder;
  const std::vector<std::string> walk{"walk",     kCity,
                                      "--frames", "0:2",
                                      "--width",  "64",
                                      "--height", "36",
                                      "--method", "occlusion-tree,depth-pyramid",
                                      "-o",       folder.file("report")};
  const json result = toolJson(walk);
  expectDocumented(result, {"walk"});
  EXPECT_EQ(parse(contents(folder.file("report/walk.json"))), result);
}

TEST(Formats, TheKeysOfLayersAreDescribed) {
  expectDocumented(toolJson({"layers", "demo:toothpicks?n=10", "--frames", "0:2", "--arcs", "all"}),
                   {"layers"});
}

TEST(Formats, TheKeysOfLayersDrawnAreDescribed) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const TemporaryFolder folder;
  const json drawn = toolJson({"layers",
                               "demo:glass",
                               "--frames",
                               "0",
                               "--width",
                               "32",
                               "--height",
                               "18",
                               "--without",
                               "3",
                               "--image",
                               folder.file("image.png"),
                               "--by-distance",
                               folder.file("distance.png"),
                               "--depth-of-field",
                               "layers",
                               "--focus",
                               "3",
                               "--aperture",
                               "0.05",
                               "--reference-passes",
                               "2",
                               "--blurred",
                               folder.file("blurred.png"),
                               "--compare",
                               folder.file("compare.png"),
                               "--svg",
                               folder.file("lines.svg"),
                               "--pdf",
                               folder.file("lines.pdf"),
                               "--line-picture",
                               folder.file("lines.png")});
  for (const char* key : {"picture", "lens", "drawing", "line_picture"}) {
    EXPECT_TRUE(drawn["frames"][0].contains(key)) << key;
  }
  expectDocumented(drawn, {"layers"});
}

// What readers promise: keys that they do not know are ignored.
TEST(Formats, UnknownKeysOfPathsAndPointsAreIgnored) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("path.json", R"({"author":"me","width":64,"height":36,"frames":[)"
                                R"({"eye":[0,2,0],"forward":[0,0,-1],"time_us":5,"tags":{"a":1}}]})");
  EXPECT_EQ(toolJson({"cull", kCity, "--path", path})["frames"].size(), 1u);
  const std::string file = folder.file("city.sight");
  ASSERT_EQ(runTool({"bake", kCity, "-o", file, "--depth", "1"}).code, 0);
  const std::string points = folder.write("points.json", R"({"unit":"m","points":[[0,2,0]]})");
  EXPECT_EQ(toolJson({"query", file, "--points", points})["points"].size(), 1u);
}

}  // namespace
}  // namespace sightline::tool_test
