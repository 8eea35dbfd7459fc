#include "src/io/gltf/gltf_extensions.h"

#include <algorithm>
#include <array>

#include "src/io/failure.h"

namespace sightline::io {
namespace {

constexpr std::array<std::string_view, 9> kMayBeRequired = {
    "KHR_mesh_quantization",   "KHR_texture_transform", "KHR_texture_basisu",
    "KHR_lights_punctual",     "KHR_xmp_json_ld",       "KHR_node_visibility",
    "EXT_mesh_gpu_instancing", "EXT_texture_webp",      "MSFT_texture_dds",
};

// Those that a file may use besides, if it can be read without them. Of the first row, the reader knows what
// they move or exchange; compressed meshes are there in plain form too; the others are about light, pictures,
// sound, shapes for physics and data.
constexpr std::array<std::string_view, 17> kKnown = {
    "KHR_animation_pointer",      "MSFT_lod",
    "AGI_articulations",          "KHR_physics_rigid_bodies",
    "KHR_draco_mesh_compression", "EXT_meshopt_compression",
    "KHR_meshopt_compression",    "KHR_audio_emitter",
    "KHR_implicit_shapes",        "KHR_node_selectability",
    "KHR_node_hoverability",      "KHR_xmp",
    "EXT_mesh_features",          "EXT_instance_features",
    "EXT_structural_metadata",    "AGI_stk_metadata",
    "FB_ngon_encoding",
};
constexpr std::array<std::string_view, 8> kKnownFamilies = {
    "KHR_materials_", "ADOBE_materials_", "KHR_texture_", "EXT_texture_",
    "MSFT_texture_",  "MSFT_packing_",    "KHR_lights_",  "EXT_lights_",
};

bool isAmong(std::string_view name, auto& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

bool mayBeRequired(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || isAmong(extension, kMayBeRequired);
}

std::string noteOnExtensions(const std::vector<std::string>& used) {
  constexpr std::size_t kMostNamed = 8, kMostLetters = 64;
  std::string names;
  std::size_t unknown = 0;
  for (const std::string& name : used) {
    const bool known = mayBeRequired(name) || isAmong(name, kKnown) ||
                       std::any_of(kKnownFamilies.begin(), kKnownFamilies.end(),
                                   [&](std::string_view family) { return name.starts_with(family); });
    if (!known && ++unknown <= kMostNamed) {
      names += (names.empty() ? "" : ", ") + name.substr(0, kMostLetters);
    }
  }
  if (unknown > kMostNamed) {
    names += fmt::format(" and {} more", unknown - kMostNamed);
  }
  return names.empty()
             ? names
             : oneLine(fmt::format(
                   "the file uses extensions that are not known here: {}. It is read as though they "
                   "were not there; to what they move, hide or let one see through, give \"extras\": "
                   "{{\"occluder\": false}}",
                   names));
}

}  // namespace sightline::io
