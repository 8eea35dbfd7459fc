#pragma once

// Which parts of a tree hold something of a set of objects. Marking another set costs what is in the sets,
// not what is in the tree.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/base/ids.h"
#include "src/base/rows.h"

namespace sightline::culling {

// Objects in two forms.
struct ObjectSet {
  std::span<const std::uint8_t> marks;  // by object, not 0: in the set; empty: all objects are
  std::span<const ObjectId> list;       // those with a mark, each once

  bool everything() const { return marks.empty(); }
  bool has(ObjectId object) const { return everything() || marks[object.value] != 0; }
};

class TreeMarks {
 public:
  static constexpr std::uint32_t kTop = 0xffffffffu;

  // An item of the tree that names an object.
  struct Place {
    ObjectId object;
    std::uint32_t item;
  };

  // parents: by item; kTop for those that have none. places: any number an object.
  TreeMarks(std::vector<std::uint32_t> parents, std::span<const Place> places, std::size_t object_count)
      : parents_(std::move(parents)), marks_(parents_.size(), 0) {
    items_of_.group(object_count, [&](auto&& body) {
      for (const Place& place : places) {
        body(place.object.value, place.item);
      }
    });
    marked_.reserve(parents_.size());
  }

  // All items at or above these objects; the marks of the call before are gone.
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

  // By item: all bits set where it is marked, else 0.
  std::span<const std::uint8_t> marks() const { return marks_; }

 private:
  static constexpr std::uint8_t kMarked = 0xff;

  std::vector<std::uint32_t> parents_;
  base::Rows<std::uint32_t> items_of_;  // by object
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint32_t> marked_;
};

}  // namespace sightline::culling
