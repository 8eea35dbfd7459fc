#pragma once

// Sets of objects as runs of BoxTree::objects: ascending, not empty, and not touching each other. Objects
// that are close in space are close in that order, so a set has few runs.

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

// Adds a run that begins where the last one ends, or after it.
inline void appendRun(const ObjectRun& run, Runs& runs) {
  if (!runs.empty() && runs.back().end == run.begin) {
    runs.back().end = run.end;
  } else {
    runs.push_back(run);
  }
}

// The number of objects in the runs.
inline std::uint64_t countOf(std::span<const ObjectRun> runs) {
  std::uint64_t count = 0;
  for (const ObjectRun& run : runs) {
    count += run.end - run.begin;
  }
  return count;
}

// out: the intersection. It must not alias a or b.
void intersect(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out);
// out: the union. It must not alias a or b.
void unite(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out);
// out: what of a is not in b. It must not alias a or b.
void subtract(std::span<const ObjectRun> a, std::span<const ObjectRun> b, Runs& out);

// Appends, in ascending order, the nodes whose objects are all in the set while their parent's are not.
void appendNodes(const BoxTreeView& tree, std::span<const ObjectRun> runs, std::vector<std::uint32_t>& nodes);

// Counts the triangles of a set.
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
  std::uint64_t all() const { return before_.back(); }

 private:
  std::vector<std::uint64_t> before_;  // triangles of all objects before a position
};

}  // namespace sightline::pvs
