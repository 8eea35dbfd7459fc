#pragma once

// From cells to the layout of the file.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sightline/pvs/format/baked_visibility.h"
#include "src/base/hash_slots.h"
#include "src/pvs/bake/cell_tree.h"
#include "src/pvs/bake/file/set_store.h"

namespace sightline::pvs {

// Finds keys by their hashes. A key is a number, given to it in the order in which keys are added.
class HashIndex {
 public:
  // The key with this hash for which same(key) is true; if there is none, the next number, which is added.
  template <typename Same>
  std::uint32_t findOrAdd(std::uint64_t hash, Same&& same) {
    if (2 * hashes_.size() >= slots_.size()) {
      grow();
    }
    const std::size_t slot = base::probeSlots(slots_, base::mixBits(hash), [&](std::uint32_t key) {
      return key == 0 || (hashes_[key - 1] == hash && same(key - 1));
    });
    if (slots_[slot] == 0) {
      hashes_.push_back(hash);
      slots_[slot] = static_cast<std::uint32_t>(hashes_.size());
    }
    return slots_[slot] - 1;
  }

 private:
  void grow();

  std::vector<std::uint64_t> hashes_;                                    // by key
  std::vector<std::uint32_t> slots_{std::vector<std::uint32_t>(16, 0)};  // a key plus one; 0: free
};

// Converts cells to nodes and leaves in one order, with equal sets and planes once. Doors are added to every
// set but empty ones, for an open door may be anywhere.
class Flattener {
 public:
  // octree and doors must be empty, except for the octree's box, and outlive this object.
  Flattener(const BakeScene& scene, VisibilityOctree& octree, BakedDoors& doors, SetStore& sets);

  // Writes the cell with all below it to a node that exists. That of the root, number 0, exists from the
  // beginning.
  void add(const BakedCell& cell, std::uint32_t node);
  // Makes the node one with eight children, and returns the first of them.
  std::uint32_t divide(std::uint32_t node);
  void finish();  // when all cells are added

 private:
  void addLeaf(const BakedCell& cell);
  std::uint32_t setOf(const Runs& seen, const DoorRuns& doors);
  std::uint32_t numberOf(const Runs& runs, std::span<const DoorSet> hidden);
  std::uint32_t planeOf(const CellPlane& plane);

  const BakeScene& scene_;
  VisibilityOctree& octree_;
  BakedDoors& doors_;
  SetStore& sets_;
  HashIndex index_;  // of the sets
  std::map<std::array<double, 5>, std::uint32_t> planes_;
  std::vector<std::uint32_t> nodes_;
  std::vector<DoorSet> hidden_;
};

// Converts cells that are in memory, with their sets.
void flatten(const BakedCell& root, const BakeScene& scene, BakedVisibility& baked);

}  // namespace sightline::pvs
