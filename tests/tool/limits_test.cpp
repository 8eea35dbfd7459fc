// What the tool does where a disk is full, memory is short, or a picture would be too large: one line and
// exit code 2, and no half of a file.

#include "tests/support/rounds.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

// Runs the tool where `limit` of the shell's ulimit holds.
Outcome runLimited(const std::string& limit, const Words& arguments) {
  return runProgram("/bin/sh",
                    joined({"-c", "ulimit " + limit + "; exec \"$0\" \"$@\"", toolFile()}, arguments));
}

std::string filesOf(const std::string& folder) {
  std::string names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names += entry.path().filename().string() + " ";
  }
  return names;
}

// Files may have 4 blocks of 512 bytes, as if the disk were full behind them.
void expectFullDiskIsTold(const Words& command, const std::string& file) {
  const TemporaryFolder folder;
  const std::string target = folder.file(file);
  Words words = command;
  words.push_back(target);
  const Outcome outcome = runLimited("-f 4", words);
  const std::string shown = ::testing::PrintToString(command) + ": " + outcome.err;
  EXPECT_EQ(outcome.code, 2) << shown;
  EXPECT_EQ(outcome.errorLines(), 1) << shown;
  EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << shown;
  EXPECT_NE(outcome.err.find(target), std::string::npos) << shown;
  EXPECT_EQ(filesOf(folder.file("")).find("unfinished"), std::string::npos) << filesOf(folder.file(""));
  EXPECT_FALSE(fs::is_regular_file(target)) << shown;
}

TEST(Limits, AFullDiskIsToldByEveryCommandThatWrites) {
  const std::string building = "demo:building?floors=1";
  expectFullDiskIsTold({"info", building, "--json"}, "info.json");
  expectFullDiskIsTold({"cull", building, "--json"}, "cull.json");
  expectFullDiskIsTold(
      {"verify", "demo:glass", "--frames", "0:30", "--width", "64", "--height", "36", "--json"},
      "verify.json");
  expectFullDiskIsTold({"bench", "demo:glass", "--frames", "0:2", "--no-cache", "-o"}, "bench");
  expectFullDiskIsTold({"layers", "demo:glass", "--frames", "0:100", "--json"}, "layers.json");
  expectFullDiskIsTold({"layers", "demo:glass", "--frames", "0", "--svg"}, "drawing.svg");
  expectFullDiskIsTold({"layers", "demo:glass", "--frames", "0", "--pdf"}, "drawing.pdf");
  expectFullDiskIsTold({"walk", "demo:glass", "--frames", "0:20", "--no-pictures", "-o"}, "walk");
  expectFullDiskIsTold({"bake", building, "--depth", "1", "-o"}, "building.sight");
}

TEST(Limits, AFullDiskIsToldWhereverOutputGoes) {
  for (const Words& words : {Words{"info", "demo:glass", "--json"},
                             {"cull", "demo:glass", "--frames", "0", "--json"},
                             {"bench", "demo:glass", "--frames", "0", "--no-cache", "--csv"}}) {
    const Outcome outcome = runTool(joined(words, {"/dev/full"}));
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              "sightline: /dev/full: could not be written completely: No space left on device\n");
  }
  const Outcome printed =
      runProgram("/bin/sh", {"-c", "exec \"$0\" info demo:glass > /dev/full", toolFile()});
  EXPECT_EQ(printed.code, 2);
  EXPECT_EQ(printed.err, "sightline: cannot write to standard output\n");
}

TEST(Limits, WhatIsPreparedAndCannotBeKeptIsOnlyTold) {
  const TemporaryFolder folder;
  const Outcome outcome = runLimited("-f 4", {"cull", "demo:building?floors=1", "--method", "depth-pyramid",
                                              "--frames", "0", "--prepared", folder.file("kept")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
  EXPECT_NE(outcome.err.find("is not kept"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Limits, TooLittleMemoryIsTold) {
  if (test::sanitized()) {
    GTEST_SKIP() << "AddressSanitizer reserves more address space for itself than the limit allows";
  }
  const Outcome outcome = runLimited("-v 700000", {"info", "demo:boxes?boxes=1000000"});
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(outcome.err, "sightline: out of memory: the scene or the result is too large for this machine\n");
  // 60 million vertices, which the limits of a file allow, by 20,000 nodes with one mesh.
  const TemporaryFolder folder;
  std::string nodes, roots;
  for (int i = 0; i < 20'000; ++i) {
    nodes += std::string(i == 0 ? "" : ",") + R"({"mesh":0})";
    roots += (i == 0 ? "" : ",") + std::to_string(i);
  }
  folder.write("s.bin", std::string(12 * 3000, '\0'));
  const std::string file = folder.write(
      "s.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" + nodes +
                    R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                    R"("accessors":[{"bufferView":0,"componentType":5126,"count":3000,"type":"VEC3"}],)"
                    R"("bufferViews":[{"buffer":0,"byteLength":36000}],)"
                    R"("buffers":[{"uri":"s.bin","byteLength":36000}]})");
  const Outcome scene = runLimited("-v 700000", {"info", file});
  EXPECT_EQ(scene.code, 2) << scene.err;
  EXPECT_EQ(scene.err, "sightline: " + file + ": out of memory: the scene is too large for this machine\n");
}

TEST(Limits, PicturesThatAreTooLargeAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "large.json", R"({"width":65536,"height":65536,"frames":[{"eye":[0,2,0],"forward":[0,0,-1]}]})");
  for (const Words& words : {Words{"walk", "demo:glass", "-o", folder.file("report")},
                             {"layers", "demo:glass", "--image", folder.file("out.png")}}) {
    expectRefused(joined(words, {"--path", path}), "each side must be 1 to");
  }
  expectRefused({"walk", "demo:glass", "-o", folder.file("report"), "--width", "16385"}, "16384");
  expectRefused({"verify", "demo:glass", "--height", "16385"}, "16384");
  EXPECT_EQ(folder.entries(), 1u) << "nothing was made";
}

}  // namespace
}  // namespace sightline::tool_test
