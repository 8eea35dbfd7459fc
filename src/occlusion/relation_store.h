#pragma once

// Relations that are kept from frame to frame, under a budget of memory; the least recently used go first.

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "occlusion/relation.h"

namespace sightline::occlusion_detail {

// Relations hang on items (numbers from 0), each item's in ascending order of occluders. They are stored in
// blocks of one size: a relation of more than four edges takes several.
class RelationStore {
 public:
  using Item = SupportingPlanes::Item;
  using Index = std::uint32_t;
  static constexpr Index kNone = 0xffffffffu;

  explicit RelationStore(std::size_t max_bytes);

  // Walks along the relations of an item.
  class Cursor {
   public:
    // The relation with this occluder, or kNone. Occluders must be asked for in ascending order. Relations
    // passed over that have not been used for a while are dropped.
    Index find(OccluderId occluder);

   private:
    friend class RelationStore;
    Cursor(RelationStore& store, Index* link) : store_(&store), link_(link) {}
    RelationStore* store_;
    Index* link_;  // to the next relation; null: none
  };
  // Valid until the next keep() or forget().
  Cursor relationsOf(Item item) { return {*this, item < items_.size() ? &items_[item] : nullptr}; }

  Relation& operator[](Index r) { return block(r).relation; }
  // Its planes, in planes that hold as many quads as Relation::quads(): of up to four edges without a copy.
  std::span<const PlaneQuad> planes(Index r, std::vector<PlaneQuad>& scratch) const;

  // Counts as used now.
  void use(Index r);
  // Keeps relations of the item, ascending by occluder, in place of older ones with these occluders. Others
  // may have to go. planes: Relation::quads() each. Those that are larger than the budget are not kept.
  void keep(Item item, std::span<const Relation> relations, std::span<const PlaneQuad> planes);
  void beginFrame() { ++frame_; }
  // Drops all relations of the item. Returns how many.
  std::uint32_t forget(Item item);
  void clear();

  std::uint32_t size() const { return size_; }                        // relations
  std::size_t bytes() const;                                          // of blocks and items
  std::uint32_t takeEvicted() { return std::exchange(evicted_, 0); }  // since the last call

 private:
  static constexpr std::uint32_t kStale = 64;    // frames without use, of an item that is used
  static constexpr std::uint32_t kSlabBits = 8;  // blocks are allocated 256 at a time
  static constexpr std::uint32_t kSlabMask = (1u << kSlabBits) - 1;

  struct Block {
    Relation relation;
    Item item = 0;
    std::uint32_t used_at = 0;  // frame
    Index next = kNone;         // relation of the item; free block
    Index older = kNone, newer = kNone;
    Index more = kNone;  // block with further planes
    PlaneQuad planes;
  };
  Block& block(Index i) { return slabs_[i >> kSlabBits][i & kSlabMask]; }
  const Block& block(Index i) const { return slabs_[i >> kSlabBits][i & kSlabMask]; }
  bool makeRoom(std::size_t blocks);
  Index takeBlock();
  void release(Index r);  // its blocks, once it is unlinked from its item
  void unlinkFromItem(Index r);
  void linkAsNewest(Index r);
  void unlinkFromAge(Index r);

  std::vector<std::unique_ptr<Block[]>> slabs_;
  std::vector<Index> items_;                        // first relation of each item
  std::uint32_t max_blocks_ = 0, used_blocks_ = 0;  // used: ever taken
  std::uint32_t free_blocks_ = 0;
  std::uint32_t size_ = 0, evicted_ = 0;
  std::uint32_t frame_ = 0;
  Index free_ = kNone, oldest_ = kNone, newest_ = kNone;
};

}  // namespace sightline::occlusion_detail
