#pragma once

// Bytes as a hostile file has them, whose checksum is right.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "fuzz/readers/fuzz_input.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::fuzz {

// A file that begins with `head`, goes on with `text`, and ends with the checksum of both.
inline std::vector<std::byte> withChecksum(std::span<const std::byte> head, std::string_view text) {
  std::vector<std::byte> forged(head.begin(), head.end());
  const std::span<const std::byte> given = bytesOf(text);
  forged.insert(forged.end(), given.begin(), given.end());
  const std::uint64_t sum = pvs::checksumOf(forged);
  for (int shift = 0; shift < 64; shift += 8) {
    forged.push_back(static_cast<std::byte>(sum >> shift & 0xff));
  }
  return forged;
}

}  // namespace sightline::fuzz
