#pragma once

// Encodes baked data as the bytes of a .sight file.

#include <cstddef>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/bake/file/set_writer.h"
#include "src/pvs/format/sight_view.h"

namespace sightline::pvs {

// Appends the chunks of the databases to those of the sets, which must be finished.
void encodeDatabases(std::span<const DatabaseBlob> databases, Payload& payload, EncodedChunks& encoded);

// Compresses without any checks.
EncodedChunks encodeChunks(const BakedVisibility& baked);

// The input of structureBytes; both arguments must outlive it.
SightView viewOf(const BakedVisibility& baked, const EncodedChunks& encoded);

// The bytes of a file: those of its structure, then those of its payload.
struct SightBytes {
  std::vector<std::byte> structure, payload;

  std::uint64_t size() const { return structure.size() + payload.size(); }
  std::vector<std::byte> joined() const;
};
// Returns an error if the data is invalid (a reader would reject it) or too large.
Result<SightBytes> encodeSight(const BakedVisibility& baked);

}  // namespace sightline::pvs
