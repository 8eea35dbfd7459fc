#include "sightline/io/import.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "sightline/io/file.h"
#include "src/io/assimp.h"
#include "src/io/failure.h"
#include "src/io/obj/obj.h"
#include "src/io/ply_check.h"

namespace sightline {

using namespace io;

namespace {

void noteUncertain(std::uint64_t polygons, Result<Scene>& scene) {
  if (scene && polygons > 0) {
    scene->notes.push_back(fmt::format(
        "{} {} or {} more corners or larger coordinates than can be cut exactly; {} nothing; give "
        "triangles instead",
        polygons, polygons == 1 ? "polygon crosses itself" : "polygons cross themselves",
        polygons == 1 ? "has" : "have", polygons == 1 ? "it hides" : "they hide"));
  }
}

void noteMoving(std::uint64_t objects, Result<Scene>& scene) {
  if (scene && objects > 0) {
    scene->notes.push_back(fmt::format(
        "objects that move, by animations, bones or morph targets: {}. They stand in their rest pose "
        "and hide nothing. Cull them as moving objects where they are",
        objects));
  }
}

// The first of several names, as in "a", "b" and 3 more.
std::string named(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    const bool last = i + 1 == names.size();
    text += fmt::format("{}\"{}\"", i == 0 ? "" : last ? " and " : ", ", names[i].substr(0, 60));
  }
  return names.size() > kMost ? fmt::format("{} and {} more", text, names.size() - kMost) : text;
}

void noteMissingMaterials(const ObjFindings& findings, Result<Scene>& scene) {
  if (!scene || findings.faces_without_material == 0) {
    return;
  }
  const bool one = findings.faces_without_material == 1;
  const std::string what =
      findings.missing_libraries.empty()
          ? "name the .mtl file that defines them in a line mtllib, or define them"
          : fmt::format("put {} beside the file, or define them", named(findings.missing_libraries));
  scene->notes.push_back(oneLine(
      fmt::format("{} {} a material that no .mtl file defines ({}); it may be glass, so {} nothing; {}",
                  findings.faces_without_material, one ? "face has" : "faces have",
                  named(findings.missing_materials), one ? "it hides" : "they hide", what)));
}

// Whether bytes begin as a binary glTF does, or as JSON after white space and a mark of UTF-8.
bool mayBeGltf(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return bytes.starts_with("glTF") || (first != std::string_view::npos && bytes[first] == '{');
}

}  // namespace

Result<Scene> importScene(const std::string& file) {
  const std::filesystem::path path(file);
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_gltf = extension == ".glb" || extension == ".gltf";
  // Read first: a missing file is the better news than a strange name.
  Result<std::string> bytes = readFile(file);
  if (!bytes) {
    return bytes.error();
  }
  if (bytes->empty()) {
    return failure("{}: the file is empty", file);
  }
  if (extension == ".glb" && !mayBeGltf(*bytes)) {
    return failure("{}: is not a binary glTF: it does not begin with 'glTF'", file);
  }
  if (is_gltf) {
    const std::string folder = path.parent_path().string();
    return importGltf(*bytes, folder.empty() ? "." : folder, file);
  }
  if (extension == ".obj") {
    ObjFindings findings;
    Result<Scene> scene = importObj(*bytes, path.parent_path().string(), file, ImportLimits{}, findings);
    noteUncertain(findings.uncertain_polygons, scene);
    noteMissingMaterials(findings, scene);
    return scene;
  }
  if (extension.empty() || !isAssimpExtension(extension)) {
    return failure(
        "{}: files ending in \"{}\" are not read; .glb, .gltf, .obj, .ply, .stl, .fbx, .dae and others are",
        file, extension);
  }
  const bool is_ply = extension == ".ply";
  if (is_ply) {
    const Status readable = checkPly(*bytes, file);
    if (!readable) {
      return readable.error();
    }
  }
  // Some of the faces may be glass then.
  const bool may_be_see_through = is_ply && plyFacesHaveAlpha(*bytes);
  const std::uint64_t file_bytes = bytes->size();
  std::string().swap(*bytes);  // frees it: Assimp reads the file itself, with the others that it names
  AssimpFindings findings;
  Result<Scene> scene = importAssimpInChild(file, file_bytes, ImportLimits{}, findings);
  noteUncertain(findings.uncertain_polygons, scene);
  noteMoving(findings.moving_objects, scene);
  if (scene && may_be_see_through) {
    for (Material& material : scene->materials) {
      material.opacity = Opacity::kBlended;
    }
  }
  return scene;
}

}  // namespace sightline
