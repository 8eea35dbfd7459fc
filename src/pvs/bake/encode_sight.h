#pragma once

// From baked data to the bytes of a .sight file.

#include <cstddef>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/format/sight_view.h"

namespace sightline::pvs {

// The chunks of sets and databases, compressed.
struct EncodedChunks {
  std::vector<pvs::Chunk> chunks;  // without checksums: sightBytes fills them in
  std::uint32_t set_chunks = 0;    // the first of them
  std::vector<pvs::SetPlace> sets;
  std::vector<pvs::DatabaseEntry> databases;  // names are those of the baked data
  std::vector<std::byte> payload;
};

// Checks nothing.
EncodedChunks encodeChunks(const BakedVisibility& baked);

// What sightBytes makes a file of; both must outlive it.
pvs::SightView viewOf(const BakedVisibility& baked, const EncodedChunks& encoded);

// The bytes of the whole file. An error where the data is not sound (no reader would take it) or too large.
Result<std::vector<std::byte>> encodeSight(const BakedVisibility& baked);

}  // namespace sightline::pvs
