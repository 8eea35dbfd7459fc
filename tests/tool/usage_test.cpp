// Exit codes and error lines.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

TEST(Tool, BadUsageIsOneLineAndExitCodeTwo) {
  expectRefused({"bogus"}, "info, walk, cull, verify, bench, reproduce");
  expectRefused({"cull"}, "SCENE");
  expectRefused({"cull", kCity, "--bogus"}, "--bogus");
  expectRefused({"cull", kCity, "--threads"}, "--threads");
  expectRefused({"cull", kCity, "demo:ship"}, "cull takes one SCENE; 'demo:ship' is one word too many");
  expectRefused({"walk", kCity}, "--output");
}

TEST(Tool, AnOptionWithNothingAfterItsEqualsSignTakesNoOtherWord) {
  const TemporaryFolder folder;
  const std::string scene = "demo:glass", file = folder.file("result.json");
  expectRefused({"verify", scene, "--method", "depth-pyramid", "--json=", file}, "--json= needs a value");
  expectRefused({"verify", scene, "--method", "depth-pyramid", "--proof="}, "--proof= needs a value");
  expectRefused({"walk", scene, "-o=", folder.file("report")}, "-o= needs a value");
  EXPECT_EQ(folder.entries(), 0u);
  EXPECT_EQ(runTool({"info", scene, "--json=" + file}).code, 0);
  EXPECT_TRUE(parse(contents(file)).is_object());
}

TEST(Tool, UnknownNamesAreAnsweredWithThoseThatExist) {
  expectRefused({"info", "demo:nothing"}, "city");
  expectRefused({"cull", kCity, "--method", "visibility"},
                "frustum, supporting-planes, occlusion-tree, opacity-map");
  expectRefused({"cull", kCity, "--method", ""}, "frustum, supporting-planes, occlusion-tree");
  expectRefused({"verify", kCity, "--method", "frustum,,frustum"},
                "frustum, supporting-planes, occlusion-tree");
  expectRefused({"cull", kCity, "--variant", "fse"}, "FSE, FSC, FME, FMC");
  expectRefused({"cull", kCity, "--hierarchy", "octree"}, "kd, bvh");
  expectRefused({"cull", kCity, "--coherence", "maybe"}, "on, off");
  expectRefused({"cull", kCity, "--occluders", "largest"}, "area-angle, database, minimum-sets");
  expectRefused({"cull", kCity, "--area-angle", "x"}, "occluder, view");
  expectRefused({"cull", kCity, "--coverage", "outer"}, "inner, centre");
  expectRefused({"cull", kCity, "--path", "nowhere"}, "smooth");
  expectRefused({"cull", kCity, "--method", "frustum,occlusion-tree"}, "one value");
}

TEST(Tool, SizesOfMapsOutOfRangeAreRefused) {
  for (const std::string bad :
       {"", "320", "x180", "320x", "0x180", "320x0", "320x180x2", "8193x8", "-3x4", "axb"}) {
    expectRefused({"cull", kCity, "--method", "depth-pyramid", "--resolution", bad}, "--resolution");
  }
}

TEST(Tool, NumbersOutOfRangeAreRefused) {
  for (const std::string bad : {"0", "-1", "99999999999999999999", "1e3", "nan", "", " ", "8x"}) {
    expectRefused({"cull", kCity, "--occluder-count", bad}, "--occluder-count");
    expectRefused({"cull", kCity, "--threads", bad}, "--threads");
    expectRefused({"verify", kCity, "--width", bad}, "--width");
    expectRefused({"verify", kCity, "--height", bad}, "--height");
  }
  for (const std::string bad : {"-1", "99999999999999999999", "x"}) {
    expectRefused({"verify", kCity, "--aimed-rays", bad}, "--aimed-rays");
    expectRefused({"cull", kCity, "--min-node-cost", bad}, "--min-node-cost");
  }
  for (const std::string bad : {"-1", "nan", "inf", "1e999", "x"}) {
    expectRefused({"cull", kCity, "--lambda-steps", bad}, "--lambda-steps");
  }
  for (const std::string bad :
       {"3:1", "2:2", "0:10:0", "400", "400:500", "-1:3", "a:b", "0:1:2:3", ":", "1:99999999999999"}) {
    expectRefused({"cull", kCity, "--frames", bad}, "--frames");
  }
}

