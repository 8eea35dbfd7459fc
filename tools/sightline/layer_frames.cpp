#include "tools/sightline/layer_frames.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "tools/sightline/json_output.h"

namespace sightline::tool {

Result<LayerRenderer> makeRenderer(const FrameMakerInput& input) {
  return LayerRenderer::create(
      input.input.moving.scene.view(),
      {.width = input.width, .height = input.height, .samples = input.samples, .tints = input.tints});
}

std::string frameFile(const std::string& target, std::uint32_t frame, bool several_frames) {
  if (!several_frames) {
    return target;
  }
  const std::filesystem::path path(target);
  const std::string name = fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string());
  return (path.parent_path() / name).string();
}

Status checkFrameFiles(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs,
                       const std::string& scene_file) {
  const auto canonical = [](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored), ignored);
  };
  std::vector<std::pair<std::filesystem::path, std::string>> taken;  // and by which option
  for (const NamedFile& input : inputs) {
    taken.emplace_back(canonical(input.file), input.option);
  }
  for (const auto& [option, file, extension] : outputs) {
    if (file.empty()) {
      continue;
    }
    if (!extension.empty() && std::filesystem::path(file).extension() != extension) {
      return Error{fmt::format("{} {}: the file's name must end in {}", option, file, extension)};
    }
    if (const Status ok = checkOutput(file, scene_file); !ok) {
      return ok;
    }
    if (file == "-") {
      continue;
    }
    const std::filesystem::path path = canonical(file);
    for (const auto& [other, its_option] : taken) {
      if (!path.empty() && path == other) {
        return Error{fmt::format("{} {}: is the file of {} too; name another", option, file, its_option)};
      }
    }
    taken.emplace_back(path, option);
  }
  return Success{};
}

}  // namespace sightline::tool
