#pragma once

#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/bake/cell_tree.h"

namespace sightline::pvs {

// Converts the tree of cells to the layout of the file: nodes and leaves in one order, equal sets and planes
// once. Doors are added to every set but empty ones, for an open door may be anywhere.
void flatten(const BakedCell& root, const BakeScene& scene, BakedVisibility& baked);

}  // namespace sightline::pvs
