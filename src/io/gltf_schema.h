#pragma once

// The part of the glTF 2.0 schema that Sightline reads, as tables.

#include <cstdint>
#include <span>

namespace sightline::gltf {

enum class Kind : std::uint8_t {
  kIndex,    // integer in [0, 2^31)
  kSize,     // integer in [0, 2^53]
  kNumber,   // any finite number
  kNumbers,  // array of finite numbers
  kIndices,  // array of kIndex
  kText,
  kTexts,    // array of strings
  kFlag,     // true or false
  kMark,     // extras: {"occluder": true | false | 0 | 1}
  kObject,   // object with the given fields
  kObjects,  // array of such objects
};

struct Field {
  const char* key;
  Kind kind;
  bool required = false;
  std::span<const Field> fields{};  // of an object, or of each of an array's objects
  const char* element = nullptr;    // kObjects: what one of them is called in errors
};

// Fields of the root object.
std::span<const Field> documentSchema();

}  // namespace sightline::gltf
