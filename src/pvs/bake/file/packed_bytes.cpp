#include "src/pvs/bake/file/packed_bytes.h"

#include <zstd.h>

#include <cstdint>

#include "src/base/byte_stream.h"

namespace sightline::pvs {
namespace {

constexpr int kPackingLevel = 3;  // of zstd

}  // namespace

std::vector<std::byte> pack(std::span<const std::byte> bytes) {
  std::vector<std::byte> frame(ZSTD_compressBound(bytes.size()));
  const std::size_t length =
      ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kPackingLevel);
  const bool shorter =
      ZSTD_isError(length) == 0 && length < bytes.size() && bytes.size() / length < kMaxPackedGain;
  base::ByteWriter packed;
  packed.add(static_cast<std::uint64_t>(bytes.size()));
  packed.addBytes(shorter ? std::span<const std::byte>(frame).first(length) : bytes);
  return packed.take();
}

std::optional<std::vector<std::byte>> unpack(std::span<const std::byte> packed) {
  base::ByteReader reader(packed);
  const auto length = reader.read<std::uint64_t>();
  const std::span<const std::byte> stored = reader.readBytes(reader.remaining());
  if (!reader.ok() || length < stored.size() || length / kMaxPackedGain > stored.size()) {
    return std::nullopt;
  }
  if (length == stored.size()) {
    return std::vector<std::byte>(stored.begin(), stored.end());
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(length));
  const std::size_t written = ZSTD_decompress(bytes.data(), bytes.size(), stored.data(), stored.size());
  return ZSTD_isError(written) == 0 && written == bytes.size() ? std::optional(std::move(bytes))
                                                               : std::nullopt;
}

}  // namespace sightline::pvs
