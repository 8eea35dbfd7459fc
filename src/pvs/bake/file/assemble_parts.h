#pragma once

// From the parts of a bake to its result. Parts are read one by one, in an order that lets each be forgotten
// before the next is read.

#include <cstdint>
#include <functional>
#include <optional>

#include "sightline/pvs/bake/bake.h"
#include "src/pvs/bake/cell_tree.h"
#include "src/pvs/bake/file/flatten.h"
#include "src/pvs/bake/file/part_code.h"

namespace sightline::pvs {

// A part: its cell with all below it, or that it was divided into eight parts.
struct PartCell {
  std::optional<BakedCell> cell;  // nothing: divided
};
// Reads a part; nothing if it is missing, corrupt or of another plan.
using ReadCell = std::function<std::optional<PartCell>(std::uint64_t id)>;

// The root with all below it, merged where they touch. Nothing if a part cannot be read; `broken` is then its
// id.
std::optional<BakedCell> cellOfParts(const BakeScene& scene, const ReadCell& read, std::uint64_t& broken);

// Gives the same cells to the flattener, each as soon as it is clear that it stays as it is. At most one part
// and eight leaves a level are in memory. Returns the id of a part that cannot be read, or 0.
std::uint64_t flattenParts(const BakeScene& scene, const ReadCell& read, Flattener& flattener);

}  // namespace sightline::pvs
