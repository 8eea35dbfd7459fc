// --crack-width: all commands name it, and say what it costs.

#include <gtest/gtest.h>

#include "tests/support/pictures.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// Two walls with half a millimetre between them, and something behind it.
const std::string kSlitObj =
    "o left\nv -9 -9 -5\nv 0 -9 -5\nv 0 9 -5\nv -9 9 -5\nf 1 2 3\nf 1 3 4\n"
    "o right\nv 0.0005 -9 -5\nv 9 -9 -5\nv 9 9 -5\nv 0.0005 9 -5\nf 5 6 7\nf 5 7 8\n"
    "o behind\nv -1 -1 -8\nv 1 -1 -8\nv 1 1 -8\nf 9 10 11\n";
const std::string kSlitPath = R"({"near": 0.01, "frames": [{"eye": [0, 0, 0], "forward": [0, 0, -1]},
                                                      {"eye": [0.1, 0, 0], "forward": [0, 0, -1]}]})";

struct SlitScene {
  TemporaryFolder folder;
  std::string scene = folder.write("slit.obj", kSlitObj), path = folder.write("walk.path.json", kSlitPath);
};

TEST(CrackWidth, InfoCountsCracksAndWhatClosingThemHides) {
  const SlitScene slit;
  const json plain = toolJson({"info", slit.scene})["cracks"];
  EXPECT_FALSE(plain.contains("closed"));
  ASSERT_EQ(plain["counts"].size(), 5u);
  for (const json& bin : plain["counts"]) {
    EXPECT_EQ(bin["count"], bin["below"] == 0.001 ? 4 : 0) << "each corner at the slit lies beside an edge";
  }
  ASSERT_EQ(plain["places"].size(), 1u);
  EXPECT_EQ(plain["places"][0]["objects"], json({0, 1}));
  EXPECT_NEAR(plain["places"][0]["widest"], 0.0005, 1e-9);
  const json info = toolJson({"info", slit.scene, "--path", slit.path, "--crack-width", "0.001"});
  const json closed = info["cracks"]["closed"];
  EXPECT_EQ(closed["frames"], 2);
  EXPECT_EQ(closed["crack_width"], 0.001);
  EXPECT_EQ(closed["kept_open"], 3.0);
  EXPECT_EQ(closed["kept_closed"], 2.0);
  expectDocumented(info, {"info"});
}

TEST(CrackWidth, InfoWalksOnceForEachWidth) {
  const SlitScene slit;
  const std::vector<std::string> arguments{"info",    slit.scene,      "--path",
                                           slit.path, "--crack-width", "0.0001,0,0.001"};
  const json cracks = toolJson(arguments)["cracks"];
  ASSERT_EQ(cracks["closings"].size(), 2u) << "0 is the scene as it is";
  EXPECT_EQ(cracks["closings"][0]["crack_width"], 0.0001);
  EXPECT_EQ(cracks["closings"][0]["kept_closed"], 3.0) << "the slit is wider";
  EXPECT_EQ(cracks["closings"][1]["crack_width"], 0.001);
  EXPECT_EQ(cracks["closings"][1]["kept_closed"], 2.0);
  EXPECT_EQ(cracks["closed"], cracks["closings"][0]);
  const Outcome text = runTool(arguments);
  EXPECT_NE(text.out.find("below 0.0001 m closed, 3.0 objects a frame are kept instead of 3.0"),
            std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("below 0.001 m closed, 2.0 objects a frame are kept instead of 3.0"),
            std::string::npos)
      << text.out;
}

TEST(CrackWidth, EveryOutputNamesIt) {
  const SlitScene slit;
  const std::string sight = slit.folder.file("slit.sight");
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--path", slit.path, "--crack-width", "0.001"});
    return arguments;
  };
  const json cull = toolJson(with({"cull", slit.scene, "--method", "depth-pyramid"}));
  EXPECT_EQ(cull["scene"]["crack_width"], 0.001);
  EXPECT_LE(cull["scene"]["crack_slack"], 0.002);
  EXPECT_EQ(cull["frames"][0]["visible"], json({0, 1}));
  expectDocumented(cull, {"cull"});
  const json open = toolJson({"cull", slit.scene, "--method", "depth-pyramid", "--path", slit.path});
  EXPECT_FALSE(open["scene"].contains("crack_width"));
  EXPECT_EQ(open["frames"][0]["visible"], json({0, 1, 2}));
  const json verified = toolJson(with({"verify", slit.scene, "--width", "64", "--height", "36", "--proof"}));
  EXPECT_EQ(verified["scene"]["crack_width"], 0.001);
  EXPECT_EQ(verified["false_culls"], 0);
  EXPECT_EQ(verified["undecided"], 0);
  expectDocumented(verified, {"verify"});
  const json walked = toolJson(with({"walk", slit.scene, "--no-pictures", "-o", slit.folder.file("walk")}));
  EXPECT_EQ(walked["scene"]["crack_width"], 0.001);
  const Outcome walk_text =
      runTool(with({"walk", slit.scene, "--no-pictures", "-o", slit.folder.file("walk")}));
  EXPECT_NE(walk_text.out.find("--crack-width 0.001"), std::string::npos) << walk_text.out;
  const Outcome text = runTool(with({"cull", slit.scene}));
  EXPECT_NE(text.out.find("--crack-width 0.001"), std::string::npos) << text.out;
  EXPECT_NE(text.err.find("count as closed"), std::string::npos) << text.err;
  const Outcome bench = runTool(with({"bench", slit.scene, "--csv", "-", "--method", "frustum"}));
  EXPECT_NE(bench.out.find("--crack-width 0.001"), std::string::npos) << bench.out << bench.err;
  const json measured = toolJson(with({"bench", slit.scene, "--method", "frustum"}));
  EXPECT_EQ(measured["scenes"][0]["scene"]["crack_width"], 0.001);
}

