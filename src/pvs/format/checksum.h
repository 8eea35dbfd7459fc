#pragma once

// XXH3, the checksum of .sight files and the hash of scenes; the same on every machine. With XXH_INLINE_ALL,
// which is defined where this is compiled, the header alone is enough.

#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace sightline::pvs {

inline std::uint64_t checksumOf(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

// The same checksum, of bytes that are added piece by piece.
class Checksum {
 public:
  Checksum() { XXH3_64bits_reset(&state_); }

  void add(std::span<const std::byte> bytes) {
    if (!bytes.empty()) {
      XXH3_64bits_update(&state_, bytes.data(), bytes.size());
    }
  }
  // Adds a number, or an array of numbers, of a type without padding.
  template <typename T>
  void addValue(const T& value) {
    static_assert(std::has_unique_object_representations_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

}  // namespace sightline::pvs
