#include "src/occluders/database/database_bytes.h"

#include <algorithm>
#include <string>
#include <vector>

#include "src/occluders/database/sphere_directions.h"

namespace sightline::occluders {
namespace {

constexpr std::uint32_t kVersion = 1;

}  // namespace

void addDatabaseHead(base::ByteWriter& writer, const DatabaseKind& kind, const DatabaseHead& head) {
  writer.addAll(std::span<const char>(kind.letters));
  for (const std::uint32_t value : {kVersion, head.directions, head.occluders}) {
    writer.add(value);
  }
}

Result<std::uint32_t> readDatabaseHead(base::ByteReader& reader, const DatabaseKind& kind,
                                       std::uint32_t occluder_count) {
  const std::vector<char> letters = reader.readAll<char>(kind.letters.size());
  const auto version = reader.read<std::uint32_t>();
  const auto directions = reader.read<std::uint32_t>(), occluders = reader.read<std::uint32_t>();
  if (!std::ranges::equal(letters, kind.letters)) {
    return Error{"begins with the letters of something else"};
  }
  if (version != kVersion) {
    return Error{"has version " + std::to_string(version) + ", but only version " + std::to_string(kVersion) +
                 " can be read: make it anew"};
  }
  if (directions > kMaxDirections) {
    return Error{"has " + std::to_string(directions) + " directions"};
  }
  // Without directions it has no lists, and is of any set.
  if (occluders != (directions > 0 ? occluder_count : 0)) {
    return Error{"is of " + std::to_string(occluders) + " occluders, but the scene has " +
                 std::to_string(occluder_count) + ": make it anew"};
  }
  return directions;
}

Error databaseError(const DatabaseKind& kind, const base::ByteReader& reader, const Error* part) {
  const std::string subject = "the " + std::string(kind.name) + " ";
  if (!reader.ok()) {
    return {subject + "is truncated at byte " + std::to_string(reader.position())};
  }
  return {subject + (part != nullptr ? part->message
                                     : "is followed by other bytes from byte " +
                                           std::to_string(reader.position()) + " on")};
}

}  // namespace sightline::occluders
