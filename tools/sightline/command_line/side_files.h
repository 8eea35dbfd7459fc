#pragma once

#include <string>
#include <vector>

namespace sightline::tool {

// The files that a scene's file names: buffers and pictures of .gltf and .glb, materials of .obj and their
// pictures. Of other formats none are known. Files that are not there, or cannot be read, are left out: the
// importer says so.
std::vector<std::string> sideFilesOf(const std::string& scene);

}  // namespace sightline::tool
