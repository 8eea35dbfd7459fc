#pragma once

// The payload of a .sight file, chunk by chunk: sets are compressed as they come and need not be kept.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "src/pvs/bake/file/set_store.h"
#include "src/pvs/format/sight_view.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace sightline::pvs {

// The compressed chunks of sets and databases.
struct EncodedChunks {
  std::vector<Chunk> chunks;
  std::uint32_t set_chunks = 0;  // number of chunks of sets, which come first
  std::vector<SetPlace> sets;
  std::vector<DatabaseEntry> databases;  // names point into the baked data
  std::vector<std::byte> payload;        // empty if the payload is kept elsewhere
};

// Where the payload of a file is kept until the file is written.
class Payload {
 public:
  virtual ~Payload() = default;
  // Both return false if that fails.
  virtual bool append(std::span<const std::byte> bytes) = 0;
  virtual bool read(std::uint64_t offset, std::span<std::byte> bytes) = 0;
};

// Appends chunks to a payload.
class ChunkWriter {
 public:
  ChunkWriter(Payload& payload, EncodedChunks& encoded);
  ~ChunkWriter();
  ChunkWriter(const ChunkWriter&) = delete;
  ChunkWriter& operator=(const ChunkWriter&) = delete;

  // Compresses the bytes into a chunk. level: of zstd. The chunk is empty, and so not sound, if memory ran
  // out or the payload could not take it.
  void append(std::span<const std::byte> raw, int level);

 private:
  Payload& payload_;
  EncodedChunks& encoded_;
  std::uint64_t offset_;  // of the next chunk in the payload
  ZSTD_CCtx_s* context_;
  std::vector<std::byte> frame_;
};

// Packs sets into chunks, in the order of their numbers.
class SetWriter final : public SetStore {
 public:
  // tree: of the nodes. All arguments must outlive this object.
  SetWriter(std::span<const BoxNode> tree, Payload& payload, EncodedChunks& encoded);
  ~SetWriter() override;

  std::uint32_t count() const override { return static_cast<std::uint32_t>(encoded_.sets.size()); }
  bool same(std::uint32_t set, std::span<const std::uint32_t> nodes) override;
  void add(std::span<const std::uint32_t> nodes) override;
  void finish();  // writes the last chunk; no more sets may be added
  // Whether each set was a soundSet of the tree. Others are written as empty ones.
  bool sound() const { return sound_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  void finishChunk();
  // The decompressed chunk, which has been written; empty if it cannot be read.
  std::span<const std::byte> chunkAgain(std::uint32_t chunk);

  std::span<const BoxNode> tree_;
  Payload& payload_;
  EncodedChunks& encoded_;
  ChunkWriter writer_;
  bool sound_ = true;
  std::vector<std::byte> raw_;  // of the chunk that is not written yet
  std::size_t raw_limit_ = 0;   // its bytes, unless it is a single set
  std::vector<std::byte> set_bytes_;
  ZSTD_DCtx_s* decompressor_;
  std::uint32_t again_chunk_ = kNone;  // the chunk in again_
  std::vector<std::byte> frame_, again_;
};

}  // namespace sightline::pvs
