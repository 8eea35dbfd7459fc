#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "src/io/gltf/gltf_json.h"

namespace sightline::io {

// The bytes of every buffer of a file, each exactly as long as the file says. Views of the binary chunk given
// and of what was loaded or decoded.
struct Buffers {
  std::vector<std::string_view> bytes;
  std::vector<std::unique_ptr<const std::string>> owned;
};

// Finds the bytes: binary chunk, data: URI, or a file under base_dir (never outside it; refused when empty).
Result<Buffers> loadBuffers(const std::vector<BufferSource>& sources, const Container& container,
                            const std::string& base_dir, const std::string& name);

}  // namespace sightline::io
