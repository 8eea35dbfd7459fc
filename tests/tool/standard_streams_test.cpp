// What the tool does where a standard stream is closed or takes nothing: results and exit codes are the same.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

// What a shell says so that stderr is closed, or takes nothing.
const std::vector<std::string> kNoStderr{"2>&-", "2>/dev/full", "<&- 2>&-"};

// Runs the tool with a shell's redirection.
Outcome runRedirected(const std::string& redirection, const std::vector<std::string>& arguments) {
  return runProgram("/bin/sh", joined({"-c", "exec \"$0\" \"$@\" " + redirection, toolFile()}, arguments));
}

TEST(StandardStreams, AnErrorThatCannotBePrintedHasItsExitCode) {
  for (const std::string& none : kNoStderr) {
    EXPECT_EQ(runRedirected(none, {"info", "missing.glb"}).code, 2) << none;
    EXPECT_EQ(runRedirected(none, {"bogus"}).code, 2) << none;
  }
}

TEST(StandardStreams, ANoteThatCannotBePrintedChangesNoResult) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("triangle.obj", "v 0 0 -5\nv 1 0 -5\nv 0 1 -5\nf 1 2 3\n");
  folder.write("walk.path.json", R"({"frames":[{"eye":[0,0,0],"forward":[0,0,-1]}]})");
  const std::string file = folder.file("result.json");
  for (const std::string& none : kNoStderr) {
    EXPECT_EQ(runRedirected(none, {"layers", scene, "--json", file}).code, 0) << none;
    EXPECT_TRUE(parse(contents(file)).is_object()) << none;
    std::filesystem::remove(file);
  }
}

TEST(StandardStreams, NoFileOfABakeTakesThePlaceOfOneThatIsClosed) {
  const TemporaryFolder folder;
  const std::vector<std::string> bake{"bake", "demo:glass", "--depth", "1", "-o"};
  const std::string usual = folder.file("usual.sight"), closed = folder.file("closed.sight");
  ASSERT_EQ(runTool(joined(bake, {usual})).code, 0);
  EXPECT_EQ(runRedirected("<&- 2>&-", joined(bake, {closed})).code, 0);
  EXPECT_EQ(contents(closed), contents(usual));
}

TEST(StandardStreams, AResultThatCannotBePrintedIsAnError) {
  const Outcome outcome = runRedirected(">&-", {"info", "demo:glass", "--json", "-"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "sightline: cannot write to standard output\n");
}

}  // namespace
}  // namespace sightline::tool_test
