#pragma once

// Files of points: the viewpoints that a command is asked about.

#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/vec3.h"

namespace sightline::tool {

// The points of a text: {"points":[[x,y,z],...]}, or the eyes of a camera path. name: of the file, in errors.
Result<std::vector<Vec3d>> parsePointsFile(std::string_view text, const std::string& name);

}  // namespace sightline::tool
