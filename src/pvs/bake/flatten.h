#pragma once

#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/bake/cell_tree.h"

namespace sightline::pvs {

// Converts the tree of cells to the layout of the file: nodes and leaves in one order, equal sets and planes
// once.
void flatten(const BakedCell& root, const BoxTreeView& boxes, VisibilityOctree& octree, NodeSets& sets);

}  // namespace sightline::pvs
