#pragma once

// The project's own files, as the tests about the repository read them.

#include <filesystem>
#include <string>
#include <vector>

namespace sightline::repository {

std::filesystem::path sourceRoot();

// Every file under version control, relative to the root, ascending. In a tree that was exported without its
// history: every file but those in the folders that .gitignore names.
std::vector<std::string> projectFiles();

// The whole file; fails the running test when it cannot be read.
std::string contentOf(const std::string& file);

struct Include {
  std::string file;  // that holds the line
  int line = 0;
  std::string target;  // between the quotes or angle brackets
  bool quoted = false;
};

// The #include lines of one file.
std::vector<Include> includesOf(const std::string& file);

}  // namespace sightline::repository
