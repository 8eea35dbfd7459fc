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

Status checkFrameFile(const std::string& option, const std::string& target, const std::string& extension,
                      const std::string& scene_file) {
  if (std::filesystem::path(target).extension() != extension) {
    return Error{fmt::format("{} {}: the file's name must end in {}", option, target, extension)};
  }
  return checkOutput(target, scene_file);
}

Status checkApart(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  std::vector<std::pair<std::filesystem::path, std::string>> taken;  // and by which option
  std::error_code ignored;
  for (const NamedFile& input : inputs) {
    taken.emplace_back(
        std::filesystem::weakly_canonical(std::filesystem::absolute(input.file, ignored), ignored),
        input.option);
  }
  for (const NamedFile& output : outputs) {
    if (output.file.empty() || output.file == "-") {
      continue;
    }
    const std::filesystem::path path =
        std::filesystem::weakly_canonical(std::filesystem::absolute(output.file, ignored), ignored);
    for (const auto& [other, option] : taken) {
      if (!path.empty() && path == other) {
        return Error{
            fmt::format("{} {}: is the file of {} too; name another", output.option, output.file, option)};
      }
    }
    taken.emplace_back(path, output.option);
  }
  return Success{};
}

}  // namespace sightline::tool
