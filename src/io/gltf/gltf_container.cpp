#include <cstring>

#include "src/io/failure.h"
#include "src/io/gltf/gltf_json.h"

namespace sightline::io {
namespace {

constexpr std::uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004e4942;

std::uint32_t readUint32(std::string_view bytes, std::size_t offset) {
  unsigned char b[4];
  std::memcpy(b, bytes.data() + offset, 4);
  return b[0] | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
}

struct Chunk {
  std::uint32_t type = 0;
  std::string_view bytes;
};

// The chunk that starts at offset; offset moves behind it.
Result<Chunk> readChunk(std::string_view bytes, std::size_t& offset, int number, const std::string& name) {
  if (bytes.size() - offset < 8) {
    return failure("{}: chunk {}: its header at byte {} is cut off by the end of the file", name, number,
                   offset);
  }
  const std::uint32_t length = readUint32(bytes, offset);
  const std::uint32_t type = readUint32(bytes, offset + 4);
  offset += 8;
  if (length > bytes.size() - offset) {
    return failure("{}: chunk {}: has {} bytes by its header, but only {} are left in the file", name, number,
                   length, bytes.size() - offset);
  }
  const Chunk chunk{type, bytes.substr(offset, length)};
  offset += length;
  return chunk;
}

}  // namespace

Result<Container> splitContainer(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) {
    return failure("{}: the file is empty", name);
  }
  if (bytes.size() < 4 || readUint32(bytes, 0) != kMagic) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    const bool marked = bytes.substr(0, 3) == kByteOrderMark;
    return Container{marked ? bytes.substr(3) : bytes, std::nullopt};
  }
  if (bytes.size() < 12) {
    return failure("{}: the header of the binary glTF is cut off after {} of 12 bytes", name, bytes.size());
  }
  const std::uint32_t version = readUint32(bytes, 4);
  if (version != 2) {
    return failure("{}: binary glTF version {} is not supported, only version 2", name, version);
  }
  const std::uint32_t length = readUint32(bytes, 8);
  if (length > bytes.size()) {
    return failure("{}: the file is cut off: {} of {} bytes are there", name, bytes.size(), length);
  }
  bytes = bytes.substr(0, length);
  if (length < 12) {
    return failure("{}: states a length of {} bytes, less than its own header", name, length);
  }
  std::size_t offset = 12;
  const Result<Chunk> json = readChunk(bytes, offset, 0, name);
  if (!json) {
    return json.error();
  }
  if (json->type != kJsonChunk) {
    return failure("{}: chunk 0: is of type 0x{:08x}; the first chunk must be JSON", name, json->type);
  }
  Container container{json->bytes, std::nullopt};
  for (int number = 1; offset < bytes.size(); ++number) {
    const Result<Chunk> chunk = readChunk(bytes, offset, number, name);
    if (!chunk) {
      return chunk.error();
    }
    if (number == 1 && chunk->type == kBinaryChunk) {
      container.binary_chunk = chunk->bytes;
    }
  }
  return container;
}

}  // namespace sightline::io
