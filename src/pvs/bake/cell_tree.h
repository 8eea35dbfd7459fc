#pragma once

// The octree while it is made: cells divided until they need not be, siblings merged, and all of it as bytes.

#include <optional>
#include <vector>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/cell_sets.h"

namespace sightline::pvs {

struct BakedCell {
  std::vector<BakedCell> children;  // eight, or none: a leaf
  // Of a leaf.
  CellSets sets;
  StopReason reason = StopReason::kBudgetMet;
  std::uint8_t level = 0;

  bool leaf() const { return children.empty(); }
};

// A cell to be looked at, and how far occluders were looked for above it.
struct CellTask {
  OctreeCell cell;
  double search_distance = 0.0;  // metres
};

// What became of it: a leaf, or the search distance for its children.
struct CellOutcome {
  bool divide = false;
  double search_distance = 0.0;
  BakedCell leaf;
};
// The four cases of the paper, section 3.2.
CellOutcome decide(CellBaker& baker, const BakeScene& scene, const CellTask& task);

// All below the task's cell, merged.
BakedCell bakeCell(CellBaker& baker, const BakeScene& scene, const CellTask& task);

// Makes a cell whose children are leaves with like sets a leaf.
void mergeChildren(const BakeScene& scene, BakedCell& cell);

void write(const BakedCell& cell, base::ByteWriter& bytes);
// Nothing: the bytes are not of a cell of this level within a tree of so many objects.
std::optional<BakedCell> readCell(base::ByteReader& bytes, std::uint32_t level, std::uint32_t object_count);

}  // namespace sightline::pvs
