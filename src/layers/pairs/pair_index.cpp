#include "src/layers/pairs/pair_index.h"

#include <algorithm>

#include "src/base/hash_slots.h"

namespace sightline::layers {
namespace {

constexpr std::size_t kMinSlots = 64;

std::uint64_t hashOf(const PairKey& key) {
  const std::uint64_t pair = (static_cast<std::uint64_t>(key.a) << 32) | key.b;
  return base::mixBits(pair + 0x9e3779b97f4a7c15ull * (key.kind + 1ull));
}

}  // namespace

std::size_t PairIndex::slotOf(const PairKey& key) const {
  return base::probeSlots(slots_, hashOf(key),
                          [&](std::uint32_t number) { return number == kNone || keys_[number] == key; });
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

void PairIndex::fillSlots() {
  std::fill(slots_.begin(), slots_.end(), kNone);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    slots_[slotOf(keys_[i])] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace sightline::layers
