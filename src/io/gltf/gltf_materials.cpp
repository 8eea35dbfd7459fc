#include <algorithm>
#include <cmath>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

// Transmission lets light through whatever the alpha mode says.
bool transmits(const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_transmission");
  return found != material.extensions.end() && found->second.Has("transmissionFactor") &&
         found->second.Get("transmissionFactor").GetNumberAsDouble() > 0.0;
}

Result<Material> convert(const Document& document, std::size_t number) {
  const tinygltf::Material& source = document.model.materials[number];
  Material material;
  material.name = source.name.empty() ? fmt::format("material{}", number) : source.name;
  material.double_sided = source.doubleSided;
  if (source.alphaMode == "BLEND" || transmits(source)) {
    material.opacity = Opacity::kBlended;
  } else if (source.alphaMode == "MASK") {
    material.opacity = Opacity::kAlphaTested;
  } else if (source.alphaMode != "OPAQUE") {
    return failure("{}: material {}: alpha mode \"{}\" is not OPAQUE, MASK or BLEND", document.name, number,
                   source.alphaMode);
  }
  const std::vector<double>& color = source.pbrMetallicRoughness.baseColorFactor;
  std::transform(color.begin(), color.end(), material.base_color.begin(),
                 [](double c) { return static_cast<float>(std::clamp(c, 0.0, 1.0)); });
  return material;
}

}  // namespace

Status addMaterials(const Document& document, SceneBuilder& builder) {
  for (std::size_t i = 0; i < document.model.materials.size(); ++i) {
    Result<Material> material = convert(document, i);
    if (!material) {
      return material.error();
    }
    builder.addMaterial(std::move(*material));
  }
  return Success{};
}

}  // namespace sightline::io
