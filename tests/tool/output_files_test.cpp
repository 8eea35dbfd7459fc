// No output is an input, another output, or somebody else's file.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

namespace fs = std::filesystem;

const std::string kPaintedTriangle = "mtllib paint.mtl\nv 0 0 -5\nv 1 0 -5\nv 0 1 -5\nusemtl red\nf 1 2 3\n";
const std::string kPaint = "newmtl red\nKd 1 0 0\nmap_Kd -s 1 1 1 red.png\n";
const std::string kTwoFrames =
    R"({"width":64,"height":36,"frames":[{"eye":[0,0,0],"forward":[0,0,-1]},{"eye":[1,0,0],"forward":[0,0,-1]}]})";

class OutputFiles : public ::testing::Test {
 protected:
  // Expects that the command is refused and that no input has changed.
  void expectKept(const std::vector<std::string>& arguments, const std::string& about = "the input itself") {
    const std::size_t before = folder_.entries();
    expectRefused(arguments, about);
    EXPECT_EQ(contents(scene_), kPaintedTriangle) << ::testing::PrintToString(arguments);
    EXPECT_EQ(contents(path_), kTwoFrames) << ::testing::PrintToString(arguments);
    EXPECT_EQ(folder_.entries(), before) << ::testing::PrintToString(arguments);
  }

  TemporaryFolder folder_;
  const std::string scene_ = folder_.write("s.obj", kPaintedTriangle);
  const std::string paint_ = folder_.write("paint.mtl", kPaint);
  const std::string path_ = folder_.write("p.json", kTwoFrames);
};

TEST_F(OutputFiles, OfFramesAreNoInputsAndNoOtherOutputs) {
  const std::string texture = folder_.write("frame_0000.png", "not a picture");
  folder_.write("paint.mtl", "newmtl red\nmap_Kd frame_0000.png\n");
  const std::string folder = fs::path(scene_).parent_path().string();
  expectKept({"walk", scene_, "--path", path_, "-o", folder});
  EXPECT_EQ(contents(texture), "not a picture");
  expectKept({"layers", scene_, "--path", path_, "--image", folder_.file("a.png"), "--json",
              folder_.file("a_0001.png")},
             "a_0001.png");
}

TEST_F(OutputFiles, AreNeverTheSceneOrThePath) {
  for (const std::string command : {"cull", "verify", "layers"}) {
    expectKept({command, scene_, "--path", path_, "--json", path_});
    expectKept({command, scene_, "--path", path_, "--json", scene_});
  }
  expectKept({"walk", scene_, "--path", path_, "--json", path_, "-o", folder_.file("report")});
  expectKept({"reproduce", "coorg-teller", "--scene", scene_, "--path", path_, "--json", path_});
  expectKept({"info", scene_, "--json", scene_});
  expectKept({"bake", scene_, "-o", scene_, "--force"});
  expectKept({"bake", scene_, "-o", folder_.file("F.sight"), "--json", scene_});
}

TEST_F(OutputFiles, AreKnownByWhateverNameOrLink) {
  fs::create_symlink(path_, folder_.file("soft.json"));
  fs::create_hard_link(path_, folder_.file("hard.json"));
  for (const std::string name : {"soft.json", "hard.json", "./p.json"}) {
    expectKept({"cull", scene_, "--path", path_, "--json", folder_.file(name)});
    expectKept({"cull", scene_, "--path", folder_.file(name), "--json", path_});
  }
}

TEST_F(OutputFiles, AreNoFilesThatTheSceneNames) {
  const std::string picture = folder_.write("red.png", "a picture");
  expectKept({"cull", scene_, "--path", path_, "--json", paint_});
  expectKept({"cull", scene_, "--path", path_, "--json", picture});
  EXPECT_EQ(contents(paint_), kPaint);
  EXPECT_EQ(contents(picture), "a picture");
  const std::string buffer = folder_.write("a b.bin", "bytes");
  const std::string gltf = folder_.write(
      "s.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"a%20b.bin","byteLength":5}]})");
  expectKept({"info", gltf, "--json", buffer});
  EXPECT_EQ(contents(buffer), "bytes");
}

