#pragma once

#include <nlohmann/json_fwd.hpp>

#include "src/io/gltf/gltf_file.h"

namespace sightline::io {

// The parts of a document that has passed the schema: every field is absent or of its right type and in
// range.
GltfFile partsOf(const nlohmann::json& document);

}  // namespace sightline::io
