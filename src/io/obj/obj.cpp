#include "src/io/obj/obj.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>

#include "sightline/io/file.h"
#include "src/io/failure.h"
#include "src/io/obj/obj_libraries.h"
#include "src/io/obj/obj_lines.h"
#include "src/io/polygon_triangles.h"

namespace sightline::io {
namespace {

constexpr std::uint64_t kMostLibraryBytes = 256 << 20;  // of all .mtl files together

Result<MtlMaterials> readLibraries(const ObjLibraries& libraries, const std::string& name) {
  MtlMaterials materials;
  std::uint64_t bytes_read = 0;
  for (const std::string& library : libraries.files) {
    std::error_code code;
    const std::uintmax_t size = std::filesystem::file_size(library, code);
    bytes_read += code ? 0 : size;
    if (bytes_read > kMostLibraryBytes) {
      return failure("{}: its .mtl files have more than {} bytes, which is the most that is read", name,
                     kMostLibraryBytes);
    }
    const Result<std::string> text = readFile(library);
    if (!text) {
      return failure("{}: {}", name, text.error().message);
    }
    if (const Status status = materials.read(*text, library); !status) {
      return status.error();
    }
  }
  return materials;
}

class ObjConverter {
 public:
  ObjConverter(const ObjFile& file, const MtlMaterials& materials, const std::string& name,
               const ImportLimits& limits, ObjFindings& findings)
      : file_(file),
        materials_(materials),
        name_(name),
        limits_(limits),
        findings_(findings),
        builder_(limits),
        vertex_of_(file.vertices.size(), kNone) {}

  Result<Scene> convert() {
    // The parts of an object stand in a row.
    const std::size_t count = file_.parts.size() - 1;  // without the end
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      while (end < count && file_.parts[end].object == file_.parts[begin].object) {
        ++end;
      }
      for (std::size_t part = begin; part < end; ++part) {
        std::string name = file_.objects[file_.parts[part].object];
        if (end - begin > 1) {
          name += fmt::format("/primitive{}", part - begin);
        }
        const Status status = addPart(part, std::move(name));
        if (!status) {
          return status.error();
        }
      }
    }
    return builder_.finish();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  Status addPart(std::size_t number, std::string object_name) {
    const std::uint32_t first = file_.parts[number].first_face, end = file_.parts[number + 1].first_face;
    const std::uint64_t corners = file_.faces[end].first_corner - file_.faces[first].first_corner;
    const std::uint64_t triangles = corners - 2 * std::uint64_t{end - first};
    if (number >= limits_.objects) {
      return failure("{}: line {}: the scene exceeds {} objects", name_, file_.faces[first].line,
                     limits_.objects);
    }
    name_bytes_ += object_name.size();
    if (name_bytes_ > limits_.name_bytes) {
      return failure("{}: line {}: the names of objects have more than {} bytes", name_,
                     file_.faces[first].line, limits_.name_bytes);
    }
    if (!builder_.fits(triangles)) {
      return failure("{}: line {}: with the {} triangles of \"{}\" the scene exceeds {} triangles", name_,
                     file_.faces[first].line, triangles, excerpt(object_name), limits_.triangles);
    }
    builder_.beginObject(std::move(object_name), materialOf(file_.parts[number].material, end - first),
                         OccluderMark::kAutomatic);
    for (std::uint32_t face = first; face < end; ++face) {
      addFace(face);
    }
    return Success{};
  }

  void addFace(std::uint32_t face) {
    corners_.clear();
    vertices_.clear();
    bool see_through = false;
    for (std::uint32_t i = file_.faces[face].first_corner; i < file_.faces[face + 1].first_corner; ++i) {
      const std::uint32_t index = file_.corners[i];
      corners_.push_back(file_.vertices[index]);
      see_through =
          see_through || std::binary_search(file_.see_through.begin(), file_.see_through.end(), index);
      if (vertex_of_[index] == kNone) {
        vertex_of_[index] = builder_.addVertex(file_.vertices[index]);
      }
      vertices_.push_back(vertex_of_[index]);
    }
    const PolygonTriangles cut = triangulator_.triangulate(corners_);
    findings_.uncertain_polygons += cut.exact ? 0 : 1;
    const bool certain = cut.exact && !see_through;
    for (const auto& [a, b, c] : cut.triangles) {
      builder_.addTriangle(vertices_[a], vertices_[b], vertices_[c], certain);
    }
  }

