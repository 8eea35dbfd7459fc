#pragma once

// Runs the built tool as a user does and returns its output and its exit code.

#include <gtest/gtest.h>
#include <unistd.h>

#include <sys/wait.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sightline::tool_test {

// A small scene, for tests that need any.
inline const std::string kCity = "demo:city?copies=1";

// A new folder that the destructor removes.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "sightline-tool-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }
  std::size_t entries() const {
    const auto all = std::filesystem::directory_iterator(path_);
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

 private:
  std::filesystem::path path_;
};

inline std::string contents(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

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

// The same, but only once in a process for the same arguments: for tests of one suite that look at the same
// report.
inline const Outcome& runToolOnce(const std::vector<std::string>& arguments) {
  static std::map<std::vector<std::string>, Outcome> outcomes;
  const auto found = outcomes.find(arguments);
  return found != outcomes.end() ? found->second
                                 : outcomes.emplace(arguments, runTool(arguments)).first->second;
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

}  // namespace sightline::tool_test
