#pragma once

// What the bytes of both occluder databases begin with: four letters, then of 32 bits each a version, the
// number of directions (0: default constructed, and nothing follows) and that of the occluders of the set.

#include <cstdint>
#include <string_view>

#include "sightline/base/result.h"
#include "src/base/byte_stream.h"

namespace sightline::occluders {

struct DatabaseKind {
  std::string_view name;     // for errors
  std::string_view letters;  // four
};

struct DatabaseHead {
  std::uint32_t directions = 0;
  std::uint32_t occluders = 0;
};

void addDatabaseHead(ByteWriter& writer, const DatabaseKind& kind, const DatabaseHead& head);

// The number of directions, at most kMaxDirections. As with all that reads parts of a database, an error
// lacks its subject, and means nothing where the reader failed.
Result<std::uint32_t> readDatabaseHead(ByteReader& reader, const DatabaseKind& kind,
                                       std::uint32_t occluder_count);

// One line for what went wrong. part: null where all parts were sound, but other bytes follow.
Error databaseError(const DatabaseKind& kind, const ByteReader& reader, const Error* part);

}  // namespace sightline::occluders
