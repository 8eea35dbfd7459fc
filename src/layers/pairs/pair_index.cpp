#include "src/layers/pairs/pair_index.h"

#include <algorithm>

namespace sightline::layers {
namespace {

constexpr std::size_t kMinSlots = 64;

// Steele, Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014: SplitMix64's finish.
std::uint64_t hashOf(const PairKey& key) {
  std::uint64_t z = (static_cast<std::uint64_t>(key.a) << 32) | key.b;
  z += 0x9e3779b97f4a7c15ull * (key.kind + 1ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

}  // namespace

std::size_t PairIndex::slotOf(const PairKey& key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = static_cast<std::size_t>(hashOf(key)) & mask;
  while (slots_[slot] != kNone && keys_[slots_[slot]] != key) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

void PairIndex::add(const PairKey& key) {
  const auto number = static_cast<std::uint32_t>(keys_.size());
  keys_.push_back(key);
  if (2 * keys_.size() > slots_.size()) {
    slots_.resize(std::max(kMinSlots, 2 * slots_.size()));
    fillSlots();
  } else {
    slots_[slotOf(key)] = number;
  }
}

void PairIndex::keepOnly(const std::vector<std::uint8_t>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (keep[i] != 0) {
      keys_[kept++] = keys_[i];
    }
  }
  if (kept < keys_.size()) {
    keys_.resize(kept);
    fillSlots();
  }
}

void PairIndex::clear() {
  keys_.clear();
  fillSlots();
}

void PairIndex::fillSlots() {
  std::fill(slots_.begin(), slots_.end(), kNone);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    slots_[slotOf(keys_[i])] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace sightline::layers
