#pragma once

// A set of objects with one bit per object, to unite many runs fast.

#include <cstdint>
#include <span>
#include <vector>

#include "src/pvs/bake/runs.h"

namespace sightline::pvs {

class ObjectMask {
 public:
  // Resizes to `count` objects, none of them set.
  void reset(std::uint32_t count);
  // Resizes to `count` objects, all set except those of the runs.
  void resetWithout(std::span<const ObjectRun> runs, std::uint32_t count);
  void add(std::span<const ObjectRun> runs);
  // others: must have as many objects.
  void remove(const ObjectMask& others);
  bool contains(std::uint32_t position) const { return (words_[position / 64] >> position % 64 & 1) != 0; }
  bool containsAll(const ObjectRun& run) const;
  // out: the objects that are not set.
  void complement(Runs& out) const;

 private:
  void addRun(const ObjectRun& run);

  std::uint32_t count_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace sightline::pvs
