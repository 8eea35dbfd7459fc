#include "tools/sightline/layers/layer_replacement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "tools/sightline/command_line/parse_text.h"

namespace sightline::tool {
namespace {

struct Rectangle {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;  // right and bottom are exclusive
};

// Returns the smallest rectangle of all pixels that are not transparent.
Rectangle rectangleOf(const LayerImage& image) {
  Rectangle found{image.width, image.height, 0, 0};
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (image.pixels[std::size_t{y} * image.width + x].alpha > 0.0f) {
        found = {std::min(found.left, x), std::min(found.top, y), std::max(found.right, x + 1), y + 1};
      }
    }
  }
  return found;
}

// Stretches the file over a rectangle, with the nearest pixel for each.
void fit(const Image& file, const Rectangle& to, LayerImage& image) {
  for (std::uint32_t y = to.top; y < to.bottom; ++y) {
    const std::uint64_t row = std::uint64_t{y - to.top} * file.height / (to.bottom - to.top);
    for (std::uint32_t x = to.left; x < to.right; ++x) {
      const std::uint64_t column = std::uint64_t{x - to.left} * file.width / (to.right - to.left);
      image.pixels[std::size_t{y} * image.width + x] =
          linearPixel(file, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
    }
  }
}

// The linear light of each value of an sRGB channel. Source: IEC 61966-2-1.
std::array<float, 256> linearOfSrgb() {
  std::array<float, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double value = static_cast<double>(i) / 255.0;
    light[i] = static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  }
  return light;
}

bool isThere(const std::string& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error);
}

// The run of # in the file's name, from its first character to behind its last one; empty: no sequence.
struct Run {
  std::size_t begin = 0, end = 0;
};
Run runOf(const std::string& pattern) {
  const std::size_t slash = pattern.rfind('/');
  const std::size_t begin = pattern.find('#', slash == std::string::npos ? 0 : slash);
  if (begin == std::string::npos || isThere(pattern)) {
    return {};
  }
  const std::size_t end = pattern.find_first_not_of('#', begin);
  return {begin, end == std::string::npos ? pattern.size() : end};
}

Result<LayerReplacementFile> replacementOf(const std::string& text, const LayerInput& input) {
  const std::size_t equals = text.find('=');
  const std::optional<std::uint32_t> part = parseWhole(text.substr(0, equals));
  if (!part || equals == std::string::npos || equals + 1 == text.size()) {
    return Error{fmt::format("--replace {}: is not of the form PART=FILE.png", text)};
  }
  if (const Status ok = checkPartNumber("--replace", *part, input.moving.parts.size()); !ok) {
    return ok.error();
  }
  LayerReplacementFile replaced{.part = *part, .pattern = text.substr(equals + 1)};
  const Run run = runOf(replaced.pattern);
  if (run.end != run.begin && replaced.pattern.find('#', run.end) != std::string::npos) {
    return Error{fmt::format("--replace {}: the frame's number has one place, a single run of #", text)};
  }
  for (const std::uint32_t frame : input.walk.frames) {
    const std::string file = replacementFile(replaced.pattern, frame);
    if (run.end != run.begin && !isThere(file)) {
      return Error{fmt::format("--replace {}: there is no picture of frame {}, {}", text, frame, file)};
    }
  }
  const std::uint32_t first = input.walk.frames.empty() ? 0 : input.walk.frames.front();
  if (const Status ok = replaced.read(first); !ok) {
    return ok.error();
  }
  return replaced;
}

Status checkOnce(std::uint32_t part, const std::vector<std::uint32_t>& without,
                 const std::vector<LayerReplacementFile>& before) {
  if (std::find(without.begin(), without.end(), part) != without.end()) {
    return Error{fmt::format("--replace {}: the part is left out by --without", part)};
  }
  const auto is_same = [&](const LayerReplacementFile& other) { return other.part == part; };
  return std::none_of(before.begin(), before.end(), is_same)
             ? Status(Success{})
             : Error{fmt::format("--replace {}: the part has two pictures", part)};
}

}  // namespace

Status LayerReplacementFile::read(std::uint32_t frame) {
  const std::string name = replacementFile(pattern, frame);
  if (name == read_from) {
    return Success{};
  }
  Result<Image> picture = readPng(name);
  if (!picture) {
    return picture.error();
  }
  file = std::move(*picture);
  read_from = name;
  return Success{};
}

bool LayerReplacementFile::hasSize(std::uint32_t width, std::uint32_t height) const {
  return file.width == width && file.height == height;
}

void LayerReplacementFile::fill(LayerImage& to) const {
  fit(file, {0, 0, to.width, to.height}, to);
}

void LayerReplacementFile::fitOver(LayerImage& to) const {
  const Rectangle rectangle = rectangleOf(to);
  to.clear(to.width, to.height);
  fit(file, rectangle, to);
}

std::string replacementFile(const std::string& pattern, std::uint32_t frame) {
  const Run run = runOf(pattern);
  if (run.begin == run.end) {
    return pattern;
  }
  return fmt::format("{}{:0{}}{}", pattern.substr(0, run.begin), frame, run.end - run.begin,
                     pattern.substr(run.end));
}

ShapedPixel linearPixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  static const std::array<float, 256> kLight = linearOfSrgb();
  const std::uint8_t* p = &image.rgba[4 * (std::size_t{y} * image.width + x)];
  const float alpha = static_cast<float>(p[3]) / 255.0f;
  return {kLight[p[0]] * alpha, kLight[p[1]] * alpha, kLight[p[2]] * alpha, alpha};
}

Status checkPartNumber(const std::string& option, std::uint32_t part, std::size_t parts) {
  return part < parts ? Status(Success{})
                      : Error{fmt::format("{} {}: there is no such part; the scene has {}, numbered from 0",
                                          option, part, parts)};
}

Result<std::vector<LayerReplacementFile>> replacementFiles(const std::vector<std::string>& texts,
                                                           const std::vector<std::uint32_t>& without,
                                                           const LayerInput& input) {
  std::vector<LayerReplacementFile> replaced;
  for (const std::string& text : texts) {
    Result<LayerReplacementFile> part = replacementOf(text, input);
    if (!part) {
      return part.error();
    }
    if (const Status ok = checkOnce(part->part, without, replaced); !ok) {
      return ok.error();
    }
    replaced.push_back(std::move(*part));
  }
  return replaced;
}

}  // namespace sightline::tool
