#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace sightline::tool {

// A camera path's file. Keys that the form does not have are named on stderr, with the keys that may be
// meant; where the file cannot be read, in the error.
Result<CameraPath> readCameraPathFile(const std::string& file);
// The same of a text that was read already.
Result<CameraPath> parseCameraPathFile(std::string_view text, const std::string& file);

}  // namespace sightline::tool
