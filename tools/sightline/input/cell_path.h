#pragma once

// A camera path of views that test a baked file where errors are most likely: at the borders of its cells.

#include <vector>

#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"

namespace sightline::tool {

struct CellPath {
  CameraPath path;          // world space
  std::vector<Vec3d> eyes;  // each frame's eye in scene space, exact to the last bit
};

// One view from each cell of the octree, in the order of the leaves, in a random direction. In turn it is
// from a random point, or from a face, an edge or a corner, on it or a few ulps inside. A cell that a plane
// divides adds a view from just in front of the plane and one from just behind it, if the cell reaches so
// far. The near plane is as far away as the bake allows. The same file always gives the same camera path.
CellPath cellPath(const SightFile& baked, const Scene& scene);

}  // namespace sightline::tool
