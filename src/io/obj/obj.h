#pragma once

// The reader of .obj files and their .mtl files. Bytes of any origin are safe, so that it needs no process of
// its own.

#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"
#include "src/io/obj/mtl.h"
#include "src/io/obj/obj_file.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// What the file leaves open.
struct ObjFindings {
  std::uint64_t uncertain_polygons = 0;        // those that are not PolygonTriangles::exact
  std::uint64_t faces_without_material = 0;    // that have a material which is not defined
  std::vector<std::string> missing_materials;  // of these faces
  std::vector<std::string> missing_libraries;  // .mtl files that are not there
};

// Reads the text of an .obj file, and the .mtl files that it names from its folder.
//
// An object is what follows an o or g statement, and what of it follows a usemtl statement, as Assimp divides
// it. Faces before any usemtl are opaque. A material that is not defined anywhere is blended: it may be
// glass.
Result<Scene> importObj(std::string_view bytes, const std::string& folder, const std::string& name,
                        const ImportLimits& limits, ObjFindings& findings);

// The last step, with the materials that were found.
Result<Scene> sceneOfObj(const ObjFile& file, const MtlMaterials& materials, const std::string& name,
                         const ImportLimits& limits, ObjFindings& findings);

// The files that the text of an .obj file names: .mtl files that are there, and for each picture in them what
// may be its name.
std::vector<std::string> filesNamedByObj(std::string_view bytes, const std::string& folder);

}  // namespace sightline::io
