#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "src/pvs/format/sight_view.h"

struct ZSTD_DCtx_s;

namespace sightline::pvs {

// Decompresses the chunks of a checked view and caches the last chunk of sets. For use by one thread at a
// time, and always with the same view.
class ChunkDecoder {
 public:
  ChunkDecoder();
  ~ChunkDecoder();
  ChunkDecoder(ChunkDecoder&&) noexcept;
  ChunkDecoder& operator=(ChunkDecoder&&) noexcept;

  // Appends the nodes of a set; set < view.sets.size(). Returns false and appends nothing if its chunk is
  // corrupt. Allocates nothing more once it has seen the longest chunk.
  bool readSet(const SightView& view, std::uint32_t set, std::vector<std::uint32_t>& nodes);

  // Bytes of chunks, as they are in the payload, that readSet has read so far.
  std::uint64_t bytesRead() const { return bytes_read_; }

  // Appends the contents of a chunk. Returns false and appends nothing if the chunk is corrupt.
  bool decompress(const SightView& view, const Chunk& chunk, std::vector<std::byte>& raw);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
  std::vector<std::byte> raw_;  // contents of the last chunk
  std::uint32_t last_chunk_ = kNone;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace sightline::pvs
