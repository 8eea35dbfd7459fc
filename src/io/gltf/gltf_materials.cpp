#include <algorithm>
#include <cmath>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

Result<Material> convert(const Document& document, std::size_t number) {
  const GltfFile::Material& source = document.file.materials[number];
  Material material;
  material.name = source.name.empty() ? fmt::format("material{}", number) : source.name;
  material.double_sided = source.double_sided;
  material.opacity = opacityOf(document, number);
  if (source.alpha_mode != "OPAQUE" && source.alpha_mode != "MASK" && source.alpha_mode != "BLEND") {
    return failure("{}: material {}: alpha mode \"{}\" is not OPAQUE, MASK or BLEND", document.name, number,
                   source.alpha_mode);
  }
  std::transform(source.base_color.begin(), source.base_color.end(), material.base_color.begin(),
                 [](double c) { return static_cast<float>(std::clamp(c, 0.0, 1.0)); });
  return material;
}

}  // namespace

Opacity opacityOf(const Document& document, std::size_t number) {
  const GltfFile::Material& material = document.file.materials[number];
  // Transmission lets light through whatever the alpha mode says, and so may materials for other levels of
  // detail.
  if (material.exchanged || material.alpha_mode == "BLEND" || material.transmission > 0.0 ||
      document.moving.materials[number]) {
    return Opacity::kBlended;
  }
  return material.alpha_mode == "MASK" ? Opacity::kAlphaTested : Opacity::kOpaque;
}

Status addMaterials(const Document& document, SceneBuilder& builder) {
  for (std::size_t i = 0; i < document.file.materials.size(); ++i) {
    Result<Material> material = convert(document, i);
    if (!material) {
      return material.error();
    }
    builder.addMaterial(std::move(*material));
  }
  return Success{};
}

}  // namespace sightline::io
