#pragma once

// The octree during the bake: dividing cells, merging siblings, and encoding cells as bytes.

#include <optional>
#include <span>
#include <vector>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/cell_sets.h"

namespace sightline::pvs {

struct BakedCell {
  std::vector<BakedCell> children;  // eight; none in a leaf
  // Leaves only.
  CellSets sets;
  ViewerBounds viewers;  // for which the sets hold
  StopReason reason = StopReason::kBudgetMet;
  std::uint8_t level = 0;

  bool leaf() const { return children.empty(); }
};

// A cell to be decided, and what is known of its parent.
struct CellTask {
  OctreeCell cell;
  double search_distance = 0.0;  // metres
  Runs seen{};                   // from anywhere in the parent; empty: not known
};

// The result for a cell: a leaf, or what is handed to its children.
struct CellOutcome {
  std::optional<BakedCell> leaf{};  // nothing if the cell is divided
  double search_distance = 0.0;
  Runs seen{};             // from anywhere in the cell
  std::uint64_t work = 0;  // what deciding the cell took; see CellBaker::work
};
// Decides the cell by the four cases of the paper, section 3.2.
CellOutcome decide(CellBaker& baker, const BakeScene& scene, const CellTask& task);

// The decided cell with everything below it, merged.
BakedCell bakeBelow(CellBaker& baker, const BakeScene& scene, const OctreeCell& place, CellOutcome&& outcome);

// The leaf that eight children become together: with the union of their sets, for the viewers of all of them
// and for nobody else. Nothing if they are not all leaves, if they have different planes, or if the box
// around their viewers holds more than these.
std::optional<BakedCell> joined(const BakeScene& scene, std::span<const BakedCell> children);

// A leaf in place of the children that holds all objects, with the least box around their viewers.
BakedCell allObjectsIn(const BakeScene& scene, std::span<const BakedCell> children);

// Turns a cell whose children are leaves with similar sets into the leaf that they become together.
void mergeChildren(const BakeScene& scene, BakedCell& cell);

void write(const BakedCell& cell, base::ByteWriter& bytes);
// Returns nothing if the bytes are not a cell of this level of the scene.
std::optional<BakedCell> readCell(base::ByteReader& bytes, std::uint32_t level, const BakeScene& scene);

}  // namespace sightline::pvs
