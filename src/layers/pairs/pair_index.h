#pragma once

// Numbers for pairs, counted from 0 in the order in which they were added: open addressing, linear probing.

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
  // kNone: not there.
  std::uint32_t find(const PairKey& key) const { return slots_.empty() ? kNone : slots_[slotOf(key)]; }
  // key: not there yet. Its number is the size before.
  void add(const PairKey& key);
  // Keeps the keys with keep[number] != 0, which move up in their order. keep: one a key.
  void keepOnly(const std::vector<std::uint8_t>& keep);
  void clear();

 private:
  // The slot that holds the key, or the free one where it belongs.
  std::size_t slotOf(const PairKey& key) const;
  void fillSlots();

  std::vector<PairKey> keys_;
  std::vector<std::uint32_t> slots_;  // numbers or kNone; a power of two, at least twice the keys
};

}  // namespace sightline::layers
