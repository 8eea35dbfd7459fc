#pragma once

#include "pvs/bake/cell_tree.h"
#include "sightline/pvs/format/baked_visibility.h"

namespace sightline::bake_detail {

// The tree of cells as the file has it: nodes and leaves in one order, equal sets and planes once.
void flatten(const BakedCell& root, const BoxTreeView& boxes, VisibilityOctree& octree, NodeSets& sets);

}  // namespace sightline::bake_detail
