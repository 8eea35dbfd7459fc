#include "src/comparison/occlusion/relation_store.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "src/base/hash_slots.h"

namespace sightline::comparison {

RelationStore::RelationStore(std::size_t max_bytes)
    : max_(static_cast<std::uint32_t>(
          std::min<std::size_t>(max_bytes / (sizeof(Entry) + sizeof(Quad) + 4 * sizeof(Index)), 1u << 28))) {}

std::size_t RelationStore::slotOf(Item item, OccluderId occluder) const {
  const std::uint64_t key = std::uint64_t{item} << 32 | occluder.value;
  // The upper bits of the product depend on all bits of the key.
  const std::uint64_t hash = (key * 0x9e3779b97f4a7c15u) >> (64 - std::countr_zero(slots_.size()));
  return base::probeSlots(slots_, hash, [&](Index r) {
    return r == kNone || (entries_[r].item == item && entries_[r].relation.occluder == occluder);
  });
}

RelationStore::Index RelationStore::find(Item item, OccluderId occluder) {
  if (slots_.empty()) {
    return kNone;
  }
  const Index r = slots_[slotOf(item, occluder)];
  if (r != kNone) {
    entries_[r].used_at = frame_;
  }
  return r;
}

std::span<const PlaneQuad> RelationStore::planes(Index r, std::vector<PlaneQuad>& scratch) const {
  const Entry& entry = entries_[r];
  if (entry.relation.quads() == 1) {
    return {&quad(entry.quad).planes, 1};
  }
  scratch.clear();
  for (Index q = entry.quad; q != kNone; q = quad(q).next) {
    scratch.push_back(quad(q).planes);
  }
  return scratch;
}

void RelationStore::insertSlot(Index r) {
  slots_[slotOf(entries_[r].item, entries_[r].relation.occluder)] = r;
}

// What follows in the same run of slots moves up, so that no run has a gap.
void RelationStore::eraseSlot(Index r) {
  std::size_t slot = slotOf(entries_[r].item, entries_[r].relation.occluder);
  slots_[slot] = kNone;
  for (slot = (slot + 1) & (slots_.size() - 1); slots_[slot] != kNone;
       slot = (slot + 1) & (slots_.size() - 1)) {
    insertSlot(std::exchange(slots_[slot], kNone));
  }
}

void RelationStore::rebuildTable(std::size_t slots) {
  slots_.assign(slots, kNone);
  for (Index r = 0; r < entries_.size(); ++r) {
    if (entries_[r].quad != kNone) {
      insertSlot(r);
    }
  }
}

RelationStore::Index RelationStore::takeEntry() {
  ++used_;
  if (free_entry_ != kNone) {
    return std::exchange(free_entry_, entries_[free_entry_].next);
  }
  if (entries_.size() == entries_.capacity()) {
    entries_.reserve(std::min<std::size_t>(max_, std::max<std::size_t>(256, entries_.size() * 2)));
  }
  entries_.emplace_back();
  if (slots_.size() < 2 * entries_.size()) {
    rebuildTable(slots_.empty() ? std::min<std::size_t>(512, std::bit_ceil(2u * max_)) : slots_.size() * 2);
  }
  return static_cast<Index>(entries_.size() - 1);
}

RelationStore::Index RelationStore::takeQuad() {
  ++quads_used_;
  if (free_quad_ != kNone) {
    return std::exchange(free_quad_, quad(free_quad_).next);
  }
  if ((quads_ & ((1u << kSlabBits) - 1)) == 0) {
    slabs_.push_back(std::make_unique<Quad[]>(std::min(max_ - quads_, 1u << kSlabBits)));
  }
  return quads_++;
}

void RelationStore::keep(Item item, const Relation& relation, std::span<const PlaneQuad> planes) {
  Index r = find(item, relation.occluder);
  if (r != kNone && entries_[r].relation.quads() != relation.quads()) {
    forget(item);  // of a set of occluders that is another one now
    r = kNone;
  }
  if (r != kNone) {
    entries_[r].relation = relation;
    Index q = entries_[r].quad;
    for (const PlaneQuad& own : planes) {
      quad(q).planes = own;
      q = quad(q).next;
    }
    return;
  }
  if (used_ == max_ || planes.size() > max_ - quads_used_) {
    ++evicted_;
    return;
  }
  if (item >= items_.size()) {
    items_.resize(std::max<std::size_t>(item + std::size_t{1}, items_.size() * 2), kNone);
  }
  r = takeEntry();
  Index first = kNone;
  for (std::size_t i = planes.size(); i-- > 0;) {
    const Index q = takeQuad();
    quad(q).planes = planes[i];
    quad(q).next = std::exchange(first, q);
  }
  entries_[r] = {relation, item, frame_, first, std::exchange(items_[item], r)};
  insertSlot(r);
}

void RelationStore::free(Index r) {
  for (Index q = std::exchange(entries_[r].quad, kNone); q != kNone; --quads_used_) {
    const Index next = std::exchange(quad(q).next, free_quad_);
    free_quad_ = q;
    q = next;
  }
  entries_[r].next = std::exchange(free_entry_, r);
  --used_;
}

std::uint32_t RelationStore::forget(Item item) {
  std::uint32_t count = 0;
  if (item < items_.size()) {
    for (Index r = std::exchange(items_[item], kNone); r != kNone; ++count) {
      const Index next = entries_[r].next;
      eraseSlot(r);
      free(r);
      r = next;
    }
  }
  return count;
}

void RelationStore::clear() {
  std::fill(items_.begin(), items_.end(), kNone);
  for (Index r = 0; r < entries_.size(); ++r) {
    if (entries_[r].quad != kNone) {
      free(r);
    }
  }
  std::fill(slots_.begin(), slots_.end(), kNone);
}

void RelationStore::beginFrame() {
  ++frame_;
  evicted_ = 0;
  const bool little = std::max(used_, quads_used_) + max_ / 8 >= max_;
  if (little && frame_ >= next_sweep_) {
    makeRoom();
  }
}

// The least recently used relations go, until a quarter of the budget is free; never those of the last frame,
// which are wanted again.
void RelationStore::makeRoom() {
  constexpr std::size_t kAges = 256;
  std::array<std::uint32_t, kAges> by_age{};
  const auto ageOf = [this](const Entry& entry) {
    return std::min<std::size_t>(frame_ - entry.used_at, kAges - 1);
  };
  for (const Entry& entry : entries_) {
    if (entry.quad != kNone) {
      ++by_age[ageOf(entry)];
    }
  }
  std::size_t oldest = kAges;
  for (std::uint32_t going = 0; oldest > 2 && going < std::max(1u, max_ / 4);) {
    going += by_age[--oldest];
  }
  std::fill(items_.begin(), items_.end(), kNone);
  const std::uint32_t before = used_;
  for (Index r = 0; r < entries_.size(); ++r) {
    Entry& entry = entries_[r];
    if (entry.quad == kNone) {
      continue;
    }
    if (ageOf(entry) >= oldest) {
      free(r);
    } else {
      entry.next = std::exchange(items_[entry.item], r);
    }
  }
  rebuildTable(slots_.size());
  evicted_ += before - used_;
  // Where there was little to find it is not worth looking again at once.
  next_sweep_ = frame_ + (before - used_ < max_ / 16 ? 16 : 1);
}

std::size_t RelationStore::bytes() const {
  const std::size_t quads = std::min<std::size_t>(slabs_.size() << kSlabBits, max_);
  return entries_.capacity() * sizeof(Entry) + quads * sizeof(Quad) + slots_.capacity() * sizeof(Index) +
         items_.capacity() * sizeof(Index);
}

}  // namespace sightline::comparison
