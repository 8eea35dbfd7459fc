#pragma once

#include <string>
#include <vector>

namespace sightline::tool {

// The files that a scene's file names: buffers and pictures of .gltf and .glb; materials of .obj and their
// pictures; none for other formats. Files that do not exist or cannot be read are left out: the importer
// reports them.
std::vector<std::string> sideFilesOf(const std::string& scene);

}  // namespace sightline::tool
