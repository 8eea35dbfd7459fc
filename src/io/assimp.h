#pragma once

#include <cstdint>
#include <string>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// Whether Assimp reads files with this extension (".ply").
bool isAssimpExtension(const std::string& extension);

// What both functions find beside the scene.
struct AssimpFindings {
  std::uint64_t uncertain_polygons = 0;  // those that are not PolygonTriangles::exact
  std::uint64_t moving_objects = 0;      // by animations, bones or morph targets: they are no occluders
};

// Reads the file in this process, which Assimp may bring down.
Result<Scene> importAssimp(const std::string& file, const ImportLimits& limits, AssimpFindings& findings);
// Reads the file in a child process, with limits of time and memory that grow with the file's size.
Result<Scene> importAssimpInChild(const std::string& file, std::uint64_t file_bytes,
                                  const ImportLimits& limits, AssimpFindings& findings,
                                  std::uint32_t most_seconds = 0xffffffffu);

}  // namespace sightline::io
