#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace sightline::tool {

// Reads the file of a camera path. Unknown keys are reported on stderr with the known keys that may be meant,
// or in the error if the file cannot be read.
Result<CameraPath> readCameraPathFile(const std::string& file);
// The same for a text that was read before; errors name `file`.
Result<CameraPath> parseCameraPathFile(std::string_view text, const std::string& file);

}  // namespace sightline::tool