TEST_F(OutputFiles, OfASceneThatNamesADeviceAreCheckedAllTheSame) {
  const std::string scene =
      folder_.write("device.obj", "mtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string there = folder_.write("there.json", "{}");
  const Outcome outcome = runTool({"info", scene, "--json", there});
  EXPECT_NE(outcome.code, -1) << "it ended by itself";
  EXPECT_LE(outcome.errorLines(), 1) << outcome.err;
}

// Each reading of the scene's file is 4 MB, so 20,000 of them would take minutes.
TEST_F(OutputFiles, AreCheckedQuicklyWhereASceneNamesAFileOften) {
  std::string text = "mtllib paint.mtl\n";
  for (int i = 0; i < 20'000; ++i) {
    text += "mtllib " + std::string(i % 2 == 0 ? "" : "./") + "often.obj" + std::string(200, ' ') + "\n";
  }
  const std::string scene = folder_.write("often.obj", text);
  const Outcome outcome = runProgram(
      "/bin/sh", {"-c", "ulimit -t 10; exec \"$0\" \"$@\"", toolFile(), "info", scene, "--json", paint_});
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("the input itself"), std::string::npos) << outcome.err;
}

TEST_F(OutputFiles, AreNotThePathBesideTheScene) {
  const std::string beside = folder_.write("walk.path.json", kTwoFrames);
  expectKept({"cull", scene_, "--json", beside});
  EXPECT_EQ(contents(beside), kTwoFrames);
}

TEST_F(OutputFiles, OfAFolderAreNoInputs) {
  const std::string inside = folder_.write("walk.json", kTwoFrames);
  expectKept({"walk", scene_, "--path", inside, "-o", folder_.file(".")});
  EXPECT_EQ(contents(inside), kTwoFrames);
  const std::string tables = folder_.write("reproduce.json", kTwoFrames);
  expectKept({"reproduce", "coorg-teller", "--scene", scene_, "--path", tables, "-o", folder_.file(".")});
  EXPECT_EQ(contents(tables), kTwoFrames);
  expectKept({"walk", scene_, "--path", path_, "-o", path_}, "--output");
}

TEST_F(OutputFiles, OfQueriesAreNoPoints) {
  const std::string baked = folder_.file("F.sight");
  ASSERT_EQ(runTool({"bake", scene_, "-o", baked, "--depth", "1"}).code, 0);
  const std::string points = folder_.write("points.json", R"({"points":[[0,0,0]]})");
  expectKept({"query", baked, "--points", points, "--json", points});
  expectKept({"query", baked, "--points", points, "--json", baked});
  expectKept({"cull", scene_, "--path", path_, "--baked", baked, "--json", baked});
  EXPECT_EQ(contents(points), R"({"points":[[0,0,0]]})");
  EXPECT_EQ(runTool({"query", baked, "--points", points}).code, 0);
}

TEST_F(OutputFiles, OfFramesAreNoReplacements) {
  const std::string png = folder_.write("part_0001.png", "a picture");
  const std::string given = "0=" + png;
  expectKept({"layers", scene_, "--path", path_, "--replace", given, "--image", folder_.file("part.png")});
  expectKept({"layers", scene_, "--path", path_, "--replace", given, "--image", png});
  EXPECT_EQ(contents(png), "a picture");
}

TEST_F(OutputFiles, MayReplaceEarlierResultsAndGoToDevices) {
  const std::string result = folder_.write("result.json", "an earlier result");
  EXPECT_EQ(runTool({"cull", scene_, "--path", path_, "--json", result}).code, 0);
  EXPECT_TRUE(parse(contents(result)).is_object());
  EXPECT_EQ(runTool({"cull", scene_, "--path", path_, "--json", "/dev/null"}).code, 0);
}

TEST_F(OutputFiles, OfBakesReplaceBakedFilesOnly) {
  const std::string precious = folder_.write("precious.txt", "precious");
  const std::string named = folder_.write("named.sight", "not baked");
  expectKept({"bake", scene_, "-o", precious}, "--force");
  expectKept({"bake", scene_, "-o", named}, "--force");
  EXPECT_EQ(contents(precious), "precious");
  EXPECT_EQ(contents(named), "not baked");
  const std::vector<std::string> bake{"bake", scene_, "--depth", "1", "-o"};
  EXPECT_EQ(runTool(joined(bake, {precious, "--force"})).code, 0);
  EXPECT_EQ(runTool(joined(bake, {precious})).code, 0) << "it is a baked file now";
  EXPECT_EQ(runTool(joined(bake, {folder_.write("empty", "")})).code, 0);
}

TEST_F(OutputFiles, OfBakesLeaveAFolderInThePlaceOfTheirPartsAlone) {
  fs::create_directory(folder_.file("F.sight.parts"));
  folder_.write("F.sight.parts/mine", "mine");
  expectKept({"bake", scene_, "-o", folder_.file("F.sight"), "--restart", "--force"}, "F.sight.parts");
  EXPECT_EQ(contents(folder_.file("F.sight.parts/mine")), "mine");
}

}  // namespace
}  // namespace sightline::tool_test
