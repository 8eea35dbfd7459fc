#pragma once

// A baked file of limited size: fewer cells than were baked, where that costs viewers least.

#include <cstdint>

#include "sightline/base/result.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "src/pvs/bake/cell_tree.h"

namespace sightline::pvs {

// Fills in the octree's cells and the sets of `baked`, whose other parts are there: those of the tree of
// cells, or of fewer cells, so that the file has at most this many bytes. Cells that are close to each other
// become one, with the union of their sets, first where that adds the fewest triangles to what a viewer sees
// for the bytes that it saves; a viewer is as likely to be in one cubic metre of the viewers' space as in
// another. Error if even the fewest cells take more bytes, or if the data is not sound.
Status fitBytes(const BakeScene& scene, const BakedCell& root, std::uint64_t bytes, BakedVisibility& baked);

}  // namespace sightline::pvs
