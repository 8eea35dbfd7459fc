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

// A key that the form does not have, most likely a mistyped one.
struct UnknownKey {
  std::string key{};
  std::optional<std::size_t> frame{};         // the first frame that has it; none: it is beside "frames"
  std::size_t frames = 0;                     // how many frames have it
  std::span<const std::string_view> known{};  // the keys that may stand in its place
};

// Reads a camera path in the JSON form "path" (docs/formats.md). Only "frames" with "eye" and "forward" is
// required; other keys default to those of CameraPath, and "up" to +Y. Wrong types, numbers that are not
// finite, zero directions, no frames, near >= far, angles outside (0, 180) and shifts that validate() rejects
// are errors that name the key and the frame. Unknown keys are ignored; the first 20 of them are added to
// unknown_keys, each once, also before an error.
Result<CameraPath> parseCameraPath(std::string_view json, const std::string& name_in_errors,
                                   std::vector<UnknownKey>* unknown_keys = nullptr);
Result<CameraPath> readCameraPath(const std::string& file);
std::string toJson(const CameraPath& path);

}  // namespace sightline
