// How the tool introduces itself: help, version, near words, the manual, completion.

#include <cstdlib>
#include <sstream>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

const std::vector<std::string> kCommands{"info", "walk",  "cull",  "verify", "bench", "reproduce",
                                         "bake", "check", "query", "layers", "help",  "version"};

TEST(FrontDoor, ListsTheCommandsWithoutBeingAskedFurther) {
  const Outcome alone = runTool({}), help = runTool({"help"}), option = runTool({"--help"});
  for (const Outcome& outcome : {alone, help, option}) {
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    for (const std::string& command : kCommands) {
      EXPECT_NE(outcome.out.find("\n  " + command + " "), std::string::npos) << command;
    }
    EXPECT_EQ(outcome.out.find("\n  manual"), std::string::npos);
  }
  EXPECT_EQ(alone.out, help.out);
  EXPECT_EQ(alone.out, option.out);
}

TEST(FrontDoor, HelpOfACommandIsItsHelp) {
  for (const std::string& command : kCommands) {
    const Outcome help = runTool({"help", command});
    EXPECT_EQ(help.code, 0) << help.err;
    EXPECT_NE(help.out.find("sightline " + command), std::string::npos) << help.out;
    const Outcome option = runTool({command, "--help"});
    EXPECT_EQ(option.code, 0) << command;
    EXPECT_EQ(option.err, "") << command;
    EXPECT_EQ(option.out, help.out);
  }
  expectRefused({"help", "wlak"}, "did you mean 'walk'?");
}

TEST(FrontDoor, TellsItsVersionEitherWay) {
  const Outcome option = runTool({"--version"}), command = runTool({"version"});
  EXPECT_EQ(command.code, 0);
  EXPECT_EQ(option.out, command.out);
  EXPECT_EQ(option.out.substr(0, 10), "sightline ");
}

TEST(FrontDoor, NamesTheWordThatIsMeant) {
  const std::string city = "demo:city?copies=1";
  expectRefused({"wlak", city}, "did you mean 'walk'?");
  expectRefused({"culll", city}, "did you mean 'cull'?");
  expectRefused({"cull", city, "--metod", "frustum"}, "did you mean '--method'?");
  expectRefused({"cull", city, "--metod=frustum"}, "did you mean '--method'?");
  expectRefused({"walk", city, "--outptu", "report"}, "did you mean '--output'?");
  expectRefused({"cull", city, "--method", "oclusion-tree"}, "did you mean 'occlusion-tree'?");
  expectRefused({"verify", city, "--method", "frustum,depth_pyramid"}, "did you mean 'depth-pyramid'?");
  expectRefused({"cull", city, "--variant", "fse"}, "did you mean 'FSE'?");
  expectRefused({"layers", city, "--sort", "depthfirst"}, "did you mean 'depth-first'?");
  expectRefused({"bake", city, "-o", "never.sight", "--databases", "first-hits"},
                "did you mean 'first-hit'?");
  expectRefused({"reproduce", "coorg-tellr"}, "did you mean 'coorg-teller'?");
  expectRefused({"--verison"}, "did you mean '--version'?");
  EXPECT_EQ(runTool({"zzzzz"}).err.find("did you mean"), std::string::npos);
  EXPECT_EQ(runTool({"cull", city, "--zzzzz"}).err.find("did you mean"), std::string::npos);
}

TEST(FrontDoor, CommandsTakeNoOptionThatTheyIgnore) {
  expectRefused({"layers", "demo:toothpicks?n=10", "--frames", "0", "--threads", "64"}, "--threads");
  expectRefused({"reproduce", "snyder-lengyel", "--threads", "8"}, "--threads");
  const TemporaryFolder folder;
  const auto layers = [&](const std::vector<std::string>& more) {
    return joined({"layers", "demo:toothpicks?n=10", "--frames", "0"}, more);
  };
  const std::string png = folder.file("a.png"), svg = folder.file("a.svg");
  const auto blurred = [&](const std::string& method, const std::vector<std::string>& more) {
    return joined(layers({"--depth-of-field", method, "--focus", "3", "--aperture", "0.1", "--blurred", png}),
                  more);
  };
  expectRefused(blurred("potmesil", {"--passes", "9"}), "--passes");
  expectRefused(blurred("layers", {"--reference-passes", "9"}), "--compare");
  expectRefused(layers({"--svg", svg, "--crease", "20", "--no-creases"}), "--crease");
  const std::string file = folder.file("F.sight");
  ASSERT_EQ(runTool({"bake", "demo:building?floors=1", "-o", file, "--depth", "1"}).code, 0);
  expectRefused({"info", file, "--threads", "8"}, "--threads");
}

