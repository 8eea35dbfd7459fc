#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace sightline {

// The JSON form "path". Unknown keys are ignored; wrong types, non-finite numbers, zero directions, no
// frames, near >= far and angles outside (0, 180) are errors that name the key and the frame. Only "frames"
// with "eye" and "forward" is required; the rest has CameraPath's defaults, "up" is +Y.
Result<CameraPath> parseCameraPath(std::string_view json, const std::string& name_in_errors);
Result<CameraPath> readCameraPath(const std::string& file);
std::string toJson(const CameraPath& path);

}  // namespace sightline
