#include "src/io/gltf/gltf.h"

#include <exception>
#include <new>

#include "sightline/io/import.h"
#include "src/io/gltf/gltf_extensions.h"
#include "src/io/gltf/gltf_json.h"
#include "src/io/gltf/gltf_model.h"

namespace sightline {
namespace io {
namespace {

// What nothing that follows checks, because it is not used or would be read in another way.
Status checkParts(const Document& document) {
  const std::string& name = document.name;
  const GltfFile& file = document.file;
  for (const GltfFile::Accessor& accessor : file.accessors) {
    if (accessor.type_of_component < ComponentType::kByte ||
        accessor.type_of_component > ComponentType::kDouble) {
      return failure("{}: is not valid glTF: Invalid `componentType` in accessor. Got {}", name,
                     accessor.type_of_component);
    }
  }
  for (const GltfFile::Mesh& mesh : file.meshes) {
    for (const GltfFile::Primitive& primitive : mesh.primitives) {
      if (primitive.indices < 0) {
        continue;
      }
      if (!isIndexInto(primitive.indices, file.accessors.size())) {
        return failure("{}: is not valid glTF: primitive indices accessor out of bounds", name);
      }
      const int view = file.accessors[static_cast<std::size_t>(primitive.indices)].buffer_view;
      if (!isIndexInto(view, file.buffer_views.size())) {
        return failure("{}: is not valid glTF: accessor[{}] invalid bufferView", name, primitive.indices);
      }
    }
  }
  for (const GltfFile::Camera& camera : file.cameras) {
    const bool orthographic = camera.type == "orthographic";
    if (!orthographic && camera.type != "perspective") {
      return failure(
          "{}: is not valid glTF: Invalid camera type: \"{}\". Must be \"perspective\" or \"orthographic\"",
          name, camera.type);
    }
    if (orthographic ? !camera.orthographic : !camera.perspective) {
      return failure("{}: is not valid glTF: {} camera description not found.", name,
                     orthographic ? "Orthographic" : "Perspective");
    }
  }
  return Success{};
}

// The elements that sparse accessors replace are checked one by one, and accessors may share them.
Status checkSparseWork(const Document& document) {
  std::uint64_t replaced = 0;
  for (const GltfFile::Accessor& accessor : document.file.accessors) {
    replaced += accessor.sparse ? accessor.sparse->count : 0;
  }
  if (replaced > document.limits.sparse_elements) {
    return failure("{}: its sparse accessors replace {} elements; at most {} are read", document.name,
                   replaced, document.limits.sparse_elements);
  }
  return Success{};
}

Result<Document> load(std::string_view bytes, const std::string& base_dir, const std::string& name,
                      const ImportLimits& limits) {
  Document document;
  document.name = name;
  document.limits = limits;
  const Result<Container> container = splitContainer(bytes, name);
  if (!container) {
    return container.error();
  }
  Result<CheckedJson> checked = checkJson(container->json, limits, name);
  if (!checked) {
    return checked.error();
  }
  for (const std::string& extension : checked->extensions_required) {
    if (!mayBeRequired(extension)) {
      return failure("{}: requires the extension \"{}\", which is not supported; export the scene without it",
                     name, extension);
    }
  }
  Result<Buffers> buffers = loadBuffers(checked->buffers, *container, base_dir, name);
  if (!buffers) {
    return buffers.error();
  }
  document.buffers = std::move(*buffers);
  document.file = std::move(checked->file);
  document.moving = movingParts(document.file);
  document.note = noteOnExtensions(checked->extensions_used);
  Status status = checkParts(document);
  if (status) {
    status = checkSparseWork(document);
  }
  if (!status) {
    return status.error();
  }
  return document;
}

Result<Scene> convert(const Document& document) {
  const Result<NodeTree> tree = buildNodeTree(document);
  if (!tree) {
    return tree.error();
  }
  Accessors accessors(document);
  SceneBuilder builder(document.limits);
  if (!document.note.empty()) {
    builder.addNote(document.note);
  }
  Status status = addMaterials(document, builder);
  if (status) {
    status = addObjects(document, *tree, accessors, builder);
  }
  if (status) {
    status = addCameras(document, *tree, accessors, builder);
  }
  if (!status) {
    return status.error();
  }
  return builder.finish();
}

}  // namespace

Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors, const ImportLimits& limits) {
  // The libraries below may throw (above all when memory runs out); nothing leaves here.
  try {
    const Result<Document> document = load(bytes, base_dir, name_in_errors, limits);
    return document ? convert(*document) : Result<Scene>(document.error());
  } catch (const std::bad_alloc&) {
    return failure("{}: out of memory: the scene is too large for this machine", name_in_errors);
  } catch (const std::exception& exception) {
    return failure("{}: could not be read: {}", name_in_errors, exception.what());
  }
}

}  // namespace io

Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors) {
  return io::importGltf(bytes, base_dir, name_in_errors, io::ImportLimits{});
}

}  // namespace sightline
