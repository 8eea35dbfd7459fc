// Commands that are told to end in the middle say so, leave nothing half done, and end with 128 + the signal.

#include <chrono>
#include <thread>

#include "tests/support/pictures.h"
#include "tests/tool/start_tool.h"

namespace sightline::tool_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

bool waitForFile(Started& tool, const std::string& file) {
  while (tool.running() && !fs::exists(file)) {
    std::this_thread::sleep_for(milliseconds(1));
  }
  return fs::exists(file);
}

// Interrupts a command that takes minutes, later and later until it is ready for signals.
Outcome interrupted(const std::vector<std::string>& arguments, int signal) {
  for (milliseconds delay(100);; delay *= 2) {
    Started tool(toolWords(0, arguments));
    std::this_thread::sleep_for(delay);
    tool.kill(signal);
    const Outcome outcome = tool.wait();
    if (outcome.code != -1) {
      return outcome;
    }
  }
}

TEST(Interrupted, CommandsSayThatNothingWasWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"verify", "demo:city"},
                                                  {"bench", "demo:city", "--no-cache", "--repeats", "10000"},
                                                  {"layers", "demo:toothpicks?n=1600"}}) {
      const TemporaryFolder folder;
      const Outcome outcome = interrupted(joined(words, {"--json", folder.file("result.json")}), signal);
      EXPECT_EQ(outcome.code, 128 + signal) << outcome.err;
      EXPECT_EQ(outcome.err, "sightline: " + words[0] + " was interrupted; nothing was written\n");
      EXPECT_EQ(outcome.out, "");
      EXPECT_EQ(folder.entries(), 0u);
    }
  }
}

TEST(Interrupted, CommandsNameWhatWasWrittenBefore) {
  const TemporaryFolder folder;
  const std::string prepared = folder.file("prepared");
  Started tool(toolWords(0, {"verify", "demo:city?copies=1", "--method", "depth-pyramid", "--prepared",
                             prepared, "--json", folder.file("result.json")}));
  ASSERT_TRUE(waitForFile(tool, prepared));
  tool.kill(SIGINT);
  const Outcome outcome = tool.wait();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(outcome.err, "sightline: verify was interrupted; written so far: " + prepared + "\n");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Interrupted, FoldersThatWereMadeAndAreEmptyAreRemoved) {
  const TemporaryFolder folder;
  Started tool(toolWords(0, {"reproduce", "coorg-teller", "-o", folder.file("new/report")}));
  ASSERT_TRUE(waitForFile(tool, folder.file("new/report")));
  tool.kill(SIGINT);
  const Outcome outcome = tool.wait();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Interrupted, FoldersThatWereThereStay) {
  const TemporaryFolder folder;
  fs::create_directory(folder.file("report"));
  EXPECT_EQ(interrupted({"reproduce", "coorg-teller", "-o", folder.file("report")}, SIGINT).code, 130);
  EXPECT_TRUE(fs::exists(folder.file("report")));
}

TEST(Interrupted, AWalkReportsTheFramesBefore) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  for (milliseconds delay(250);; delay *= 2) {
    const TemporaryFolder folder;
    const std::string report = folder.file("report");
    Started tool(toolWords(
        0, {"walk", "demo:city", "-o", report, "--width", "320", "--height", "180", "--frames", "0:400"}));
    ASSERT_TRUE(waitForFile(tool, report));
    std::this_thread::sleep_for(delay);
    tool.kill(SIGINT);
    const Outcome outcome = tool.wait();
    ASSERT_EQ(outcome.code, 130) << outcome.err << outcome.out;
    ASSERT_EQ(outcome.errorLines(), 1) << outcome.err;
    if (!fs::exists(report)) {
      EXPECT_NE(outcome.err.find("nothing was written"), std::string::npos) << outcome.err;
      continue;  // no frame was done yet
    }
    const nlohmann::json walk = parse(contents(report + "/walk.json"));
    const std::size_t frames = walk["runs"][0]["frames"].size();
    EXPECT_GE(frames, 1u);
    EXPECT_LT(frames, 400u);
    EXPECT_EQ(walk["runs"][1]["frames"].size(), frames);
    EXPECT_NE(outcome.err.find(" " + std::to_string(frames) + " of 400 frames"), std::string::npos)
        << outcome.err;
    EXPECT_NE(contents(report + "/index.html").find("INTERRUPTED"), std::string::npos);
    break;
  }
}

// Whatever the moment, what is there is whole.
TEST(Interrupted, FilesAreWholeOrAbsentWheneverTheSignalComes) {
  const std::vector<std::string> scene{"demo:building?floors=1"};
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"info", scene[0], "--json", "@a.json"},
        {"cull", scene[0], "--frames", "0:100", "--json", "@a.json"},
        {"cull", scene[0], "--method", "depth-pyramid", "--frames", "0:9", "--prepared", "@kept", "--json",
         "@a.json"},
        {"bench", scene[0], "--frames", "0:2", "--repeats", "1", "--no-cache", "-o", "@bench"},
        {"walk", scene[0], "--frames", "0:60", "--no-pictures", "-o", "@walk"}}) {
    for (const int delay : {20, 60, 120, 250}) {
      const TemporaryFolder folder;
      std::vector<std::string> arguments = words;
      for (std::string& word : arguments) {
        word = word[0] == '@' ? folder.file(word.substr(1)) : word;
      }
      Started tool(toolWords(0, arguments));
      std::this_thread::sleep_for(milliseconds(delay));
      tool.kill(SIGTERM);
      const Outcome outcome = tool.wait();
      const std::string shown = ::testing::PrintToString(arguments) + outcome.err;
      EXPECT_TRUE(outcome.code == 0 || outcome.code == 143 || outcome.code == -1) << shown;
      for (const auto& entry : fs::recursive_directory_iterator(folder.file(""))) {
        const std::string name = entry.path().filename().string();
        EXPECT_EQ(name.find("unfinished"), std::string::npos) << shown << name;
        if (entry.path().extension() == ".json") {
          EXPECT_FALSE(parse(contents(entry.path().string())).is_discarded()) << shown << name;
        }
      }
      if (fs::exists(folder.file("kept"))) {
        const Outcome again = runTool({"cull", scene[0], "--method", "depth-pyramid", "--frames", "0",
                                       "--prepared", folder.file("kept")});
        EXPECT_EQ(again.code, 0);
        EXPECT_EQ(again.err, "") << "the surfaces are read";
      }
    }
  }
}

TEST(Interrupted, DrawingsOfFramesAreWholeOrAbsent) {
  const TemporaryFolder folder;
  Started tool(toolWords(
      0, {"layers", "demo:toothpicks", "--svg", folder.file("a.svg"), "--json", folder.file("order.json")}));
  ASSERT_TRUE(waitForFile(tool, folder.file("a_0001.svg")));
  tool.kill(SIGTERM);
  const Outcome outcome = tool.wait();
  EXPECT_EQ(outcome.code, 143) << outcome.err;
  EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
  for (std::size_t frame = 0; frame < folder.entries(); ++frame) {
    const std::string digits = std::to_string(frame);
    const std::string svg =
        contents(folder.file("a_" + std::string(4 - digits.size(), '0') + digits + ".svg"));
    ASSERT_GE(svg.size(), 7u) << "files are those of the first frames and no others";
    EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
  }
}

}  // namespace
}  // namespace sightline::tool_test
