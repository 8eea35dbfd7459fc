#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"

namespace sightline {

// 8-bit RGBA, rows from the top, 4 * width * height bytes.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba{};

  friend bool operator==(const Image&, const Image&) = default;
};

Result<void> writePng(const Image& image, const std::string& file);
// Reads any PNG as eight bits a channel; one without an alpha channel is opaque. Errors: no such file, no
// PNG, more than 16384 pixels a side.
Result<Image> readPng(const std::string& file);

}  // namespace sightline
