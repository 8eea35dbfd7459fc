// Which namespaces a folder's files open. See docs/architecture.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/repository/source_tree.h"

namespace sightline::repository {
namespace {

// The named namespaces that a file opens, outer ones first: "sightline", "sightline::layers". A namespace
// within another counts with its full name. Aliases and unnamed namespaces do not count.
std::vector<std::string> openedNamespaces(const std::string& file) {
  static const std::regex kOpened(R"(^\s*(?:inline\s+)?namespace\s+([\w:]+)\s*\{.*)");
  static const std::regex kClosed(R"(^\s*\}\s*//\s*namespace\s+[\w:]+\s*$)");
  static const std::regex kForwardDeclaration(R"(^\s*(?:class|struct)\s+\w+;\s*$)");
  std::vector<std::string> opened, open;
  std::istringstream lines(contentOf(file));
  bool after_declaration = false;
  for (std::string line; std::getline(lines, line);) {
    // A short namespace of forward declarations ends without a comment.
    const bool closed = std::regex_match(line, kClosed) || (after_declaration && line == "}");
    after_declaration = std::regex_match(line, kForwardDeclaration);
    std::smatch match;
    if (std::regex_match(line, match, kOpened)) {
      opened.push_back(open.empty() ? match.str(1) : open.back() + "::" + match.str(1));
      open.push_back(opened.back());
    } else if (closed && !open.empty()) {
      open.pop_back();
    }
  }
  return opened;
}

bool isWithin(const std::string& name, const std::string& outer) {
  return name == outer || name.rfind(outer + "::", 0) == 0;
}

// The folder of a path of "FIRST/SECOND/..." at this depth; empty where the path ends before it.
std::string folderAt(const std::string& path, std::size_t depth) {
  std::vector<std::string> parts;
  for (const std::filesystem::path& part : std::filesystem::path(path)) {
    parts.push_back(part.string());
  }
  return depth + 1 < parts.size() ? parts[depth] : "";
}

// The namespace of what a file keeps private: of src/ROOM/ and include/sightline/ROOM/ it is sightline::ROOM.
// Empty for files of other folders.
std::string privateNamespace(const std::string& file) {
  const std::string top = folderAt(file, 0);
  if (top == "src") {
    return "sightline::" + folderAt(file, 1);
  }
  if (top == "include") {
    return "sightline::" + folderAt(file, 2);
  }
  if (top == "tools") {
    return "sightline::tool";
  }
  return top == "scenes" || top == "oracle" ? "sightline::" + top : "";
}

bool isSource(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  return extension == ".h" || extension == ".cpp";
}

// The types and functions whose lines begin at the left margin; of a type within another, as "Outer::Inner",
// the outer one.
std::set<std::string> namesAtTheMargin(const std::string& file) {
  static const std::regex kType(R"(^(?:template\s*<.*>\s*)?(?:enum\s+)?(?:class|struct)\s+(\w+).*)");
  static const std::regex kAlias(R"(^using\s+(\w+)\s*=.*)");
  static const std::regex kFunction(R"(^(?!template|using|namespace|static_assert)[A-Za-z][^(=]*?(\w+)\(.*)");
  std::set<std::string> names;
  std::istringstream lines(contentOf(file));
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kType) || std::regex_match(line, match, kAlias) ||
        std::regex_match(line, match, kFunction)) {
      names.insert(match.str(1));
    }
  }
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(Namespaces, AFileOpensThatOfTheLibraryAndThatOfItsRoomAlone) {
  std::size_t files = 0;
  for (const std::string& file : projectFiles()) {
    const std::string own = isSource(file) ? privateNamespace(file) : "";
    if (own.empty()) {
      continue;
    }
    ++files;
    for (const std::string& name : openedNamespaces(file)) {
      // Highway compiles a kernel once for each instruction set, in a namespace of its own each time.
      EXPECT_TRUE(name == "sightline" || isWithin(name, own) || name == "std" || name == "CLI")
          << file << " opens namespace " << name << "; private names of this folder are in " << own;
    }
  }
  EXPECT_GT(files, 20u) << "the sources were not found";
}

// A private header may say in the library's namespace what a public header has only named: the members of a
// class, or an interface.
TEST(Namespaces, APrivateHeaderDefinesNothingInThatOfTheLibraryThatNoPublicHeaderDeclares) {
  std::set<std::string> public_names;
  std::vector<std::string> private_headers;
  for (const std::string& file : projectFiles()) {
    if (std::filesystem::path(file).extension() != ".h") {
      continue;
    }
    if (folderAt(file, 0) == "include") {
      public_names.merge(namesAtTheMargin(file));
    } else if (folderAt(file, 0) == "src" && contains(openedNamespaces(file), "sightline")) {
      private_headers.push_back(file);
    }
  }
  EXPECT_GT(public_names.size(), 100u) << "the public headers were not found";
  EXPECT_FALSE(private_headers.empty()) << "src/layers/extents/candidate_search.h was not found";
  for (const std::string& file : private_headers) {
    for (const std::string& name : namesAtTheMargin(file)) {
      EXPECT_TRUE(public_names.count(name) > 0)
          << file << " defines " << name << ", which is private to " << privateNamespace(file);
    }
  }
}

TEST(Namespaces, OnlyHighwayAndScenesAndToolsDivideTheirsFurther) {
  for (const std::string& file : projectFiles()) {
    const std::string own = isSource(file) ? privateNamespace(file) : "";
    if (own.empty() || folderAt(file, 0) == "scenes" || folderAt(file, 0) == "tools") {
      continue;
    }
    for (const std::string& name : openedNamespaces(file)) {
      const bool divided = name != own && isWithin(name, own);
      EXPECT_TRUE(!divided || name == own + "::HWY_NAMESPACE") << file << " opens namespace " << name;
    }
  }
}

}  // namespace
}  // namespace sightline::repository
