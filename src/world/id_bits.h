#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/world/world.h"

namespace sightline::world {

// A set of instances: i is bit i % 64 of word i / 64.
class IdBits {
 public:
  // Empties the set. bound: all ids are below this.
  void clear(std::size_t bound) { words_.assign((bound + 63) / 64, 0); }
  void insert(std::uint32_t id) { words_[id / 64] |= std::uint64_t{1} << (id % 64); }
  void remove(std::uint32_t id) {
    if (id / 64 < words_.size()) {
      words_[id / 64] &= ~(std::uint64_t{1} << (id % 64));
    }
  }
  bool has(std::uint32_t id) const {
    return id / 64 < words_.size() && (words_[id / 64] >> (id % 64) & 1) != 0;
  }
  // others: with the same bound.
  void add(const IdBits& others) {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      words_[word] |= others.words_[word];
    }
  }
  template <typename Predicate>
  void removeIf(const Predicate& predicate) {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      for (std::uint64_t rest = words_[word]; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(rest));
        if (predicate(static_cast<std::uint32_t>(word * 64) + bit)) {
          words_[word] &= ~(std::uint64_t{1} << bit);
        }
      }
    }
  }
  // Appends those that are not in the other set, ascending.
  void listWithout(const IdBits& others, std::vector<InstanceId>& list) const {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      const std::uint64_t other = word < others.words_.size() ? others.words_[word] : 0;
      for (std::uint64_t rest = words_[word] & ~other; rest != 0; rest &= rest - 1) {
        list.emplace_back(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
      }
    }
  }
  void list(std::vector<InstanceId>& list) const { listWithout(IdBits(), list); }
  std::span<const std::uint64_t> words() const { return words_; }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace sightline::world
