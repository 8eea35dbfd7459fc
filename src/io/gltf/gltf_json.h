#pragma once

// The first steps of the glTF reader: container, JSON nesting, and the type and range of every value. What
// Sightline does not use (images, textures, most extensions and extras, ...) is left behind here.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "src/io/gltf/gltf_file.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// The JSON text and the binary chunk of a .glb, or the text alone of a .gltf. Views of the bytes given.
struct Container {
  std::string_view json;
  std::optional<std::string_view> binary_chunk;
};
Result<Container> splitContainer(std::string_view bytes, const std::string& name);

struct BufferSource {
  std::uint64_t byte_length = 0;
  std::optional<std::string> uri;
};

struct CheckedJson {
  GltfFile file;
  std::vector<BufferSource> buffers;
  std::vector<std::string> extensions_used, extensions_required;
};
Result<CheckedJson> checkJson(std::string_view json, const ImportLimits& limits, const std::string& name);

}  // namespace sightline::io
