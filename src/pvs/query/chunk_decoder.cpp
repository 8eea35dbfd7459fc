#include "src/pvs/query/chunk_decoder.h"

#include <zstd.h>

#include "src/pvs/format/checksum.h"
#include "src/pvs/format/set_code.h"

namespace sightline::pvs {

void ChunkDecoder::Free::operator()(ZSTD_DCtx_s* context) const {
  ZSTD_freeDCtx(context);
}

ChunkDecoder::ChunkDecoder() : context_(ZSTD_createDCtx()) {}
ChunkDecoder::~ChunkDecoder() = default;
ChunkDecoder::ChunkDecoder(ChunkDecoder&&) noexcept = default;
ChunkDecoder& ChunkDecoder::operator=(ChunkDecoder&&) noexcept = default;

bool ChunkDecoder::decompress(const SightView& view, const Chunk& chunk, std::vector<std::byte>& raw) {
  const std::span<const std::byte> bytes = view.bytesOf(chunk);
  // Check the size that the frame claims first, so that a forged size allocates no memory.
  if (context_ == nullptr || checksumOf(bytes) != chunk.checksum ||
      ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != chunk.raw_bytes) {
    return false;
  }
  const std::size_t before = raw.size();
  raw.resize(before + chunk.raw_bytes);
  const std::size_t written =
      ZSTD_decompressDCtx(context_.get(), raw.data() + before, chunk.raw_bytes, bytes.data(), bytes.size());
  if (ZSTD_isError(written) != 0 || written != chunk.raw_bytes) {
    raw.resize(before);
    return false;
  }
  return true;
}

bool ChunkDecoder::readSet(const SightView& view, std::uint32_t set, std::vector<std::uint32_t>& nodes) {
  const auto [chunk, offset] = view.sets[set];
  if (chunk != last_chunk_) {
    last_chunk_ = kNone;
    raw_.clear();
    bytes_read_ += view.chunks[chunk].bytes;
    if (!decompress(view, view.chunks[chunk], raw_)) {
      return false;
    }
    last_chunk_ = chunk;
  }
  const std::span<const std::byte> raw(raw_);
  return decodeSet(raw.subspan(offset, view.endOf(set) - offset), view.ends, nodes);
}

}  // namespace sightline::pvs
