#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline {

// Reads a scene file: .glb and .gltf by our own checked reader, everything else through Assimp.
//
// Objects are numbered as the contract says: depth first over the default scene's roots, a node's primitives
// in order, then its children in order; primitives without triangles make no object. Positions are in world
// space, moved so that large coordinates keep their precision (Scene::origin), welded. Cameras of the file
// become Scene::paths. Marks: "extras": {"occluder": true | false} on a glTF node, mesh or material (the
// nearest to the primitive wins: node, then mesh, then material). Errors name the file and the element;
// nothing partial is returned. Animations move cameras only (sampled at 30 frames a second); skins and morph
// targets are left at rest.
Result<Scene> importScene(const std::string& file);

// The glTF reader on bytes in memory, as fuzzed: a .glb, or .gltf JSON text. Buffers outside the bytes are
// looked up under base_dir and refused when it is empty.
Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors);

}  // namespace sightline
