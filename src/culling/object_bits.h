#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "sightline/base/ids.h"

namespace sightline::culling {

// A set of objects with one bit per object, and a summary with one bit per 64 objects. Insertion takes
// constant time. Clearing and enumeration in ascending order take time in proportion to the objects in the
// set, apart from one word of the summary per 4096 possible objects.
class ObjectBits {
 public:
  explicit ObjectBits(std::size_t object_count)
      : words_((object_count + 63) / 64), summary_((words_.size() + 63) / 64) {}

  // Returns false if the object was already in the set.
  bool insert(ObjectId object) {
    const std::size_t word = object.value / 64;
    const std::uint64_t bit = std::uint64_t{1} << (object.value % 64);
    if ((words_[word] & bit) != 0) {
      return false;
    }
    words_[word] |= bit;
    summary_[word / 64] |= std::uint64_t{1} << (word % 64);
    return true;
  }

  // Appends the objects of the set in ascending order and empties the set.
  void drainInto(std::vector<ObjectId>& out) {
    forEachWord([&](std::size_t word) {
      for (std::uint64_t bits = words_[word]; bits != 0; bits &= bits - 1) {
        out.push_back(ObjectId(word * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
      }
      words_[word] = 0;
    });
  }

  void clear() {
    forEachWord([&](std::size_t word) { words_[word] = 0; });
  }

 private:
  // Visits the words that are not zero and clears the summary.
  template <typename Visit>
  void forEachWord(Visit visit) {
    for (std::size_t s = 0; s < summary_.size(); ++s) {
      for (std::uint64_t bits = summary_[s]; bits != 0; bits &= bits - 1) {
        visit(s * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      }
      summary_[s] = 0;
    }
  }

  std::vector<std::uint64_t> words_, summary_;
};

}  // namespace sightline::culling
