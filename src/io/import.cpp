#include "sightline/io/import.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "sightline/io/file.h"
#include "src/io/assimp.h"
#include "src/io/failure.h"
#include "src/io/ply_check.h"

namespace sightline {

using namespace io;

namespace {

void noteInexact(const std::string& file, std::uint64_t polygons, std::vector<std::string>* notes) {
  if (polygons > 0 && notes != nullptr) {
    notes->push_back(fmt::format(
        "{}: {} {} or {} too many corners, so the objects that have {} hide nothing; give triangles "
        "instead",
        oneLine(file), polygons, polygons == 1 ? "polygon crosses itself" : "polygons cross themselves",
        polygons == 1 ? "has" : "have", polygons == 1 ? "it" : "them"));
  }
}

}  // namespace

Result<Scene> importScene(const std::string& file, std::vector<std::string>* notes) {
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
  if (is_gltf) {
    const std::string folder = path.parent_path().string();
    return importGltf(*bytes, folder.empty() ? "." : folder, file);
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
  noteInexact(file, findings.inexact_polygons, notes);
  if (scene && may_be_see_through) {
    for (Material& material : scene->materials) {
      material.opacity = Opacity::kBlended;
    }
  }
  return scene;
}

}  // namespace sightline