TEST(CrackWidth, PreparedSurfacesBelongToTheirWidth) {
  const SlitScene slit;
  const std::string file = slit.folder.file("slit.surfaces");
  const std::vector<std::string> open{"cull",     slit.scene,      "--path",     slit.path,
                                      "--method", "depth-pyramid", "--prepared", file};
  std::vector<std::string> closed = open;
  closed.insert(closed.end(), {"--crack-width", "0.001"});
  EXPECT_EQ(toolJson(closed)["frames"][0]["visible"], json({0, 1}));
  EXPECT_EQ(runTool(closed).err.find("written anew"), std::string::npos) << "they are there";
  const Outcome other = runTool(open);
  EXPECT_NE(other.err.find("written anew: it is of --crack-width 0.001"), std::string::npos) << other.err;
  EXPECT_EQ(toolJson(open)["frames"][0]["visible"], json({0, 1, 2}));
}

TEST(CrackWidth, ABakedFileBelongsToItsWidth) {
  const SlitScene slit;
  const std::string sight = slit.folder.file("slit.sight");
  const Outcome baked = runTool({"bake", slit.scene, "-o", sight, "--depth", "1", "--crack-width", "0.001"});
  ASSERT_EQ(baked.code, 0) << baked.err;
  EXPECT_NE(baked.out.find("--crack-width 0.001"), std::string::npos) << baked.out;
  const json facts = toolJson({"info", sight});
  EXPECT_EQ(facts["settings"]["all"]["crack_width"], 0.001);
  EXPECT_EQ(facts["scene"]["crack_width"], 0.001);
  EXPECT_LE(facts["scene"]["crack_slack"], 0.002);
  expectDocumented(facts, {"info of a baked file"});
  EXPECT_NE(runTool({"info", sight}).out.find("closed by --crack-width 0.001"), std::string::npos);
  const json answered = toolJson({"query", sight, "--points", "0,0,0"});
  EXPECT_EQ(answered["scene"]["crack_width"], 0.001);
  EXPECT_EQ(answered["scene"]["crack_slack"], facts["scene"]["crack_slack"]);
  const Outcome query = runTool({"query", sight, "--points", "0,0,0"});
  EXPECT_NE(query.out.find("closed by --crack-width 0.001"), std::string::npos) << query.out;
  std::vector<std::string> cull{"cull",    slit.scene, "--path",         slit.path,
                                "--baked", sight,      "--visible-sets", "on"};
  const Outcome without = runTool(cull);
  EXPECT_EQ(without.code, 2);
  EXPECT_NE(without.err.find("--crack-width 0.001"), std::string::npos) << without.err;
  cull.insert(cull.end(), {"--crack-width", "0.001"});
  EXPECT_EQ(runTool(cull).code, 0);
  const Outcome info = runTool({"info", sight, "--crack-width", "0.001"});
  EXPECT_EQ(info.code, 2);
  EXPECT_NE(info.err.find("leave them out"), std::string::npos) << info.err;
  const json pairs = toolJson(
      {"verify", slit.scene, "--baked", sight, "--proof", "--pairs", "10", "--crack-width", "0.001"});
  EXPECT_EQ(pairs["scene"]["crack_width"], 0.001);
  EXPECT_EQ(pairs["false_culls"], 0);
}

TEST(CrackWidth, BadWidthsAreRefused) {
  for (const std::string width : {"-1", "nan", "inf", "1.1", "a", ""}) {
    const Outcome outcome = runTool({"cull", "demo:city?copies=1", "--crack-width", width});
    EXPECT_EQ(outcome.code, 2) << width;
    EXPECT_NE(outcome.err.find("--crack-width"), std::string::npos) << outcome.err;
  }
  const Outcome path = runTool({"info", "demo:city?copies=1", "--frames", "0"});
  EXPECT_EQ(path.code, 2);
  EXPECT_NE(path.err.find("give --crack-width"), std::string::npos) << path.err;
}

}  // namespace
}  // namespace sightline::tool_test