// Whether a command line can be run; its output goes to `output`.
int run(const std::string& command, std::string& output) {
  const TemporaryFolder folder;
  const int status = std::system((command + " > '" + folder.file("out") + "' 2>&1").c_str());
  output = contents(folder.file("out"));
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(FrontDoor, TheManualTellsAllAndRendersWithoutWarnings) {
  const TemporaryFolder folder;
  const Outcome manual = runTool({"manual"});
  ASSERT_EQ(manual.code, 0);
  const std::string page = folder.write("sightline.1", manual.out);
  for (const std::string word :
       {"\\-\\-method", "\\-\\-resume", "occlusion\\-tree", "coorg\\-teller", "143"}) {
    EXPECT_NE(manual.out.find(word), std::string::npos) << word;
  }
  std::string output;
  // Only groff can judge the page; scripts/setup installs it, but not where packages are provided otherwise.
  if (run("command -v groff", output) != 0) {
    GTEST_SKIP() << "groff is not there to render the manual";
  }
  EXPECT_EQ(run("groff -man -ww -z -T utf8 '" + page + "'", output), 0);
  EXPECT_EQ(output, "");
}

// What bash offers when Tab is pressed behind the last word.
std::vector<std::string> completed(const std::vector<std::string>& words) {
  const TemporaryFolder folder;
  std::string script = runTool({"completion", "bash"}).out + "\nCOMP_WORDS=(sightline";
  for (const std::string& word : words) {
    script += " '" + word + "'";
  }
  script +=
      ")\nCOMP_CWORD=" + std::to_string(words.size()) + "\n_sightline\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
  std::string output;
  EXPECT_EQ(run("bash --norc '" + folder.write("script", script) + "'", output), 0) << output;
  std::vector<std::string> lines;
  std::istringstream stream(output);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

TEST(FrontDoor, BashCompletesCommandsOptionsWordsAndFiles) {
  std::string ignored;
  // The script is for bash alone, and some builds of bash leave out its programmable completion.
  if (run("bash -c 'type compgen mapfile'", ignored) != 0) {
    GTEST_SKIP() << "bash with its completion is not there";
  }
  using Words = std::vector<std::string>;
  EXPECT_EQ(completed({"ver"}), (Words{"verify", "version"}));
  EXPECT_EQ(completed({"cull", "--json-is-not"}), Words{""});
  EXPECT_EQ(completed({"cull", "--lam"}), Words{"--lambda-steps"});
  EXPECT_EQ(completed({"cull", "demo:city", "--method", "o"}), (Words{"occlusion-tree", "opacity-map"}));
  EXPECT_EQ(completed({"cull", "demo:city", "--method", "=", "de"}), Words{"depth-pyramid"});
  EXPECT_EQ(completed({"walk", "demo:city", "--method", "frustum,de"}), Words{"frustum,depth-pyramid"});
  EXPECT_EQ(completed({"reproduce", "s"}), (Words{"saona-vazquez", "snyder-lengyel"}));
  EXPECT_EQ(completed({"help", "qu"}), Words{"query"});
  EXPECT_EQ(completed({"be"}), Words{"bench"});
  EXPECT_EQ(completed({"bench", "demo:city", "--no-c"}), Words{"--no-cache"});
  EXPECT_EQ(completed({"cull", "demo:city", "--frames", ""}), Words{""});
  const TemporaryFolder folder;
  const std::string scene = folder.write("a scene.glb", "");
  EXPECT_EQ(completed({"cull", folder.file("a")}), Words{scene});
  EXPECT_EQ(completed({"reproduce", "poon-wang", "--json", folder.file("a")}), Words{scene});
  EXPECT_EQ(completed({"walk", scene, "-o", folder.file("a")}), Words{""}) << "a file is no folder";
}

}  // namespace
}  // namespace sightline::tool_test
