#pragma once

#include <cstdint>
#include <string>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// Whether Assimp reads files with this extension (".obj").
bool isAssimpExtension(const std::string& extension);

// What both functions find beside the scene.
struct AssimpFindings {
  std::uint64_t uncertain_polygons = 0;  // PolygonTriangles::exact; their objects are never occluders
};

// Reads the file in this process, which Assimp may bring down.
Result<Scene> importAssimp(const std::string& file, const ImportLimits& limits, AssimpFindings& findings);
// Reads the file in a child process, with limits of time and memory that grow with the file's size.
Result<Scene> importAssimpInChild(const std::string& file, std::uint64_t file_bytes,
                                  const ImportLimits& limits, AssimpFindings& findings,
                                  std::uint32_t most_seconds = 0xffffffffu);

}  // namespace sightline::io
