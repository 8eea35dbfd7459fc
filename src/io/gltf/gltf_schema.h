#pragma once

// The part of the glTF 2.0 schema that Sightline reads, as tables.

#include <cstddef>
#include <cstdint>
#include <span>

namespace sightline::io {

enum class Kind : std::uint8_t {
  kIndex,    // integer in [0, 2^31)
  kSize,     // integer in [0, 2^53]
  kNumber,   // any finite number
  kNumbers,  // array of finite numbers, Field::count of them; any number of them if that is 0
  kIndices,  // array of kIndex
  kSets,     // numbered keys "KEY0", "KEY1", ..., each a kIndex: handed on as an array under "KEY"
  kStride,   // 0 or a multiple of 4 up to 252
  kText,
  kElementType,  // "SCALAR", "VEC3", ...
  kTexts,        // array of strings
  kFlag,         // true or false
  kMark,         // extras: {"occluder": true | false | 0 | 1}
  kObject,       // object with the given fields
  kObjects,      // array of such objects
};

struct Field {
  const char* key;
  Kind kind;
  bool required = false;
  std::span<const Field> fields{};  // of an object, or of each of an array's objects
  const char* element = nullptr;    // kObjects: what one of them is called in errors
  std::size_t count = 0;            // kNumbers
  bool few = false;                 // kObjects: big in memory though short in the file, so no more than kFew
};

inline constexpr std::size_t kFew = 65536;
inline constexpr std::size_t kMostSets = 8;

// Fields of the root object.
std::span<const Field> documentSchema();

}  // namespace sightline::io
