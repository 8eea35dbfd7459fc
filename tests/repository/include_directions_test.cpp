// The layers of the code: each room includes only rooms below it. See docs/architecture.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/repository/source_tree.h"

namespace sightline::repository {
namespace {

// Rooms are listed from the bottom to the top.
constexpr std::array<std::string_view, 15> kRooms{
    "base",  "math",   "geometry", "scene", "hierarchy", "occluders", "occlusion", "culling",
    "world", "layers", "drawing",  "pvs",   "io",        "render",    "comparison"};
constexpr std::size_t kRuntimeRooms = 9;  // the first of them make sightline::runtime

std::optional<std::size_t> levelOf(std::string_view room) {
  const auto* found = std::find(kRooms.begin(), kRooms.end(), room);
  if (found == kRooms.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - kRooms.begin());
}

bool startsWith(const std::string& text, std::string_view prefix) {
  return text.rfind(prefix, 0) == 0;
}

// What stands between `prefix` and the next slash, when `path` begins so.
std::optional<std::string> roomAfter(const std::string& path, std::string_view prefix) {
  const std::size_t slash = path.find('/', prefix.size());
  if (!startsWith(path, prefix) || slash == std::string::npos) {
    return std::nullopt;
  }
  return path.substr(prefix.size(), slash - prefix.size());
}

struct RoomFile {
  std::string file;
  std::string room;
  bool is_public = false;  // in include/
};

// The C++ files of include/ and src/.
std::vector<RoomFile> roomFiles() {
  std::vector<RoomFile> files;
  for (const std::string& file : projectFiles()) {
    const std::string extension = std::filesystem::path(file).extension();
    if (extension != ".h" && extension != ".cpp") {
      continue;
    }
    if (const auto room = roomAfter(file, "include/sightline/")) {
      files.push_back({file, *room, true});
    } else if (const auto source_room = roomAfter(file, "src/")) {
      files.push_back({file, *source_room, false});
    }
  }
  return files;
}

std::string where(const Include& include) {
  return include.file + ":" + std::to_string(include.line) + " includes " + include.target + ": ";
}

bool standardHeader(const Include& include) {
  return !include.quoted && include.target.find_first_of("/.") == std::string::npos;
}

// The room whose header a line includes, written from the root: "sightline/ROOM/x.h" is public and lies in
// include/, "src/ROOM/x.h" is private. Nothing for anything else and for what is not there.
std::optional<std::string> includedRoom(const Include& include) {
  namespace fs = std::filesystem;
  if (!include.quoted || include.target.find("..") != std::string::npos) {
    return std::nullopt;
  }
  if (fs::exists(sourceRoot() / "include" / include.target)) {
    return roomAfter(include.target, "sightline/");
  }
  return fs::exists(sourceRoot() / include.target) ? roomAfter(include.target, "src/") : std::nullopt;
}

TEST(IncludeDirections, EveryFileLiesInAKnownRoom) {
  const std::vector<RoomFile> files = roomFiles();
  ASSERT_GT(files.size(), 20u) << "the sources were not found";
  for (const RoomFile& file : files) {
    EXPECT_TRUE(levelOf(file.room)) << file.file << ": the room '" << file.room
                                    << "' has no place in the layers";
  }
}

TEST(IncludeDirections, ARoomIncludesOnlyItselfAndRoomsBelow) {
  for (const RoomFile& file : roomFiles()) {
    for (const Include& include : includesOf(file.file)) {
      if (!include.quoted) {
        EXPECT_FALSE(startsWith(include.target, "sightline/"))
            << where(include) << "our own headers stand in quotes";
        continue;
      }
      const auto room = includedRoom(include);
      ASSERT_TRUE(room && levelOf(*room))
          << where(include) << "not a header of the library; others stand in angle brackets";
      EXPECT_LE(levelOf(*room), levelOf(file.room)) << where(include) << *room << " lies above " << file.room;
    }
  }
}

TEST(IncludeDirections, TheLibraryKnowsNeitherScenesNorToolsNorTests) {
  for (const RoomFile& file : roomFiles()) {
    for (const Include& include : includesOf(file.file)) {
      for (const char* outside :
           {"oracle/", "scenes/", "tools/", "tests/", "bench/", "viewer/", "examples/"}) {
        EXPECT_FALSE(startsWith(include.target, outside))
            << where(include) << "the library knows nothing of it";
      }
    }
  }
}

TEST(IncludeDirections, TheRuntimeUsesTheStandardLibraryAndHighwayAlone) {
  for (const RoomFile& file : roomFiles()) {
    if (levelOf(file.room).value_or(kRooms.size()) >= kRuntimeRooms) {
      continue;
    }
    for (const Include& include : includesOf(file.file)) {
      if (!include.quoted) {
        // The system's own call for large pages, where there is one; and what only the rooms of files
        // include.
        const bool of_system = (include.target == "sys/mman.h" && file.file.ends_with("large_vector.cpp")) ||
                               ((include.target == "fcntl.h" || include.target == "unistd.h") &&
                                file.file == "src/base/new_file.h");
        EXPECT_TRUE(standardHeader(include) || startsWith(include.target, "hwy/") || of_system)
            << where(include) << "third party";
      }
    }
  }
}

TEST(IncludeDirections, PublicHeadersNameNoOtherLibrary) {
  for (const RoomFile& file : roomFiles()) {
    for (const Include& include : includesOf(file.file)) {
      if (file.is_public && !include.quoted) {
        EXPECT_TRUE(standardHeader(include))
            << where(include) << "a caller would need that library's headers";
      }
    }
  }
}

// The baker and the look-up share the plain data of the file, and no code.
TEST(IncludeDirections, TheBakerAndTheLookUpShareOnlyTheFormat) {
  for (const RoomFile& file : roomFiles()) {
    for (const Include& include : includesOf(file.file)) {
      for (const auto& [from, to] :
           {std::pair("pvs/bake/", "pvs/query/"), std::pair("pvs/query/", "pvs/bake/"),
            std::pair("pvs/format/", "pvs/bake/"), std::pair("pvs/format/", "pvs/query/")}) {
        EXPECT_FALSE(file.file.find(from) != std::string::npos &&
                     include.target.find(to) != std::string::npos)
            << where(include) << "through pvs/format only";
      }
    }
  }
}

// A program links the methods that it makes: neither the culler nor a method refers to another method.
TEST(IncludeDirections, MethodsOfCullingKnowNothingOfEachOther) {
  std::size_t methods = 0;
  for (const RoomFile& file : roomFiles()) {
    if (file.room != "culling" || std::filesystem::path(file.file).extension() != ".cpp") {
      continue;
    }
    const std::string own = std::filesystem::path(file.file).stem().string() + ".h";
    for (const Include& include : includesOf(file.file)) {
      const std::string name = std::filesystem::path(include.target).filename().string();
      if (name.ends_with("_method.h") && name != "culling_method.h") {
        EXPECT_EQ(name, own) << where(include);
        ++methods;
      }
    }
  }
  EXPECT_GE(methods, 6u);
}

// Sorting stands beside culling: neither knows of the other.
TEST(IncludeDirections, LayersKnowNothingOfCulling) {
  for (const RoomFile& file : roomFiles()) {
    for (const Include& include : includesOf(file.file)) {
      const auto room = includedRoom(include);
      if (!room) {
        continue;
      }
      if (file.room == "layers") {
        EXPECT_TRUE(*room == "layers" || levelOf(*room) <= levelOf("scene")) << where(include);
      } else {
        EXPECT_TRUE(*room != "layers" || file.room == "drawing" || file.room == "render" ||
                    file.room == "comparison")
            << where(include);
      }
    }
  }
}

// It judges the culler, so it may share the scene with it and nothing else.
TEST(IncludeDirections, TheOracleKnowsOnlyTheScene) {
  for (const std::string& file : projectFiles()) {
    if (!startsWith(file, "oracle/") || file == "oracle/CMakeLists.txt") {
      continue;
    }
    for (const Include& include : includesOf(file)) {
      if (const auto room = roomAfter(include.target, "sightline/")) {
        EXPECT_TRUE(*room == "base" || *room == "math" || *room == "scene")
            << where(include) << "not independent";
      }
    }
  }
}

// What exists only to reproduce a paper's experiments is in a folder of its own: the rest of the tool does
// without it.
TEST(IncludeDirections, NothingButItsTestsIncludesWhatReproducesPapers) {
  for (const std::string& file : projectFiles()) {
    const std::string extension = std::filesystem::path(file).extension();
    if ((extension != ".h" && extension != ".cpp") || startsWith(file, "tools/sightline/reproduce/") ||
        startsWith(file, "tests/tool/")) {
      continue;
    }
    for (const Include& include : includesOf(file)) {
      EXPECT_FALSE(startsWith(include.target, "tools/sightline/reproduce/")) << where(include);
    }
  }
}

}  // namespace
}  // namespace sightline::repository
