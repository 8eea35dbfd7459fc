#pragma once

// Bytes compressed by zstd, for what a bake keeps beside its result. Unpacking is for bytes of any origin.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sightline::pvs {

// The length of the bytes; then one zstd frame, or the bytes themselves where a frame would not be shorter.
std::vector<std::byte> pack(std::span<const std::byte> bytes);
// The bytes that were packed; nothing if these are not packed ones. Takes at most kMaxPackedGain times as
// much memory as it is given.
std::optional<std::vector<std::byte>> unpack(std::span<const std::byte> packed);

// What could be packed to fewer bytes than one in so many is stored as it is. Sets and answers gain 4 to 30.
inline constexpr std::size_t kMaxPackedGain = 256;

}  // namespace sightline::pvs
