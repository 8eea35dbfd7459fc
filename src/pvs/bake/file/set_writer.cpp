#include "src/pvs/bake/file/set_writer.h"

#include <zstd.h>

#include <algorithm>

#include "src/pvs/format/checksum.h"
#include "src/pvs/format/set_code.h"

namespace sightline::pvs {
namespace {

// Levels of zstd, which decompress about equally fast. Short chunks are compressed hardest. For long ones
// that would take longer than to bake their sets, and gain a twentieth.
constexpr int kShortLevel = 19, kLongLevel = 1;
constexpr std::size_t kLongBytes = 8192;

// About how many bytes a chunk has before compression whose first set has so many. Sets of cells side by side
// repeat each other's bytes, so that together they take less. Each set that is looked up alone costs the
// decompression of its whole chunk, so only few long ones share one.
std::size_t chunkBytes(std::size_t first_set_bytes) {
  constexpr std::size_t kLongSets = 4;
  return std::clamp<std::size_t>(kLongSets * first_set_bytes, kSetChunkBytes, kMaxSetChunkBytes);
}

}  // namespace

ChunkWriter::ChunkWriter(Payload& payload, EncodedChunks& encoded)
    : payload_(payload),
      encoded_(encoded),
      offset_(encoded.chunks.empty() ? 0 : encoded.chunks.back().offset + encoded.chunks.back().bytes),
      context_(ZSTD_createCCtx()) {}

ChunkWriter::~ChunkWriter() {
  ZSTD_freeCCtx(context_);
}

// A zstd frame compressed in one call stores its size.
void ChunkWriter::append(std::span<const std::byte> raw, int level) {
  frame_.resize(ZSTD_compressBound(raw.size()));
  const std::size_t written =
      ZSTD_compressCCtx(context_, frame_.data(), frame_.size(), raw.data(), raw.size(), level);
  // With room for the bound, compression fails only if memory runs out.
  std::span<const std::byte> frame(frame_.data(), ZSTD_isError(written) != 0 ? 0 : written);
  if (!payload_.append(frame)) {
    frame = {};
  }
  encoded_.chunks.push_back({checksumOf(frame), offset_, static_cast<std::uint32_t>(frame.size()),
                             static_cast<std::uint32_t>(raw.size())});
  offset_ += frame.size();
}

SetWriter::SetWriter(std::span<const BoxNode> tree, Payload& payload, EncodedChunks& encoded)
    : tree_(tree),
      payload_(payload),
      encoded_(encoded),
      writer_(payload, encoded),
      decompressor_(ZSTD_createDCtx()) {}

SetWriter::~SetWriter() {
  ZSTD_freeDCtx(decompressor_);
}

// Equal sets have equal bytes.
bool SetWriter::same(std::uint32_t set, std::span<const std::uint32_t> nodes) {
  set_bytes_.clear();
  appendSet(set_bytes_, nodes, tree_);
  const auto [chunk, offset] = encoded_.sets[set];
  const bool written = chunk < encoded_.chunks.size();
  const std::span<const std::byte> raw = written ? chunkAgain(chunk) : std::span<const std::byte>(raw_);
  const bool last = set + 1 == count() || encoded_.sets[set + 1].chunk != chunk;
  const std::size_t end = last ? raw.size() : encoded_.sets[set + 1].offset;
  return end >= offset && end <= raw.size() &&
         std::ranges::equal(raw.subspan(offset, end - offset), set_bytes_);
}

void SetWriter::add(std::span<const std::uint32_t> nodes) {
  if (!soundSet(nodes, tree_)) {
    sound_ = false;
    nodes = {};
  }
  set_bytes_.clear();
  appendSet(set_bytes_, nodes, tree_);
  if (raw_.size() + set_bytes_.size() > raw_limit_) {
    finishChunk();
  }
  if (raw_.empty()) {
    raw_limit_ = chunkBytes(set_bytes_.size());
  }
  encoded_.sets.push_back(
      {static_cast<std::uint32_t>(encoded_.chunks.size()), static_cast<std::uint32_t>(raw_.size())});
  raw_.insert(raw_.end(), set_bytes_.begin(), set_bytes_.end());
}

void SetWriter::finish() {
  finishChunk();
  encoded_.set_chunks = static_cast<std::uint32_t>(encoded_.chunks.size());
}

void SetWriter::finishChunk() {
  if (!raw_.empty()) {
    writer_.append(raw_, raw_.size() > kLongBytes ? kLongLevel : kShortLevel);
    raw_.clear();
  }
}

std::span<const std::byte> SetWriter::chunkAgain(std::uint32_t chunk) {
  if (chunk != again_chunk_) {
    again_chunk_ = chunk;
    const Chunk& wanted = encoded_.chunks[chunk];
    frame_.resize(wanted.bytes);
    again_.resize(wanted.raw_bytes);
    if (!payload_.read(wanted.offset, frame_) ||
        ZSTD_decompressDCtx(decompressor_, again_.data(), again_.size(), frame_.data(), frame_.size()) !=
            again_.size()) {
      again_.clear();
    }
  }
  return again_;
}

}  // namespace sightline::pvs
