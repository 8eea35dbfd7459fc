#pragma once

// A .sight file as plain data, independent of where its bytes are: filled in by the writer, returned by the
// reader.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/doors.h"
#include "sightline/pvs/format/scene_id.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

inline constexpr std::uint32_t kVersion = 2;
inline constexpr std::uint64_t kMaxStructureBytes = 0x7ffffffeu;  // a FlatBuffer is smaller than 2^31 - 1

// Chunks of sets are about kSetChunkBytes long before compression, so that one is decompressed in a few
// microseconds, or as long as a few sets where these are longer. None is longer than kMaxSetChunkBytes,
// except for a single set that is longer itself.
inline constexpr std::uint32_t kSetChunkBytes = 2048;
inline constexpr std::uint32_t kMaxSetChunkBytes = 65536;
inline constexpr std::uint32_t kDatabaseChunkBytes = 1u << 20;
inline constexpr std::uint64_t kMaxDatabaseBytes = 1u << 30;
inline constexpr std::size_t kMaxDatabases = 64;

// A zstd frame in the payload.
struct Chunk {
  std::uint64_t checksum = 0;  // of the chunk's bytes in the payload
  std::uint64_t offset = 0;    // into the payload
  std::uint32_t bytes = 0, raw_bytes = 0;
};

// Where a set begins in its decompressed chunk.
struct SetPlace {
  std::uint32_t chunk = 0, offset = 0;
};

struct DatabaseEntry {
  std::string_view name;
  std::uint64_t occluders = 0;
  std::uint64_t raw_bytes = 0;
  std::uint32_t first_chunk = 0, chunk_count = 0;
};

struct SightView {
  SceneId scene;
  double near_distance = 0.0;
  std::uint64_t triangle_budget = 0;
  std::uint32_t max_depth = 0;
  std::string_view settings;
  BoxTreeView boxes;
  std::vector<std::uint32_t> ends;  // endsOf() the boxes' nodes, if sets are to be decoded
  OctreeView octree;
  std::uint32_t set_chunks = 0;  // number of chunks of sets, which come first
  std::span<const SetPlace> sets;
  DoorsView doors;
  std::span<const Chunk> chunks;  // chunks of sets, then those of databases in their order
  std::vector<DatabaseEntry> databases;
  std::span<const std::byte> payload;
  // Bytes of the payload that are not in memory, but follow `payload` in the file; while one is written.
  std::uint64_t payload_elsewhere = 0;

  std::uint64_t payloadBytes() const { return payload.size() + payload_elsewhere; }
  std::span<const std::byte> bytesOf(const Chunk& chunk) const {
    return payload.subspan(chunk.offset, chunk.bytes);
  }
  // End of a set's bytes in its decompressed chunk; exclusive.
  std::uint32_t endOf(std::uint32_t set) const {
    const std::uint32_t chunk = sets[set].chunk;
    return set + 1 < sets.size() && sets[set + 1].chunk == chunk ? sets[set + 1].offset
                                                                 : chunks[chunk].raw_bytes;
  }
};

// The bytes of a file's structure, including the seal, and checksums of the chunks in view.payload; others
// must have theirs. The file consists of these bytes and those of the payload. The view is not checked.
// Returns an error if the structure would be too long.
Result<std::vector<std::byte>> structureBytes(const SightView& view);

// Writes the checksums of chunks and the seal into the bytes of a whole file, overwriting those that are
// there. Bytes that do not begin with such a structure are left unchanged. They must start at a multiple of
// eight.
void seal(std::span<std::byte> bytes);

// A view of a file in place: bytes must start at a multiple of eight and outlive the view. Checks everything
// except the contents of chunks. Errors do not contain the file's name.
Result<SightView> viewOf(std::span<const std::byte> bytes);

// Checks that all parts of a view are consistent, so that reading it is safe and its results are meaningful.
Status checkView(const SightView& view);

}  // namespace sightline::pvs