TEST(Tool, NumbersAreDecimal) {
  for (const std::string other : {"0x10", "010x", "+10", " 10", "0b1"}) {
    expectRefused({"layers", "demo:glass", "--width", other}, "--width");
    expectRefused({"layers", "demo:glass", "--passes", other}, "--passes");
    expectRefused({"layers", "demo:glass", "--backdrop", "1," + other}, "--backdrop");
    expectRefused({"cull", kCity, "--frames", other}, "--frames");
  }
  for (const std::string other : {"0x1p3", "0x10", "nan", "inf", "+1", "1,0"}) {
    expectRefused({"layers", "demo:glass", "--crease", other}, "--crease");
    expectRefused({"layers", "demo:glass", "--focus", other}, "--focus");
  }
  const TemporaryFolder folder;
  const std::vector<std::string> draw{"layers", "demo:glass",         "--frames", "0",
                                      "--svg",  folder.file("a.svg"), "--height", "8"};
  EXPECT_EQ(runTool(joined(draw, {"--width", "0010"})).code, 0);
  EXPECT_NE(contents(folder.file("a.svg")).find("width=\"10\""), std::string::npos);
  EXPECT_EQ(toolJson({"cull", kCity, "--frames", "010"})["frames"][0]["frame"], 10) << "of ranges, too";
  EXPECT_EQ(runTool(joined(draw, {"--crease", "07.5e0", "--width", "10"})).code, 0);
}

TEST(Tool, FramesBeyondThePathAreToldHowManyItHas) {
  for (const std::string command : {"cull", "verify"}) {
    for (const std::string bad : {"400", "400:500", "4294967295", "1000:2000:10"}) {
      expectRefused({command, kCity, "--frames", bad},
                    "'" + bad + "' begins beyond the path, which has 400 frames, 0 to 399");
    }
  }
  expectRefused({"cull", kCity, "--frames", "3:1"}, "is not A:B");
}

TEST(Tool, VerifySaysHowToGetCertainty) {
  std::vector<std::string> few_rays{"verify",   kCity, "--frames", "0:20:10",       "--width",     "64",
                                    "--height", "36",  "--method", "depth-pyramid", "--gap-steps", "0"};
  const Outcome by_rays = runTool(few_rays);
  EXPECT_NE(by_rays.out.find("--proof decides about them"), std::string::npos) << by_rays.out;
  const Outcome short_proof = runTool(joined(few_rays, {"--proof", "--proof-steps", "1"}));
  EXPECT_NE(short_proof.out.find("a larger --proof-steps"), std::string::npos) << short_proof.out;
  const Outcome proof = runTool(joined(few_rays, {"--proof"}));
  EXPECT_EQ(proof.out.find("--proof"), std::string::npos) << "all is decided: " << proof.out;
  const std::string help = runTool({"verify", "--help"}).out;
  EXPECT_NE(help.substr(0, help.find('\n')).find("--proof"), std::string::npos) << help;
}

TEST(Tool, FilesThatAreNoScenesAreRefused) {
  const TemporaryFolder folder;
  expectRefused({"info", folder.file("missing.glb")}, "missing.glb");
  expectRefused({"info", folder.file("")}, folder.file(""));
  expectRefused({"info", folder.write("empty.glb", "")}, "empty.glb");
  expectRefused({"info", folder.write("empty.obj", "")}, "empty.obj");
  expectRefused(
      {"info", folder.write("cut.glb", std::string("glTF\2\0\0\0\0\4\0\0\0\2\0\0JSON{\"asset\":", 29))},
      "cut.glb");
  expectRefused({"info", folder.write("empty.gltf", "{\"asset\":{\"version\":\"2.0\"}}")}, "empty.gltf");
  expectRefused({"info", folder.write("scene.unknown", "text")}, "scene.unknown");
  for (const std::string command : {"info", "cull", "verify"}) {
    expectRefused({command, folder.file("missing.glb")}, "missing.glb");
  }
  expectRefused({"walk", folder.file("missing.glb"), "-o", folder.file("report")}, "missing.glb");
  EXPECT_FALSE(std::filesystem::exists(folder.file("report")));
}

std::string pathWith(const std::string& eye, const std::string& more = "") {
  return "{\"fovy_deg\":60,\"width\":64,\"height\":36,\"near\":0.1,\"far\":100" + more +
         ",\"frames\":[{\"eye\":" + eye + ",\"forward\":[0,0,-1],\"up\":[0,1,0]}]}";
}

