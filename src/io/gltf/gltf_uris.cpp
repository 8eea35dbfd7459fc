#include "src/io/gltf/gltf_uris.h"

#include <nlohmann/json.hpp>

#include "src/io/gltf/gltf_json.h"

namespace sightline::io {
namespace {

// The value of a hexadecimal digit; -1: it is none.
int digitOf(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  const int letter = c | 0x20;
  return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

}  // namespace

std::optional<std::string> decodePercent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded.push_back(text[i]);
      continue;
    }
    if (text.size() - i < 3) {
      return std::nullopt;
    }
    const int high = digitOf(text[i + 1]), low = digitOf(text[i + 2]);
    if (high < 0 || low < 0 || high * 16 + low == 0) {
      return std::nullopt;
    }
    decoded.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return decoded;
}

std::vector<std::string> filesNamedByGltf(std::string_view bytes) {
  std::vector<std::string> files;
  const Result<Container> container = splitContainer(bytes, {});
  if (!container) {
    return files;
  }
  const auto json = nlohmann::json::parse(container->json, nullptr, false);
  for (const char* list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) {
      continue;
    }
    for (const auto& item : json[list]) {
      if (!item.is_object() || !item.contains("uri") || !item["uri"].is_string()) {
        continue;
      }
      const std::string uri = item["uri"].get<std::string>();
      if (!uri.starts_with("data:")) {
        files.push_back(decodePercent(uri).value_or(uri));
      }
    }
  }
  return files;
}

}  // namespace sightline::io
