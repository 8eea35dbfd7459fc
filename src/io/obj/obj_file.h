#pragma once

// What an .obj file says of triangles, before its materials are known.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/vec3.h"

namespace sightline::io {

struct ObjFile {
  static constexpr std::uint32_t kNoMaterial = 0xffffffffu;

  struct Face {
    std::uint32_t first_corner = 0;  // its corners end where those of the next face begin
    std::uint32_t line = 0;
  };
  // The faces of an object that follow one usemtl statement.
  struct Part {
    std::uint32_t object = 0;
    std::uint32_t material = kNoMaterial;  // into materials
    std::uint32_t first_face = 0;          // its faces end where those of the next part begin
  };

  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> see_through;  // vertices whose colour may be, ascending
  std::vector<std::uint32_t> corners;      // each below vertices.size()
  std::vector<Face> faces;                 // of three corners or more, and one that marks the end
  std::vector<Part> parts;             // with faces, and one that marks the end; those of an object in a row
  std::vector<std::string> objects;    // their names
  std::vector<std::string> materials;  // the values of usemtl statements, each once
  std::vector<std::string> libraries;  // the values of mtllib statements
};

// Reads the text of a file. Bytes of any origin are safe.
Result<ObjFile> parseObj(std::string_view bytes, const std::string& name);

// The values of its mtllib statements alone.
std::vector<std::string> librariesOfObj(std::string_view bytes);

}  // namespace sightline::io