  // Materials that nothing has are left out.
  MaterialId materialOf(std::uint32_t number, std::uint32_t faces) {
    if (number == ObjFile::kNoMaterial) {
      // A material may have no name, too.
      const std::int64_t nameless = default_.valid() ? -1 : materials_.find("");
      if (nameless >= 0) {
        default_ = builder_.addMaterial(materials_.all()[static_cast<std::size_t>(nameless)]);
      }
      if (!default_.valid()) {
        default_ = builder_.addMaterial(undefined("default", Opacity::kOpaque));
      }
      return default_;
    }
    materials_of_.resize(file_.materials.size());
    Used& used = materials_of_[number];
    if (!used.id.valid()) {
      const std::int64_t defined = materials_.find(file_.materials[number]);
      used.missing = defined < 0;
      if (used.missing) {
        const std::string name(nameWithoutComment(file_.materials[number]));
        findings_.missing_materials.push_back(name);
        used.id = builder_.addMaterial(undefined(name, Opacity::kBlended));
      } else {
        used.id = builder_.addMaterial(materials_.all()[static_cast<std::size_t>(defined)]);
      }
    }
    findings_.faces_without_material += used.missing ? faces : 0;
    return used.id;
  }

  static Material undefined(const std::string& name, Opacity opacity) {
    return {.name = name, .opacity = opacity, .base_color = {kMtlColor, kMtlColor, kMtlColor, 1.0f}};
  }

  struct Used {
    MaterialId id{};
    bool missing = false;
  };

  const ObjFile& file_;
  const MtlMaterials& materials_;
  const std::string& name_;
  const ImportLimits& limits_;
  ObjFindings& findings_;
  SceneBuilder builder_;
  PolygonTriangulator triangulator_;
  MaterialId default_;
  std::vector<Used> materials_of_;        // for each of the file's; not valid(): not yet added
  std::vector<std::uint32_t> vertex_of_;  // the builder's, for each of the file's; kNone: not yet added
  std::uint64_t name_bytes_ = 0;
  std::vector<Vec3d> corners_;           // of a face
  std::vector<std::uint32_t> vertices_;  // of it, the builder's
};

// A name may contain spaces, or follow options. So the whole value and each of its words are taken.
void addPossibleNames(const std::string& value, const std::string& folder, std::vector<std::string>& files) {
  files.push_back(fileNamedInObj(value, folder));
  std::string_view rest = value;
  for (std::string_view word = takeWord(rest); !word.empty() && word.size() < value.size();
       word = takeWord(rest)) {
    files.push_back(fileNamedInObj(std::string(word), folder));
  }
}

}  // namespace

Result<Scene> sceneOfObj(const ObjFile& file, const MtlMaterials& materials, const std::string& name,
                         const ImportLimits& limits, ObjFindings& findings) {
  return ObjConverter(file, materials, name, limits, findings).convert();
}

Result<Scene> importObj(std::string_view bytes, const std::string& folder, const std::string& name,
                        const ImportLimits& limits, ObjFindings& findings) {
  // Containers throw when memory runs out; nothing leaves here.
  try {
    const Result<ObjFile> file = parseObj(bytes, name);
    if (!file) {
      return file.error();
    }
    ObjLibraries libraries = findObjLibraries(file->libraries, folder);
    findings.missing_libraries = std::move(libraries.missing);
    const Result<MtlMaterials> materials = readLibraries(libraries, name);
    return materials ? sceneOfObj(*file, *materials, name, limits, findings)
                     : Result<Scene>(materials.error());
  } catch (const std::bad_alloc&) {
    return failure("{}: out of memory: the scene is too large for this machine", name);
  } catch (const std::exception& exception) {
    return failure("{}: could not be read: {}", name, exception.what());
  }
}

std::vector<std::string> filesNamedByObj(std::string_view bytes, const std::string& folder) {
  const ObjLibraries libraries = findObjLibraries(librariesOfObj(bytes), folder);
  std::vector<std::string> files = libraries.files;
  std::uint64_t left = kMostLibraryBytes;  // files that importObj() would refuse are not looked into
  for (const std::string& library : libraries.files) {
    std::error_code code;
    const std::uint64_t size = std::filesystem::file_size(library, code);
    if (code || size > left) {
      continue;
    }
    left -= size;
    const Result<std::string> text = readFile(library);
    for (const std::string& picture : text ? picturesOfMtl(*text) : std::vector<std::string>()) {
      addPossibleNames(picture, folder, files);
    }
  }
  return files;
}

}  // namespace sightline::io
