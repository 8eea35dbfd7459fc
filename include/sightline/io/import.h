#pragma once

#include <string>
#include <string_view>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline {

// Reads a scene file: .glb, .gltf and .obj by our own checked readers, everything else through Assimp.
//
// Objects are numbered depth first over the default scene's roots: a node's primitives in order (of each of
// its instances in order, if a glTF node lists some), then its children in order. Primitives without
// triangles make no object. Positions are in world space, moved so that large coordinates keep their
// precision (Scene::origin), and equal ones are welded. Cameras of the file become Scene::paths, sampled at
// 30 frames a second where animations move them. Marks: "extras": {"occluder": true | false} on a glTF node,
// mesh or material; the node's mark is stronger than the mesh's, and this than the material's. An error names
// the file and the element, and nothing partial is returned.
//
// All else stands in its rest pose: nodes as they are without animations, vertices where skins and the
// weights of morph targets place them then. An object that moves, by an animation of its node or of one
// above, a skin, or morph targets with weights that are not zero or are animated, is marked kNever unless the
// file marks it; Scene::notes say how many these are. Its bounds are those of the rest pose: cull it by a
// moving box of your own. docs/formats.md lists what else of a glTF file is read, and its extensions.
//
// Polygons are cut into triangles of their own corners that cover just the polygon, and whoever draws a
// polygon whose corners do not lie in one plane must draw these triangles. Polygons that cross or overlap
// themselves, or that have more than 16,384 corners, become an object of their own, NAME/uncertain, which is
// marked as no occluder.
//
// Objects of an .obj file are its o and g statements, divided where usemtl names another material. A material
// that no .mtl file defines may be glass and counts as blended, which a note tells.
//
// Scene::notes tell what the file leaves open, and what to do.
//
// Several threads may import at once, while others run. Assimp reads in a fork of this process, which has the
// calling thread alone: locks that other threads hold at that moment stay locked there, and handlers of
// pthread_atfork() run. A file that crashes or hangs Assimp is an error.
Result<Scene> importScene(const std::string& file);

// Reads a .glb, or the JSON text of a .gltf, from memory. Bytes of any origin are safe. Buffers in other
// files are looked up under base_dir, and refused when it is empty.
Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors);

}  // namespace sightline
