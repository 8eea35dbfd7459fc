#pragma once

// Runs the built tool as a user does and returns its output and its exit code.

#include <gtest/gtest.h>
#include <unistd.h>

#include <sys/wait.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace sightline::tool_test {

// A small scene, for tests that need any.
inline const std::string kCity = "demo:city?copies=1";

using test::contents;
using test::TemporaryFolder;

struct Outcome {
  int code = -1;
  std::string out, err;

  std::ptrdiff_t errorLines() const { return std::count(err.begin(), err.end(), '\n'); }
};

inline std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// Runs a program with these arguments, each of which is one word.
inline Outcome runProgram(const std::string& program, const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  std::string command = "'" + program + "'";
  for (const std::string& argument : arguments) {
    command += " '" + argument + "'";  // no test uses a quote
  }
  command += " > '" + folder.file("out") + "' 2> '" + folder.file("err") + "' < /dev/null";
  std::FILE* pipe = popen(command.c_str(), "r");
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder.file("out")),
          contents(folder.file("err"))};
}

// The tool of the build that this test belongs to.
inline std::string toolFile() {
  const auto build = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  return (build / "bin" / "sightline").string();
}

// Runs the tool with these arguments, each of which is one word.
inline Outcome runTool(const std::vector<std::string>& arguments) {
  return runProgram(toolFile(), arguments);
}

// Expects bad usage or input: exit code 2, one line on stderr that mentions `about`, nothing on stdout.
inline void expectRefused(const std::vector<std::string>& arguments, const std::string& about) {
  const Outcome outcome = runTool(arguments);
  const std::string shown = ::testing::PrintToString(arguments) + ": " + outcome.err;
  EXPECT_EQ(outcome.code, 2) << shown;
  EXPECT_EQ(outcome.errorLines(), 1) << shown;
  EXPECT_NE(outcome.err.find(about), std::string::npos) << shown << " does not mention " << about;
  EXPECT_EQ(outcome.out, "") << shown;
}

inline nlohmann::json parse(const std::string& text) {
  return nlohmann::json::parse(text, nullptr, false);
}

// Expects that the tool ended with this code and printed one JSON object, which is returned.
inline nlohmann::json printedJson(const Outcome& outcome, int code = 0) {
  EXPECT_EQ(outcome.code, code) << outcome.err;
  nlohmann::json printed = parse(outcome.out);
  if (!printed.is_object()) {
    throw std::runtime_error("no JSON object was printed but: " + outcome.out.substr(0, 200) + outcome.err);
  }
  return printed;
}

// Runs the tool with these arguments and `--json -`, and returns what it prints.
inline nlohmann::json toolJson(const std::vector<std::string>& arguments, int code = 0) {
  SCOPED_TRACE(::testing::PrintToString(arguments));
  return printedJson(runTool(joined(arguments, {"--json", "-"})), code);
}

}  // namespace sightline::tool_test
