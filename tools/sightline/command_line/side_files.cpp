#include "tools/sightline/command_line/side_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
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
void addNames(const std::string& value, std::vector<std::string>& names) {
  names.push_back(value);
  for (std::size_t begin = 0; begin < value.size();) {
    const std::size_t end = std::min(value.find_first_of(" \t", begin), value.size());
    names.push_back(value.substr(begin, end - begin));
    begin = end + 1;
  }
}

std::vector<std::string> namesInObj(const std::string& file) {
  std::vector<std::string> libraries;
  forEachLine(file, [&](const std::string& keyword, const std::string& value) {
    if (keyword == "mtllib") {
      addNames(value, libraries);
    }
  });
  constexpr std::array<std::string_view, 5> kPictures{"bump", "disp", "decal", "refl", "norm"};
  std::vector<std::string> names = libraries;
  for (const std::string& library : libraries) {
    forEachLine((fs::path(file).parent_path() / library).string(),
                [&](const std::string& keyword, const std::string& value) {
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
  std::vector<std::string> names;
  if (extension == ".gltf" || extension == ".glb") {
    const Result<std::string> bytes = readFile(scene);
    names = bytes ? io::filesNamedByGltf(*bytes) : names;
  } else if (extension == ".obj") {
    names = namesInObj(scene);
  }
  std::vector<std::string> files;
  for (std::string& name : names) {
    std::replace(name.begin(), name.end(), '\\', '/');
    std::error_code ignored;
    const std::string file = (fs::path(scene).parent_path() / name).string();
    if (fs::is_regular_file(file, ignored)) {
      files.push_back(file);
    }
  }
  return files;
}

}  // namespace sightline::tool
