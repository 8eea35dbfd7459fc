#pragma once

#include <string>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// Whether Assimp reads files with this extension (".obj").
bool isAssimpExtension(const std::string& extension);

Result<Scene> importAssimp(const std::string& file, const ImportLimits& limits);

}  // namespace sightline::io