TEST(Tool, FilesThatAreNoPathsAreRefused) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"empty", ""},
      {"cut", "{\"fovy_deg\":60,\"fra"},
      {"list", "[]"},
      {"no_frames", "{\"fovy_deg\":60,\"width\":64,\"height\":36,\"near\":0.1,\"far\":100,\"frames\":[]}"},
      {"nan", pathWith("[NaN,0,0]")},
      {"huge", pathWith("[1e999,0,0]")},
      {"null", pathWith("[null,0,0]")},
      {"short", pathWith("[0,0]")},
      {"text", pathWith("\"here\"")},
      {"shift", pathWith("[0,2,0]", ",\"shift\":[0,1001]")},
      {"shifts", pathWith("[0,2,0]", ",\"shift\":0.5")},
      {"wrong_types", "{\"fovy_deg\":\"wide\",\"frames\":7}"},
      {"utf8", "{\"\xff\xfe\":1}"},
  };
  for (const auto& [name, text] : bad) {
    const std::string file = folder.write(name + ".json", text);
    expectRefused({"cull", kCity, "--path", file}, name);
  }
  expectRefused({"cull", kCity, "--path", folder.file("")}, folder.file(""));
  const std::string good = folder.write("good.json", pathWith("[0,2,0]"));
  EXPECT_EQ(runTool({"cull", kCity, "--path", good}).code, 0);
}

const std::string kFacingTriangle = "v 0 0 -5\nv 1 0 -5\nv 0 1 -5\nf 1 2 3\n";

TEST(Tool, KeysThatAPathDoesNotHaveAreNamed) {
  const TemporaryFolder folder;
  const std::string file = folder.write("walk.json", R"({"fovydeg":90,"author":"me","frames":[
      {"eye":[0,2,0],"forward":[0,0,-1]},
      {"eye":[0,2,0],"forward":[0,0,-1],"upp":[1,0,0]},
      {"eye":[0,2,0],"forward":[0,0,-1],"upp":[1,0,0]}]})");
  const Outcome outcome = runTool({"cull", kCity, "--path", file, "--json", "-"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.errorLines(), 3) << outcome.err;
  for (const std::string words :
       {"walk.json: the key \"fovydeg\" is not known and ignored; did you mean 'fovy_deg'?\n",
        "walk.json: the key \"author\" is not known and ignored\n",
        "walk.json: frame 1 (and 1 more): the key \"upp\" is not known and ignored; did you mean 'up'?\n"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << outcome.err;
  }
  const std::string needed =
      folder.write("needed.json", R"({"frames":[{"eyes":[0,2,0],"forward":[0,0,-1]}]})");
  expectRefused({"cull", kCity, "--path", needed}, "did you mean 'eye'?");
  expectRefused({"cull", kCity, "--path", needed}, "\"eye\" is missing");
}

TEST(Tool, AFileWithoutCameraNeedsAPath) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("triangle.obj", kFacingTriangle);
  EXPECT_EQ(runTool({"info", scene}).code, 0);
  expectRefused({"cull", scene}, "--path");
}

TEST(Tool, ThePathBesideASceneIsUsedAndSaid) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("triangle.obj", kFacingTriangle);
  folder.write("walk.path.json", pathWith("[0,0,0]"));
  const Outcome outcome = runTool({"cull", scene, "--json", "-"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.errorLines(), 1);
  EXPECT_NE(outcome.err.find("walk.path.json"), std::string::npos);
  EXPECT_EQ(parse(outcome.out)["frames"][0]["visible"], nlohmann::json::array({0}));
  folder.write("walk.path.json", "{}");
  expectRefused({"cull", scene}, "walk.path.json");
}

TEST(Tool, OutputThatCannotBeWrittenIsRefusedAndLeavesNothing) {
  const TemporaryFolder folder;
  expectRefused({"info", kCity, "--json", folder.file("no/such/folder.json")}, "folder.json");
  expectRefused({"cull", kCity, "--frames", "0", "--json", folder.file("")}, folder.file(""));
  EXPECT_EQ(folder.entries(), 0u);
  const std::string file = folder.write("there", "old");
  expectRefused({"walk", kCity, "--frames", "0", "-o", file}, "there");
  EXPECT_EQ(contents(file), "old");
}

TEST(Tool, AFailedRunKeepsTheOldFileAndNoHalfOne) {
  const TemporaryFolder folder;
  const std::string file = folder.write("result.json", "old");
  expectRefused({"cull", kCity, "--path", "nowhere", "--json", file}, "nowhere");
  EXPECT_EQ(contents(file), "old");
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_EQ(runTool({"cull", kCity, "--frames", "0", "--json", file}).code, 0);
  EXPECT_TRUE(parse(contents(file)).is_object());
  EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace sightline::tool_test
