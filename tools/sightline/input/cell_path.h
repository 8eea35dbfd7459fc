#pragma once

// Views that try a baked file where it is most easily wrong: at the borders of its cells.

#include <vector>

#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

struct CellPath {
  CameraPath path;          // world space
  std::vector<Vec3d> eyes;  // one a frame, scene space, to the last bit
};

// A view from each cell of the octree, in the order of the leaves' numbers: from anywhere in it, from a face,
// an edge or a corner, on it or a few ulps inside, in turn, in any direction. Cells that a plane divides have
// two more, from hard at its front and at its back, where the cell reaches so far. The near plane is as far
// away as the bake allows. The same file gives the same path.
CellPath cellPath(const SightFile& baked, const Scene& scene);

}  // namespace sightline::tool
