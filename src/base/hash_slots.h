#pragma once

// Hash tables with open addressing and linear probing.

#include <cstddef>
#include <cstdint>

namespace sightline::base {

// A hash of which every bit depends on all bits of the value. Source: the last step of SplitMix64 (Steele,
// Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014).
inline std::uint64_t mixBits(std::uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
  return value ^ (value >> 31);
}

// The index of the first slot, from number `hash` on (modulo their number) and past the end to the beginning,
// for which stop(slot) is true: a key's own slot or the free one where it belongs. There is such a slot, and
// the number of slots is a power of two.
template <typename Slots, typename Stop>
std::size_t probeSlots(const Slots& slots, std::uint64_t hash, Stop&& stop) {
  const std::size_t mask = slots.size() - 1;
  std::size_t slot = static_cast<std::size_t>(hash) & mask;
  while (!stop(slots[slot])) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

}  // namespace sightline::base
