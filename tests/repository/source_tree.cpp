#include "tests/repository/source_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

namespace sightline::repository {
namespace {

namespace fs = std::filesystem;

// Empty when this is no checkout, or git will not read it.
std::vector<std::string> trackedFiles() {
  if (!fs::exists(sourceRoot() / ".git")) {
    return {};
  }
  const std::string command = "git -C '" + sourceRoot().string() + "' ls-files -z 2> /dev/null";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return {};
  }
  std::string names;
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
    names.append(buffer, n);
  }
  pclose(pipe);
  std::vector<std::string> files;
  std::istringstream stream(names);
  for (std::string file; std::getline(stream, file, '\0');) {
    if (fs::is_regular_file(sourceRoot() / file)) {  // deleted, but not yet committed
      files.push_back(file);
    }
  }
  return files;
}

std::vector<std::string> exportedFiles() {
  std::set<std::string> ignored{".git"};
  std::istringstream lines(contentOf(".gitignore"));
  for (std::string line; std::getline(lines, line);) {
    line.erase(std::remove(line.begin(), line.end(), '/'), line.end());
    ignored.insert(line);
  }
  std::vector<std::string> files;
  for (auto it = fs::recursive_directory_iterator(sourceRoot()); it != fs::recursive_directory_iterator();
       ++it) {
    if (it->is_directory() && ignored.contains(it->path().filename().string())) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(fs::relative(it->path(), sourceRoot()).generic_string());
    }
  }
  return files;
}

}  // namespace

fs::path sourceRoot() {
  return SIGHTLINE_SOURCE_DIR;
}

std::vector<std::string> projectFiles() {
  std::vector<std::string> files = trackedFiles();
  if (files.empty()) {
    files = exportedFiles();
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string contentOf(const std::string& file) {
  std::ifstream stream(sourceRoot() / file, std::ios::binary);
  EXPECT_TRUE(stream.good()) << "cannot read " << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::vector<Include> includesOf(const std::string& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*(["<])([^">]+)[">])");
  std::vector<Include> includes;
  std::istringstream lines(contentOf(file));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::smatch match;
    if (std::regex_search(line, match, pattern)) {
      includes.push_back({file, number, match[2], match[1] == "\""});
    }
  }
  return includes;
}

}  // namespace sightline::repository
