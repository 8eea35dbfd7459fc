#pragma once

// Which parts of a tree hold something of a set of objects. Marking another set costs what is in the sets,
// not what is in the tree.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/base/ids.h"

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
      : parents_(std::move(parents)),
        first_(object_count + 1, 0),
        items_(places.size()),
        marks_(parents_.size(), 0) {
    for (const Place& place : places) {
      ++first_[place.object.value + 1];
    }
    for (std::size_t o = 1; o < first_.size(); ++o) {
      first_[o] += first_[o - 1];
    }
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const Place& place : places) {
      items_[next[place.object.value]++] = place.item;
    }
    marked_.reserve(parents_.size());
  }

  // All items at or above these objects; the marks of the call before are gone.
  void mark(std::span<const ObjectId> objects) {
    for (const std::uint32_t item : marked_) {
      marks_[item] = 0;
    }
    marked_.clear();
    for (const ObjectId object : objects) {
      for (std::uint32_t i = first_[object.value]; i < first_[object.value + 1]; ++i) {
        for (std::uint32_t item = items_[i]; item != kTop && marks_[item] == 0; item = parents_[item]) {
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
  std::vector<std::uint32_t> first_,
      items_;  // of an object: items_[first_[o]] to before items_[first_[o + 1]]
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint32_t> marked_;
};

}  // namespace sightline::culling
