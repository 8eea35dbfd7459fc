#include "tools/sightline/options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "tools/sightline/parse_text.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxThreads = 256;
constexpr std::uint32_t kMaxPixels = 16384;

}  // namespace

CLI::Validator isNotEmpty() {
  return {[](std::string& word) { return std::string(word.empty() ? "is empty" : ""); }, ""};
}

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  command
      .add_option("SCENE", options.scene, "a file (.glb .gltf .obj .ply .stl ...) or demo:NAME?key=value&...")
      ->required();
  addOutputOptions(command, options);
}

void addOutputOptions(CLI::App& command, OutputOptions& options) {
  command.add_option("--json", options.json, "write the result as JSON to this file; - is standard output");
  command.add_option("--threads", options.threads, "threads to use")
      ->check(CLI::Range(1u, kMaxThreads))
      ->capture_default_str();
}

void addPathOptions(CLI::App& command, PathOptions& options) {
  command.add_option(
      "--path", options.path,
      "camera path: a JSON file or the name of a walk of the scene (default: walk.path.json beside the "
      "scene's file, or else the scene's first walk or camera); cells: with --baked, a view from each cell "
      "of the file, most of them from the cell's borders");
  command.add_option("--frames", options.frames,
                     "only frames A, A+STEP, ... before B, as A:B[:STEP]; or one frame's number");
}

void addPictureOptions(CLI::App& command, PictureOptions& options) {
  command.add_option("--width", options.width, "of the pictures, in pixels (default: the path's)")
      ->check(CLI::Range(1u, kMaxPixels));
  command.add_option("--height", options.height, "of the pictures, in pixels (default: the path's)")
      ->check(CLI::Range(1u, kMaxPixels));
}

PictureOptions pictureSize(const PictureOptions& options, const CameraPath& path) {
  return {options.width > 0 ? options.width : path.width, options.height > 0 ? options.height : path.height};
}

Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count) {
  const std::string form = fmt::format(
      "--frames: '{}' is not A:B, A:B:STEP or one number with A < B and STEP > 0; the path has {} frames",
      text, count);
  std::uint32_t numbers[3] = {0, static_cast<std::uint32_t>(count), 1};
  if (!text.empty()) {
    const std::vector<std::string> parts = splitAt(text, ':');
    if (parts.size() > 3) {
      return Error{form};
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::optional<std::uint32_t> value = parseWhole(parts[i]);
      if (!value) {
        return Error{form};
      }
      numbers[i] = *value;
    }
    if (parts.size() == 1) {
      numbers[1] = numbers[0] < count ? numbers[0] + 1 : numbers[0];
    }
  }
  const auto [begin, end, step] = numbers;
  if (begin >= end || step == 0 || begin >= count) {
    return Error{form};
  }
  std::vector<std::uint32_t> frames;
  for (std::uint64_t frame = begin; frame < std::min<std::uint64_t>(end, count); frame += step) {
    frames.push_back(static_cast<std::uint32_t>(frame));
  }
  return frames;
}

}  // namespace sightline::tool
