#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace sightline {

// A key that is none of the form's, most likely a mistyped one.
struct UnknownKey {
  std::string key{};
  std::optional<std::size_t> frame{};         // the first frame that has it; none: it is beside "frames"
  std::size_t frames = 0;                     // so many frames have it
  std::span<const std::string_view> known{};  // the keys that there are in its place
};

// The JSON form "path". Unknown keys are ignored, and the first 20 added to unknown_keys, each once, also
// before an error; wrong types, non-finite numbers, zero directions, no frames, near >= far and angles
// outside (0, 180) are errors that name the key and the frame. Only "frames" with "eye" and "forward" is
// required; the rest has CameraPath's defaults, "up" is +Y.
Result<CameraPath> parseCameraPath(std::string_view json, const std::string& name_in_errors,
                                   std::vector<UnknownKey>* unknown_keys = nullptr);
Result<CameraPath> readCameraPath(const std::string& file);
std::string toJson(const CameraPath& path);

}  // namespace sightline
