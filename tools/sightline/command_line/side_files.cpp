#include "tools/sightline/command_line/side_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "sightline/io/file.h"
#include "src/io/gltf/gltf_uris.h"
#include "src/io/obj/obj.h"

namespace sightline::tool {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The file that a name in a scene's file means.
std::string fileBeside(const std::string& scene, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return (fs::path(scene).parent_path() / name).string();
}

}  // namespace

std::vector<std::string> sideFilesOf(const std::string& scene) {
  const std::string extension = lower(fs::path(scene).extension().string());
  const bool is_gltf = extension == ".gltf" || extension == ".glb";
  if (!is_gltf && extension != ".obj") {
    return {};
  }
  const Result<std::string> bytes = readFile(scene);
  std::set<std::string> named;
  if (bytes && is_gltf) {
    for (const std::string& name : io::filesNamedByGltf(*bytes)) {
      named.insert(fileBeside(scene, name));
    }
  } else if (bytes) {
    const std::vector<std::string> files =
        io::filesNamedByObj(*bytes, fs::path(scene).parent_path().string());
    named.insert(files.begin(), files.end());
  }
  std::vector<std::string> files;
  for (const std::string& file : named) {
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) {
      files.push_back(file);
    }
  }
  return files;
}

}  // namespace sightline::tool
