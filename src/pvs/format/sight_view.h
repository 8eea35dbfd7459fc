#pragma once

// A .sight file as plain data, wherever its bytes lie: what its writer fills in and its reader hands out.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/scene_id.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline::pvs {

inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::uint64_t kMaxFileBytes = 0x7fffffffu;  // what a FlatBuffer can hold

// Chunks of sets are about as long as the first of these before compression: one is decompressed in some
// microseconds. None is longer than the second one, but for sets that are longer themselves.
inline constexpr std::uint32_t kSetChunkBytes = 2048;
inline constexpr std::uint32_t kMaxSetChunkBytes = 65536;
inline constexpr std::uint32_t kDatabaseChunkBytes = 1u << 20;
inline constexpr std::uint64_t kMaxDatabaseBytes = 1u << 30;
inline constexpr std::size_t kMaxDatabases = 64;

// A zstd frame in the payload.
struct Chunk {
  std::uint64_t checksum = 0;  // of its bytes in the payload
  std::uint64_t offset = 0;    // into payload
  std::uint32_t bytes = 0, raw_bytes = 0;
};

// Where a set begins in a decompressed chunk.
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
  std::vector<std::uint32_t> ends;  // endsOf the boxes' nodes, where sets are to be decoded
  OctreeView octree;
  std::uint32_t set_chunks = 0;  // the first of chunks
  std::span<const SetPlace> sets;
  std::span<const Chunk> chunks;  // those of sets, then those of databases in their order
  std::vector<DatabaseEntry> databases;
  std::span<const std::byte> payload;

  std::span<const std::byte> bytesOf(const Chunk& chunk) const {
    return payload.subspan(chunk.offset, chunk.bytes);
  }
  // The bytes of a set in its decompressed chunk: [begin, end).
  std::uint32_t endOf(std::uint32_t set) const {
    const std::uint32_t chunk = sets[set].chunk;
    return set + 1 < sets.size() && sets[set + 1].chunk == chunk ? sets[set + 1].offset
                                                                 : chunks[chunk].raw_bytes;
  }
};

// The bytes of a file, with its seal but without any check. Checksums of chunks are filled in. An error where
// it would be too long.
Result<std::vector<std::byte>> sightBytes(const SightView& view);

// Writes the checksums of chunks and the seal into the bytes of a file, over whatever stands there. Bytes
// that are no such FlatBuffer stay as they are. They start at a multiple of eight.
void seal(std::span<std::byte> bytes);

// What is in a file, in place: bytes start at a multiple of eight and must outlive it. All that may be asked
// of the view is checked but the contents of chunks. Errors lack the file's name.
Result<SightView> viewOf(std::span<const std::byte> bytes);

// Whether all parts of a view fit together, so that reading it is safe and its answers mean something.
Status checkView(const SightView& view);

}  // namespace sightline::pvs
