#include "occlusion/relation_store.h"

#include <algorithm>
#include <utility>

namespace sightline::occlusion_detail {

RelationStore::RelationStore(std::size_t max_bytes)
    : max_blocks_(static_cast<std::uint32_t>(std::min<std::size_t>(max_bytes / sizeof(Block), kNone - 1))) {}

std::span<const PlaneQuad> RelationStore::planes(Index r, std::vector<PlaneQuad>& scratch) const {
  const Block* b = &block(r);
  if (b->more == kNone) {
    return {&b->planes, 1};
  }
  scratch.clear();
  for (;; b = &block(b->more)) {
    scratch.push_back(b->planes);
    if (b->more == kNone) {
      return scratch;
    }
  }
}

void RelationStore::unlinkFromAge(Index r) {
  const Block& b = block(r);
  (b.older == kNone ? oldest_ : block(b.older).newer) = b.newer;
  (b.newer == kNone ? newest_ : block(b.newer).older) = b.older;
}

void RelationStore::linkAsNewest(Index r) {
  Block& b = block(r);
  b.older = newest_;
  b.newer = kNone;
  (newest_ == kNone ? oldest_ : block(newest_).newer) = r;
  newest_ = r;
}

void RelationStore::use(Index r) {
  block(r).used_at = frame_;
  if (r != newest_) {
    unlinkFromAge(r);
    linkAsNewest(r);
  }
}

RelationStore::Index RelationStore::Cursor::find(OccluderId occluder) {
  if (link_ == nullptr) {
    return kNone;
  }
  while (*link_ != kNone) {
    const Index r = *link_;
    Block& b = store_->block(r);
    if (b.relation.occluder >= occluder) {
      return b.relation.occluder == occluder ? r : kNone;
    }
    if (store_->frame_ - b.used_at > kStale) {
      *link_ = b.next;
      store_->release(r);
    } else {
      link_ = &b.next;
    }
  }
  return kNone;
}

void RelationStore::unlinkFromItem(Index r) {
  Index* link = &items_[block(r).item];
  while (*link != r) {
    link = &block(*link).next;
  }
  *link = block(r).next;
}

void RelationStore::release(Index r) {
  unlinkFromAge(r);
  for (Index i = r; i != kNone; ++free_blocks_) {
    Block& b = block(i);
    b.next = free_;
    free_ = i;
    i = std::exchange(b.more, kNone);
  }
  --size_;
}

// Whether so many blocks can be taken, for which the least recently used relations go.
bool RelationStore::makeRoom(std::size_t blocks) {
  if (blocks > max_blocks_) {
    return false;
  }
  while (free_blocks_ + (max_blocks_ - used_blocks_) < blocks) {
    const Index r = oldest_;
    unlinkFromItem(r);
    release(r);
    ++evicted_;
  }
  return true;
}

RelationStore::Index RelationStore::takeBlock() {
  if (free_ != kNone) {
    --free_blocks_;
    return std::exchange(free_, block(free_).next);
  }
  if ((used_blocks_ & kSlabMask) == 0) {
    const std::uint32_t count = std::min(max_blocks_ - used_blocks_, kSlabMask + 1);
    slabs_.push_back(std::make_unique<Block[]>(count));
  }
  return used_blocks_++;
}

void RelationStore::keep(Item item, std::span<const Relation> relations, std::span<const PlaneQuad> planes) {
  if (item >= items_.size()) {
    items_.resize(std::max<std::size_t>(item + std::size_t{1}, items_.size() * 2), kNone);
  }
  Index* link = &items_[item];
  for (const Relation& relation : relations) {
    const std::span<const PlaneQuad> own = planes.first(relation.quads());
    planes = planes.subspan(own.size());
    const std::uint32_t evicted_before = evicted_;
    if (!makeRoom(own.size())) {
      continue;
    }
    if (evicted_ != evicted_before) {
      link = &items_[item];  // what it pointed into may be gone
    }
    while (*link != kNone && block(*link).relation.occluder < relation.occluder) {
      link = &block(*link).next;
    }
    if (*link != kNone && block(*link).relation.occluder == relation.occluder) {
      const Index old = *link;
      *link = block(old).next;
      release(old);
    }
    Index head = kNone;
    for (std::size_t i = own.size(); i-- > 0;) {
      const Index taken = takeBlock();
      block(taken).planes = own[i];
      block(taken).more = std::exchange(head, taken);
    }
    Block& b = block(head);
    b.relation = relation;
    b.item = item;
    b.used_at = frame_;
    b.next = std::exchange(*link, head);
    linkAsNewest(head);
    ++size_;
  }
}

std::uint32_t RelationStore::forget(Item item) {
  std::uint32_t count = 0;
  if (item < items_.size()) {
    for (Index r = std::exchange(items_[item], kNone); r != kNone; ++count) {
      const Index next = block(r).next;
      release(r);
      r = next;
    }
  }
  return count;
}

void RelationStore::clear() {
  items_.assign(items_.size(), kNone);
  for (Index i = 0; i < used_blocks_; ++i) {
    block(i).more = kNone;
    block(i).next = i + 1 < used_blocks_ ? i + 1 : kNone;
  }
  free_ = used_blocks_ > 0 ? 0 : kNone;
  free_blocks_ = used_blocks_;
  oldest_ = newest_ = kNone;
  size_ = 0;
}

std::size_t RelationStore::bytes() const {
  const std::size_t slots = std::min<std::size_t>(slabs_.size() << kSlabBits, max_blocks_);
  return slots * sizeof(Block) + items_.capacity() * sizeof(Index);
}

}  // namespace sightline::occlusion_detail
