#include "src/io/gltf/gltf.h"

#include <algorithm>
#include <array>
#include <exception>

#include "sightline/io/import.h"
#include "src/io/gltf/gltf_json.h"
#include "src/io/gltf/gltf_model.h"

namespace sightline {
namespace io {
namespace {

// Extensions that change nothing of what we read (they are about shading, light and metadata), or that we do
// read.
constexpr std::array<std::string_view, 5> kHonouredExtensions = {
    "KHR_mesh_quantization", "KHR_texture_transform", "KHR_texture_basisu",
    "KHR_lights_punctual",   "KHR_xmp_json_ld",
};
constexpr std::array<std::string_view, 2> kHonouredTextureFormats = {"EXT_texture_webp", "MSFT_texture_dds"};

bool honoured(std::string_view extension) {
  return extension.substr(0, 14) == "KHR_materials_" ||
         std::find(kHonouredExtensions.begin(), kHonouredExtensions.end(), extension) !=
             kHonouredExtensions.end() ||
         std::find(kHonouredTextureFormats.begin(), kHonouredTextureFormats.end(), extension) !=
             kHonouredTextureFormats.end();
}

std::string firstLine(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  return line.empty() ? "unknown reason" : line;
}

// Parses text that checkJson has passed; tinygltf sees no files, no buffers and no images.
Status parse(const CheckedJson& checked, Document& document) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
                           int, void*) { return true; },
                        nullptr);
  loader.SetFsCallbacks(tinygltf::FsCallbacks{nullptr, nullptr, nullptr, nullptr, nullptr});
  std::string error;
  std::string warning;
  if (!loader.LoadASCIIFromString(&document.model, &error, &warning, checked.text.data(),
                                  static_cast<unsigned int>(checked.text.size()), "", tinygltf::NO_REQUIRE)) {
    return failure("{}: is not valid glTF: {}", document.name, firstLine(error));
  }
  return Success{};
}

// The elements that sparse accessors replace are checked one by one, and accessors may share them.
Status checkSparseWork(const Document& document) {
  std::uint64_t replaced = 0;
  for (const tinygltf::Accessor& accessor : document.model.accessors) {
    replaced += accessor.sparse.isSparse ? static_cast<std::uint64_t>(accessor.sparse.count) : 0;
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
  const Result<CheckedJson> checked = checkJson(container->json, limits, name);
  if (!checked) {
    return checked.error();
  }
  for (const std::string& extension : checked->extensions_required) {
    if (!honoured(extension)) {
      return failure("{}: requires the extension \"{}\", which is not supported; export the scene without it",
                     name, extension);
    }
  }
  Result<Buffers> buffers = loadBuffers(checked->buffers, *container, base_dir, name);
  if (!buffers) {
    return buffers.error();
  }
  document.buffers = std::move(*buffers);
  Status status = parse(*checked, document);
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
}  // namespace io

Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors, const ImportLimits& limits) {
  // The libraries below may throw (above all when memory runs out); nothing leaves here.
  try {
    const Result<io::Document> document = io::load(bytes, base_dir, name_in_errors, limits);
    return document ? io::convert(*document) : Result<Scene>(document.error());
  } catch (const std::exception& exception) {
    return failure("{}: could not be read: {}", name_in_errors, exception.what());
  }
}

Result<Scene> importGltf(std::string_view bytes, const std::string& base_dir,
                         const std::string& name_in_errors) {
  return importGltf(bytes, base_dir, name_in_errors, ImportLimits{});
}

}  // namespace sightline
