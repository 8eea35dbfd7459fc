#include "tools/sightline/command_line/side_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sightline/io/file.h"

namespace sightline::tool {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Decodes percent signs: "a%20b" -> "a b". A percent sign without two hexadecimal digits stays.
std::string withoutPercents(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool number = uri[i] == '%' && i + 2 < uri.size() &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 1])) != 0 &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 2])) != 0;
    text += number ? static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)) : uri[i];
    i += number ? 2 : 0;
  }
  return text;
}

// The JSON of a .glb, which is its first chunk: it follows 12 bytes of header and the chunk's length and
// kind.
std::string_view jsonOfGlb(std::string_view bytes) {
  constexpr std::size_t kLengthAt = 12, kJsonAt = 20;
  std::uint32_t length = 0;
  if (bytes.size() < kJsonAt) {
    return {};
  }
  std::memcpy(&length, bytes.data() + kLengthAt, sizeof(length));
  return bytes.substr(kJsonAt, length);
}

std::vector<std::string> namesInGltf(const std::string& file, bool is_glb) {
  std::vector<std::string> names;
  const Result<std::string> bytes = readFile(file);
  if (!bytes) {
    return names;
  }
  const auto json = nlohmann::json::parse(is_glb ? jsonOfGlb(*bytes) : *bytes, nullptr, false);
  for (const char* list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) {
      continue;
    }
    for (const auto& item : json[list]) {
      if (item.is_object() && item.contains("uri") && item["uri"].is_string()) {
        names.push_back(withoutPercents(item["uri"].get<std::string>()));
      }
    }
  }
  return names;
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
    names = namesInGltf(scene, extension == ".glb");
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
