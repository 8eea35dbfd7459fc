#pragma once

// A hash table that numbers pairs from 0 in the order of add(), with open addressing and linear probing.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightline::layers {

struct PairKey {
  std::uint32_t a = 0, b = 0;
  std::uint32_t kind = 0;

  friend bool operator==(const PairKey&, const PairKey&) = default;
};

class PairIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::size_t size() const { return keys_.size(); }
  const PairKey& key(std::uint32_t number) const { return keys_[number]; }
  // Returns the number of a key, or kNone.
  std::uint32_t find(const PairKey& key) const { return slots_.empty() ? kNone : slots_[slotOf(key)]; }
  // Adds a key that is not in the table; its number is the size before.
  void add(const PairKey& key);
  // Removes the keys with keep[number] == 0 and renumbers the others in order. keep: one per key.
  void keepOnly(const std::vector<std::uint8_t>& keep);

 private:
  // Returns the slot of the key, or the free slot where it belongs.
  std::size_t slotOf(const PairKey& key) const;
  void fillSlots();

  std::vector<PairKey> keys_;
  std::vector<std::uint32_t> slots_;  // numbers or kNone; the size is a power of two, at least twice the keys
};

}  // namespace sightline::layers
