#pragma once

// Marks the items of a tree that contain an object of a set. Marking another set takes time in proportion to
// the sizes of the two sets, not to the size of the tree.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/base/ids.h"
#include "src/base/rows.h"

namespace sightline::culling {

// A set of objects, as marks and as a list.
struct ObjectSet {
  std::span<const std::uint8_t> marks;  // by object: not 0 if it is in the set; empty: all objects are
  std::span<const ObjectId> list;       // the objects of the set, each once; empty if all objects are in it

  bool everything() const { return marks.empty(); }
  bool has(ObjectId object) const { return everything() || marks[object.value] != 0; }
};

class TreeMarks {
 public:
  static constexpr std::uint32_t kTop = 0xffffffffu;

  // An object and an item of the tree that names it.
  struct Place {
    ObjectId object;
    std::uint32_t item;
  };

  // parents: one element per item, kTop for items without a parent. places: any number per object.
  TreeMarks(std::vector<std::uint32_t> parents, std::span<const Place> places, std::size_t object_count)
      : parents_(std::move(parents)), marks_(parents_.size(), 0) {
    items_of_.group(object_count, [&](auto&& body) {
      for (const Place& place : places) {
        body(place.object.value, place.item);
      }
    });
    marked_.reserve(parents_.size());
  }

  // Marks all items that name these objects, and the items above them. Removes the marks of the last call.
  void mark(std::span<const ObjectId> objects) {
    for (const std::uint32_t item : marked_) {
      marks_[item] = 0;
    }
    marked_.clear();
    for (const ObjectId object : objects) {
      for (std::uint32_t item : items_of_[object.value]) {
        for (; item != kTop && marks_[item] == 0; item = parents_[item]) {
          marks_[item] = kMarked;
          marked_.push_back(item);
        }
      }
    }
  }

  // One element per item: 0xff if the item is marked, else 0.
  std::span<const std::uint8_t> marks() const { return marks_; }

 private:
  static constexpr std::uint8_t kMarked = 0xff;

  std::vector<std::uint32_t> parents_;
  base::Rows<std::uint32_t> items_of_;  // by object
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint32_t> marked_;  // items
};

}  // namespace sightline::culling
