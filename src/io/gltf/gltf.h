#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// importGltf with limits of the caller's choice, as fuzzed.
Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors, const ImportLimits& limits);

}  // namespace sightline::io
