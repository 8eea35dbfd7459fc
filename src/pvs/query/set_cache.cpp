#include "src/pvs/query/set_cache.h"

#include <algorithm>

namespace sightline::pvs {
namespace {

std::size_t storageOf(const std::vector<std::uint32_t>& nodes) {
  return nodes.capacity() * sizeof(std::uint32_t);
}

}  // namespace

SetCache::SetCache(std::uint32_t set_count, std::size_t budget_bytes)
    : slot_of_(set_count, kNoSlot), budget_(budget_bytes) {}

SetCache::State SetCache::state(std::uint32_t set) const {
  const std::uint32_t slot = slot_of_[set];
  return slot == kNoSlot ? State::kMissing : slot == kBrokenSet ? State::kBroken : State::kCached;
}

std::span<const std::uint32_t> SetCache::use(std::uint32_t set) {
  const std::uint32_t slot = slot_of_[set];
  if (slot != newest_) {
    unlink(slot);
    linkAsNewest(slot);
  }
  return slots_[slot].nodes;
}

std::span<const std::uint32_t> SetCache::insert(std::uint32_t set, std::span<const std::uint32_t> nodes) {
  const std::uint32_t slot = freeSlot(nodes.size_bytes());
  slots_[slot].set = set;
  setNodes(slots_[slot], nodes);
  slot_of_[set] = slot;
  linkAsNewest(slot);
  return slots_[slot].nodes;
}

void SetCache::unlink(std::uint32_t slot) {
  const Slot& out = slots_[slot];
  (out.newer == kNoSlot ? newest_ : slots_[out.newer].older) = out.older;
  (out.older == kNoSlot ? oldest_ : slots_[out.older].newer) = out.newer;
}

void SetCache::linkAsNewest(std::uint32_t slot) {
  slots_[slot].newer = kNoSlot;
  slots_[slot].older = newest_;
  (newest_ == kNoSlot ? oldest_ : slots_[newest_].newer) = slot;
  newest_ = slot;
}

// Reuses the slot's storage unless much of it would be unused.
void SetCache::setNodes(Slot& slot, std::span<const std::uint32_t> nodes) {
  bytes_ -= storageOf(slot.nodes);
  const std::size_t max_capacity = nodes.size() + nodes.size() / 4 + 16;
  if (slot.nodes.capacity() < nodes.size() || slot.nodes.capacity() > max_capacity) {
    std::vector<std::uint32_t>().swap(slot.nodes);
  }
  slot.nodes.assign(nodes.begin(), nodes.end());
  bytes_ += storageOf(slot.nodes);
}

// Returns a slot for this many bytes, evicting the least recently used sets to make room.
std::uint32_t SetCache::freeSlot(std::size_t bytes) {
  while (oldest_ != kNoSlot && bytes_ + bytes > budget_) {
    const std::uint32_t slot = oldest_;
    unlink(slot);
    slot_of_[slots_[slot].set] = kNoSlot;
    if (bytes_ - storageOf(slots_[slot].nodes) + bytes <= budget_) {
      return slot;  // keeps its storage
    }
    bytes_ -= storageOf(slots_[slot].nodes);
    std::vector<std::uint32_t>().swap(slots_[slot].nodes);
    free_.push_back(slot);
  }
  if (free_.empty()) {
    slots_.emplace_back();
    return static_cast<std::uint32_t>(slots_.size() - 1);
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  return slot;
}

}  // namespace sightline::pvs
