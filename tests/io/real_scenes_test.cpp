// The folder of real scenes: counts as its README.md states them, and the walks beside them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "sightline/io/camera_path_json.h"
#include "tests/io/scene_checks.h"
#include "tests/support/real_scenes.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

struct Counts {
  std::size_t objects = 0, triangles = 0;
};

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    parts.push_back(part);
  }
  return parts;
}

std::size_t number(std::string text) {
  std::erase(text, ',');
  return std::strtoull(text.c_str(), nullptr, 10);
}

// Rows "| name, name | kind | objects, objects | triangles, triangles |"; numbers have commas as thousands
// separators, which no space follows.
std::map<std::string, Counts> statedCounts(const fs::path& readme) {
  std::map<std::string, Counts> counts;
  std::ifstream stream(readme);
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> cells = splitAt(line, '|');
    if (cells.size() < 5 || number(cells[3]) == 0) {
      continue;
    }
    const auto list = [](std::string cell) {
      for (std::size_t at = 0; (at = cell.find(", ", at)) != std::string::npos;) {
        cell.replace(at, 2, ";");
      }
      return splitAt(cell, ';');
    };
    const std::vector<std::string> names = list(cells[1]);
    const std::vector<std::string> objects = list(cells[3]);
    const std::vector<std::string> triangles = list(cells[4]);
    for (std::size_t i = 0; i < names.size() && i < objects.size() && i < triangles.size(); ++i) {
      counts[names[i]] = {number(objects[i]), number(triangles[i])};
    }
  }
  return counts;
}

TEST(RealScenes, HaveTheirStatedObjectsTrianglesAndWalks) {
  const fs::path folder = test::folderOfScenes();
  SIGHTLINE_SKIP_WITHOUT_SCENE(folder / "README.md");
  const std::map<std::string, Counts> stated = statedCounts(folder / "README.md");
  ASSERT_FALSE(stated.empty());
  for (const auto& [name, counts] : stated) {
    SCOPED_TRACE(name);
    const Result<Scene> scene = importScene((folder / name / (name + ".glb")).string());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->objects.size(), counts.objects);
    EXPECT_EQ(scene->triangleCount(), counts.triangles);
    EXPECT_TRUE(test::isSound(*scene));
    const Result<CameraPath> walk = readCameraPath((folder / name / "walk.path.json").string());
    ASSERT_TRUE(walk) << walk.error().message;
    EXPECT_FALSE(walk->frames.empty());
  }
}

}  // namespace
}  // namespace sightline
