#pragma once

// Relations that are kept from frame to frame, under a budget of memory; the least recently used go first.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "src/comparison/occlusion/relation.h"

namespace sightline::comparison {

// A hash table of (item, occluder), items being numbers from 0. Room is made between frames, for a quarter of
// the budget at once, by the frame of last use. What finds no room within a frame is not kept.
class RelationStore {
 public:
  using Item = KeptPlanes::Item;
  using Index = std::uint32_t;
  static constexpr Index kNone = 0xffffffffu;

  explicit RelationStore(std::size_t max_bytes);

  // Makes room when there is little, and starts the count of evicted relations.
  void beginFrame();

  // Finds a relation and counts that as its use. The index is valid until the next keep(), forget() or
  // beginFrame().
  Index find(Item item, OccluderId occluder);
  Relation& operator[](Index r) { return entries_[r].relation; }
  // Returns the relation's planes, Relation::quads() of them; they are copied to scratch when there are
  // several.
  std::span<const PlaneQuad> planes(Index r, std::vector<PlaneQuad>& scratch) const;

  // Keeps a relation of the item, in place of an older one with the same occluder.
  void keep(Item item, const Relation& relation, std::span<const PlaneQuad> planes);
  // Drops all relations of the item. Returns how many.
  std::uint32_t forget(Item item);
  void clear();

  std::uint32_t size() const { return used_; }  // relations
  std::size_t bytes() const;                    // of relations, table and items
  // Relations that were dropped, or not kept, for want of room since beginFrame().
  std::uint32_t evicted() const { return evicted_; }

 private:
  struct Entry {
    Relation relation;
    Item item = 0;
    std::uint32_t used_at = 0;  // frame
    Index quad = kNone;         // its first quad; kNone: the entry is free
    Index next = kNone;         // the next of the item, or of the free entries
  };
  struct Quad {
    PlaneQuad planes;
    Index next = kNone;  // the next of the relation, or of the free quads
  };
  static constexpr std::uint32_t kSlabBits = 8;  // quads are allocated 256 at a time

  Quad& quad(Index i) { return slabs_[i >> kSlabBits][i & ((1u << kSlabBits) - 1)]; }
  const Quad& quad(Index i) const { return slabs_[i >> kSlabBits][i & ((1u << kSlabBits) - 1)]; }
  // Returns the entry's slot, or the free slot where it belongs.
  std::size_t slotOf(Item item, OccluderId occluder) const;
  void insertSlot(Index r);
  void eraseSlot(Index r);
  Index takeEntry();
  Index takeQuad();
  void free(Index r);  // no slot and no item may name it
  void rebuildTable(std::size_t slots);
  void makeRoom();

  std::vector<Entry> entries_;
  std::vector<std::unique_ptr<Quad[]>> slabs_;
  std::vector<Index> slots_;  // open addressing, a power of two, at most half full
  std::vector<Index> items_;  // by item: its first relation
  std::uint32_t max_ = 0;     // the largest number of relations, and of quads
  std::uint32_t used_ = 0, quads_ = 0, quads_used_ = 0;
  Index free_entry_ = kNone, free_quad_ = kNone;
  std::uint32_t frame_ = 0, next_sweep_ = 0, evicted_ = 0;
};

}  // namespace sightline::comparison
