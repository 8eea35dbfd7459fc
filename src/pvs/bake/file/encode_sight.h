#pragma once

// Encodes baked data as the bytes of a .sight file.

#include <cstddef>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/format/sight_view.h"

namespace sightline::pvs {

// The compressed chunks of sets and databases.
struct EncodedChunks {
  std::vector<pvs::Chunk> chunks;  // without checksums; structureBytes fills them in
  std::uint32_t set_chunks = 0;    // number of chunks of sets, which come first
  std::vector<pvs::SetPlace> sets;
  std::vector<pvs::DatabaseEntry> databases;  // names point into the baked data
  std::vector<std::byte> payload;
};

// Compresses without any checks.
EncodedChunks encodeChunks(const BakedVisibility& baked);

// The input of structureBytes; both arguments must outlive it.
pvs::SightView viewOf(const BakedVisibility& baked, const EncodedChunks& encoded);

// The bytes of a file: those of its structure, then those of its payload.
struct SightBytes {
  std::vector<std::byte> structure, payload;

  std::uint64_t size() const { return structure.size() + payload.size(); }
  std::vector<std::byte> joined() const;
};
// Returns an error if the data is invalid (a reader would reject it) or too large.
Result<SightBytes> encodeSight(const BakedVisibility& baked);

}  // namespace sightline::pvs
