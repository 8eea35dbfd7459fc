#include "tools/sightline/command_line/side_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "sightline/io/file.h"
#include "src/io/gltf/gltf_uris.h"

namespace sightline::tool {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Calls act(keyword, value) for each line of a keyword and a value, both without spaces at their ends.
template <typename Act>
void forEachLine(const std::string& file, Act&& act) {
  constexpr const char* kSpaces = " \t\r";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return;  // a device or a pipe might never end
  }
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t begin = line.find_first_not_of(kSpaces);
    const std::size_t space = line.find_first_of(kSpaces, begin);
    const std::size_t value = line.find_first_not_of(kSpaces, space);
    if (begin != std::string::npos && space != std::string::npos && value != std::string::npos) {
      const std::size_t end = line.find_last_not_of(kSpaces) + 1;
      act(lower(line.substr(begin, space - begin)), line.substr(value, end - value));
    }
  }
}

// A name may contain spaces, or follow options or other names. So the whole value and each of its words are
// taken.
void addNames(const std::string& value, std::set<std::string>& names) {
  names.insert(value);
  for (std::size_t begin = 0; begin < value.size();) {
    const std::size_t end = std::min(value.find_first_of(" \t", begin), value.size());
    names.insert(value.substr(begin, end - begin));
    begin = end + 1;
  }
}

// The file that a name in a scene's file means.
std::string fileBeside(const std::string& scene, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return (fs::path(scene).parent_path() / name).string();
}

std::set<std::string> namesInObj(const std::string& file) {
  std::set<std::string> names;
  forEachLine(file, [&](const std::string& keyword, const std::string& value) {
    if (keyword == "mtllib") {
      addNames(value, names);
    }
  });
  // Each library is read once, by whatever names and however often it is named.
  std::set<fs::path> libraries;
  for (const std::string& name : names) {
    std::error_code ignored;
    libraries.insert(fs::weakly_canonical(fileBeside(file, name), ignored));
  }
  constexpr std::array<std::string_view, 5> kPictures{"bump", "disp", "decal", "refl", "norm"};
  for (const fs::path& library : libraries) {
    forEachLine(library.string(), [&](const std::string& keyword, const std::string& value) {
      if (keyword.starts_with("map_") ||
          std::find(kPictures.begin(), kPictures.end(), keyword) != kPictures.end()) {
        addNames(value, names);
      }
    });
  }
  return names;
}

}  // namespace

std::vector<std::string> sideFilesOf(const std::string& scene) {
  const std::string extension = lower(fs::path(scene).extension().string());
  std::set<std::string> names;
  if (extension == ".gltf" || extension == ".glb") {
    const Result<std::string> bytes = readFile(scene);
    const std::vector<std::string> named = bytes ? io::filesNamedByGltf(*bytes) : std::vector<std::string>();
    names.insert(named.begin(), named.end());
  } else if (extension == ".obj") {
    names = namesInObj(scene);
  }
  std::vector<std::string> files;
  for (const std::string& name : names) {
    std::error_code ignored;
    const std::string file = fileBeside(scene, name);
    if (fs::is_regular_file(file, ignored)) {
      files.push_back(file);
    }
  }
  return files;
}

}  // namespace sightline::tool
