#pragma once

// What the bytes of an occluder database begin with: four letters, then, in 32 bits each, a version, the
// number of directions (0: the database is default constructed, and nothing follows) and the number of
// occluders in the set.

#include <cstdint>
#include <string_view>

#include "sightline/base/result.h"
#include "src/base/byte_stream.h"

namespace sightline::occluders {

struct DatabaseKind {
  std::string_view name;     // in errors
  std::string_view letters;  // four, with which the bytes begin
  std::string_view places;   // what it has lists for, in errors
};

struct DatabaseHead {
  std::uint32_t directions = 0;
  std::uint32_t occluders = 0;
};

void addDatabaseHead(base::ByteWriter& writer, const DatabaseKind& kind, const DatabaseHead& head);

// The number of directions, at most kMaxDirections. An error lacks its subject, and means nothing where the
// reader failed: so do those of all functions that read a part of a database.
Result<std::uint32_t> readDatabaseHead(base::ByteReader& reader, const DatabaseKind& kind,
                                       std::uint32_t occluder_count);

// One line that says what went wrong. part: the error of a part; null: all parts were sound, but other bytes
// follow.
Error databaseError(const DatabaseKind& kind, const base::ByteReader& reader, const Error* part);

}  // namespace sightline::occluders
