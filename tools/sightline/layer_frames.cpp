#include "tools/sightline/layer_frames.h"

#include <fmt/format.h>

#include <filesystem>

#include "tools/sightline/json_output.h"

namespace sightline::tool {

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

}  // namespace sightline::tool
