#pragma once

// Sets of objects as runs of BoxTree::objects: ascending, neither empty nor touching each other. Objects that
// are near each other in space are near each other there, so that sets are few runs.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"

namespace sightline::pvs {

// A range of BoxTree::objects, [begin, end).
struct ObjectRun {
  std::uint32_t begin = 0, end = 0;

  friend bool operator==(const ObjectRun&, const ObjectRun&) = default;
};
using Runs = std::vector<ObjectRun>;

// out: what is in both. out is neither a nor b.
void intersect(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out);
// out: what is in either. out is neither a nor b.
void unite(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out);

// Appends the nodes whose objects are all in the set and whose parents' are not: ascending.
void appendNodes(const BoxTreeView& tree, std::span<const ObjectRun> runs, std::vector<std::uint32_t>& nodes);

// How many triangles a set has.
class TriangleCounts {
 public:
  explicit TriangleCounts(const BoxTreeView& tree);
  std::uint64_t of(std::span<const ObjectRun> runs) const {
    std::uint64_t sum = 0;
    for (const ObjectRun& run : runs) {
      sum += before_[run.end] - before_[run.begin];
    }
    return sum;
  }

 private:
  std::vector<std::uint64_t> before_;  // by position: triangles of all objects before it
};

}  // namespace sightline::pvs
