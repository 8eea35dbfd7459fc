#pragma once

// What the URIs in a glTF file name.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::io {

// Decodes percent signs: "a%20b" -> "a b". Nothing if one has no two hexadecimal digits, or is "%00".
std::optional<std::string> decodePercent(std::string_view text);

// The files that a .gltf or .glb names, whether or not Sightline reads them: buffers and pictures, relative
// to the scene's folder. A name that cannot be decoded is left as it is. Empty for what is not glTF.
std::vector<std::string> filesNamedByGltf(std::string_view bytes);

}  // namespace sightline::io
